"""Statistics of the real contact area beside the exact ones: distribution, autocovariance and spectrum."""

from math import sqrt
from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.covariance import LaggedProducts
from rubnoise.analysis.histogram import Histogram, histogram
from rubnoise.analysis.moments import covariance_errors
from rubnoise.analysis.records import RecordTooShort
from rubnoise.analysis.spectra import Spectrum, WelchSum, hann, shared_variance
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.errors import Refused
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import (
    AREA,
    BLUE,
    CONFIDENCE,
    FAINT,
    INK,
    NEAREST,
    VERMILION,
    add_title,
    draw_band,
    draw_ratio,
    legend_above,
    logarithmic,
    new_figure,
)
from rubnoise.theory.moments import Distribution, area_cumulants, distribution
from rubnoise.theory.sampling import expected_periodogram
from rubnoise.theory.second_order import area_noise, autocovariance, spectral_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BINS: Final = 51
"""Odd, so that an area that never varies falls into the middle of one."""
AREA_SAMPLES: Final = 1200
RARE: Final = 1e-6
"""A probability of no contact at all below which a picture need not speak of it."""


def histogram_figure(stretch: Stretch) -> "Figure":
    """Draw the histogram of A_r over a stretch with the exact density, on a linear and on a logarithmic axis.

    An area of 0 has a probability and no density: a text states it.
    """
    values = stretch.record("trace", "real_contact_area")
    seen, law = _histogram(values, stretch.model.tick), _law(stretch)
    figure = new_figure(7.2, 3.6)
    add_title(figure, stretch, _moments_title(stretch, values, law))
    linear, tails = figure.subplots(1, 2, sharex=True)
    for axes in (linear, tails):
        _draw_histogram(axes, seen, law)
    # Not as high as the exact density: it is singular at 0.
    highest = float(seen.density.max()) or 1.0
    linear.set_ylim(0.0, 1.2 * highest)
    linear.set_ylabel("density (1/µm²)")
    lowest = float(seen.density.min(where=seen.density > 0.0, initial=highest))
    tails.set_ylim(0.3 * lowest, 3.0 * highest)  # before the scale, which would warn of a density that is 0 everywhere
    logarithmic(tails.yaxis)
    legend_above(linear)
    return figure


def _moments_title(stretch: Stretch, values: Doubles, law: Distribution | None) -> str:
    moments = f"mean {values.mean():.4g}, std {values.std():.4g} µm²"
    if stretch.has_theory:
        exact = area_cumulants(stretch.model)
        moments = f"mean {values.mean():.4g} (exact {exact.mean:.4g}), std {values.std():.4g} ({exact.std:.4g}) µm²"
    title = f"How large the real contact area is: {moments}"
    if not stretch.has_theory:
        title += f"\noff the surface: {100.0 * np.mean(values == 0.0):.3g} % of the time"
    elif law is not None and law.atom_at_zero > RARE:
        title += f"\nno contact at all: {np.mean(values == 0.0):.3g} (exact {law.atom_at_zero:.3g})"
    first, last = stretch.rows("trace")
    return title + (f"\nfrom its first {values.size * stretch.model.tick:.4g} µm" if values.size < last - first else "")


def _histogram(values: Doubles, tick: float) -> Histogram:
    some = values[values > 0.0]
    low, high = (float(some.min()), float(some.max())) if some.size else (0.0, 1.0)
    # Values that differ by rounding alone are one bar, on an axis that has digits for its numbers.
    room = (1e-9 if high - low > NEAREST * high else 0.1) * high
    edges = np.linspace(max(low - room, np.nextafter(0.0, 1.0)), high + room, BINS + 1)
    try:
        return histogram(values, tick, edges)
    except RecordTooShort as short:
        if isinstance(short.estimate, Histogram):
            return short.estimate
        raise


def _law(stretch: Stretch) -> Distribution | None:
    if not stretch.has_theory:
        return None
    try:
        return distribution(stretch.model)
    except Refused:
        return None


def _draw_histogram(axes: "Axes", seen: Histogram, law: Distribution | None) -> None:
    axes.stairs(seen.density, seen.edges, fill=True, color=BLUE, alpha=0.4, lw=0.0, label="simulated")
    if np.all(np.isfinite(seen.standard_error)):
        axes.errorbar(
            seen.middles, seen.density, seen.standard_error, fmt="none", ecolor=INK, elinewidth=0.6, label="± std error"
        )
    if law is not None:
        area = np.linspace(seen.edges[0], seen.edges[-1], AREA_SAMPLES)
        axes.plot(area, law.density(area), color=VERMILION, lw=1.4, label="exact")
    axes.set_xlabel(AREA)


LAGS: Final = 80
LAG_SAMPLES: Final = 400
LAG_LIVES: Final = 1.6


def acf_figure(stretch: Stretch) -> "Figure":
    """Draw the autocovariance of A_r over a stretch, R(tau), and the band with 95 % of estimates at each lag.

    Theory knows the band for random births, to first order in a life over the stretch. It lies about the expected
    estimate: R(tau) less the variance of the subtracted mean, S(0) over the stretch.
    """
    first, last = stretch.rows("trace")
    reach = min(int(LAG_LIVES * stretch.model.mean_life_distance / stretch.model.tick) + 1, (last - first) // 2)
    steps = np.arange(0, reach + 1, max(1, reach // LAGS))
    lag, mean = stretch.model.tick * steps, _mean_area(stretch)
    products = LaggedProducts(steps.tolist(), mean)
    for chunk in stretch.chunks("trace", "real_contact_area"):
        products.add(chunk)
    figure = new_figure(7.2, 3.8)
    add_title(figure, stretch, "Autocovariance of the real contact area")
    axes = figure.subplots()
    if stretch.has_theory:
        _draw_exact_covariance(axes, stretch, float(lag[-1]))
        life = stretch.model.mean_life_distance
        axes.axvline(life, color=INK, lw=0.9, ls=(0, (4, 3)), zorder=0, label=_life_label(stretch))
    axes.plot(lag, products.covariances(), "o", color=BLUE, ms=2.6, label="simulated")
    axes.set_xlim(0.0, lag[-1])
    rounding = (NEAREST * mean) ** 2
    if max(np.abs(axes.get_ylim())) < rounding:
        axes.set_ylim(-rounding, rounding)
    axes.set_xlabel("lag in sliding distance (µm)")
    axes.set_ylabel("autocovariance (µm⁴)")
    legend_above(axes, columns=2)
    return figure


def _mean_area(stretch: Stretch) -> float:
    """Return the mean area in um^2: the exact one, or that of the stretch if theory does not know it."""
    if stretch.has_theory:
        return area_cumulants(stretch.model).mean
    total = sum(float(chunk.sum()) for chunk in stretch.chunks("trace", "real_contact_area"))
    return total / float(np.subtract(*stretch.rows("trace")[::-1]))


def _life_label(stretch: Stretch) -> str:
    smallest, largest = stretch.model.sizes.support
    alike = smallest == largest and stretch.model.pulse.offset == "none"
    whose = "a life" if alike else "the mean life"
    length = "2d" if stretch.model.pulse.offset == "none" else "πd/2"
    return f"{whose}, {length} = {stretch.model.mean_life_distance:.4g} µm"


def _draw_exact_covariance(axes: "Axes", stretch: Stretch, longest: float) -> None:
    lag = np.linspace(0.0, longest, LAG_SAMPLES)
    exact = autocovariance(stretch.model, lag)
    axes.axhline(0.0, color=FAINT, lw=0.6, zorder=0)
    if isinstance(stretch.model.births, PoissonBirths):
        low, high = covariance_band(stretch, lag, exact)
        label = "95 % of estimates, each lag alone: neighbours err together"
        axes.fill_between(lag, low, high, color=VERMILION, alpha=0.15, lw=0.0, label=label)
        for edge in (low, high):
            axes.plot(lag, edge, color=VERMILION, lw=0.7, ls=(0, (5, 4)))
    axes.plot(lag, exact, color=VERMILION, lw=1.6, label="exact")


def covariance_band(stretch: Stretch, lag: Doubles, exact: Doubles) -> tuple[Doubles, Doubles]:
    """Return the bounds in um^4 of the estimate at each lag in um in 95 % of such runs."""
    length = stretch.stop - stretch.start
    error = CONFIDENCE * covariance_errors(stretch.model, lag, length, stretch.model.tick)
    expected = exact - float(spectral_density(stretch.model, 0.0)) / length
    return expected - error, expected + error


FEWEST_TICKS: Final = 16
SEGMENTS: Final = 30
LONGEST_LIVES: Final = 40.0
"""Length of a segment in mean lives: enough to see the spectrum flat, and short enough to have many of them."""

MOST_LINES: Final = 30
ROUNDING: Final = 1e-12
"""Expected density over the largest below which a ratio would be one of rounding errors."""

DENSITY_POINTS: Final = 600
UNIT: Final = "µm⁴ per rad/µm"


def psd_figure(stretch: Stretch) -> "Figure":
    """Draw Welch's estimate of S(k) over a stretch, S(k) itself, and the expected estimate.

    The last has the aliases of the ticks and the leakage of the window in it. Raises Refused for a stretch of too few
    ticks.
    """
    seen = area_spectrum(stretch)
    figure = new_figure(7.2, 5.4 if stretch.has_theory else 4.2)
    segments = f"{seen.segments} segments of {seen.ticks * stretch.model.tick:.4g} µm"
    add_title(figure, stretch, f"The spectrum of the real contact area ({segments})")
    heights = [2.6, 1.0] if stretch.has_theory else [1.0]
    axes, *ratio = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights, squeeze=False)[:, 0]
    if stretch.has_theory:
        _draw_exact_density(axes, stretch, seen)
    axes.plot(seen.wavenumber[1:], seen.density[1:], color=BLUE, lw=0.8, label="simulated (Welch, Hann window)")
    if stretch.has_theory:
        _draw_ratio(ratio[0], seen, _draw_expected_estimate(axes, stretch, seen))
    logarithmic(axes.xaxis, axes.yaxis)
    # Zeros of the theory lie far below what has a logarithm.
    highest = float(seen.density.max())
    axes.set_ylim(0.1 * float(seen.density.min(where=seen.density > 0.0, initial=highest)), 10.0 * highest)
    axes.set_xlim(seen.wavenumber[1], seen.wavenumber[-1])
    [axes, *ratio][-1].set_xlabel("wavenumber (rad/µm)")
    axes.set_ylabel(f"two-sided spectral density\n({UNIT})")
    legend_above(axes)
    return figure


def area_spectrum(stretch: Stretch) -> Spectrum:
    """Return Welch's estimate of S(k) over a stretch; raises Refused for too few ticks and for a constant area."""
    first, last = stretch.rows("trace")
    tick = stretch.model.tick
    longest = int(LONGEST_LIVES * stretch.model.mean_life_distance / tick)
    ticks = 2 * (min(2 * (last - first) // (SEGMENTS + 1), longest) // 2)
    if ticks < FEWEST_TICKS:
        needed = FEWEST_TICKS * (SEGMENTS + 1) / 2 * tick
        raise Refused(f"a spectrum needs a stretch of {needed:.3g} um or more, with a tick every {tick:g} um")
    total = WelchSum(ticks, tick)
    for chunk in stretch.chunks("trace", "real_contact_area"):
        total.add(chunk)
    seen = total.spectrum()
    if seen.power <= (NEAREST * area_cumulants(stretch.model).mean) ** 2:
        raise Refused("the real contact area does not vary in this stretch, so it has no spectrum")
    return seen


def _draw_exact_density(axes: "Axes", stretch: Stretch, seen: Spectrum) -> None:
    """Draw S(k), unless it is 0, and mark the lines of regular births."""
    wavenumber = np.geomspace(seen.wavenumber[1], seen.wavenumber[-1], DENSITY_POINTS)
    density = spectral_density(stretch.model, wavenumber)
    if density.any():
        axes.plot(wavenumber, density, color=VERMILION, lw=2.4, label="exact S(k)")
    lines, _ = area_noise(stretch.model).lines
    label = "exact lines"
    for line in lines[:MOST_LINES]:
        axes.axvline(line, color=VERMILION, lw=0.8, ls=(0, (1, 2)), zorder=0, label=label)
        label = "_one entry is enough"


def _draw_expected_estimate(axes: "Axes", stretch: Stretch, seen: Spectrum) -> Doubles:
    """Draw the expected estimate, and return it at the wavenumbers of the estimate."""
    window, tick = hann(seen.ticks), stretch.model.tick
    wavenumber, expected = expected_periodogram(stretch.model, tick, window)
    axes.plot(wavenumber[1:], expected[1:], color=INK, lw=1.0, ls=(0, (4, 2)), label="expected of the estimate")
    draw_band(axes, wavenumber[1:], expected[1:], relative_error(seen))
    return expected


def _draw_ratio(axes: "Axes", seen: Spectrum, expected: Doubles) -> None:
    """Draw the estimate over its expectation, if that is more than rounding."""
    known = (expected > ROUNDING * float(expected.max())) & (seen.wavenumber > 0.0)
    wavenumber, level = seen.wavenumber[known], expected[known]
    draw_ratio(axes, wavenumber, seen.density[known] / level, relative_error(seen))


def relative_error(seen: Spectrum) -> float:
    """Return the standard error of Welch's estimate over its expectation."""
    return sqrt(float(shared_variance(seen.ticks, seen.segments, 0)[0]) / seen.segments)
