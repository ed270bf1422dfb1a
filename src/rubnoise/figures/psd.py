"""The spectrum of the real contact area by Welch's method, beside the exact one and what the method makes of it."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.spectra import Spectrum, WelchSum, hann
from rubnoise.errors import Refused
from rubnoise.figures.marks import NEAREST, entitle, legend_above
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, INK, VERMILION, logarithmic, new_figure
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.estimated_spectrum import expected_periodogram
from rubnoise.theory.spectrum import spectral_density, visible_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST_TICKS: Final = 16
SEGMENTS: Final = 30
LONGEST_LIVES: Final = 40.0
"""Length of a segment in mean lives: enough to see the spectrum flat, and short enough to have many of them."""

MOST_LINES: Final = 30
POINTS: Final = 600
UNIT: Final = "µm⁴ per rad/µm"


def psd_figure(stretch: Stretch) -> "Figure":
    """Draw Welch's estimate of S(k) over a stretch, S(k) itself, and what the estimate is expected to be.

    The last has the aliases of the ticks and the leakage of the window in it. Raises Refused for a stretch of too few
    ticks.
    """
    seen = _spectrum(stretch)
    figure = new_figure(7.2, 4.4)
    segments = f"{seen.segments} segments of {seen.ticks * stretch.model.tick:.4g} µm"
    entitle(figure, stretch, f"The spectrum of the real contact area ({segments})")
    axes = figure.subplots()
    _draw_exact(axes, stretch, seen)
    axes.plot(seen.wavenumber[1:], seen.density[1:], color=BLUE, lw=0.8, label="simulated (Welch, Hann window)")
    _draw_expected(axes, stretch, seen)
    logarithmic(axes.xaxis)
    logarithmic(axes.yaxis)
    axes.set_ylim(0.1 * _least(seen), 10.0 * float(seen.density.max()))
    axes.set_xlim(seen.wavenumber[1], seen.wavenumber[-1])
    axes.set_xlabel("wavenumber (rad/µm)")
    axes.set_ylabel(f"two-sided spectral density\n({UNIT})")
    legend_above(axes)
    return figure


def _spectrum(stretch: Stretch) -> Spectrum:
    first, last = stretch.rows("trace")
    tick = stretch.model.tick
    longest = int(LONGEST_LIVES * stretch.model.mean_life_distance / tick)
    ticks = 2 * (min(2 * (last - first) // (SEGMENTS + 1), longest) // 2)
    if ticks < FEWEST_TICKS:
        needed = FEWEST_TICKS * (SEGMENTS + 1) / 2 * tick
        raise Refused(f"a spectrum needs a stretch of {needed:.3g} um or more, with a tick every {tick:g} um")
    total = WelchSum(ticks, tick)
    for panel in stretch.panels("trace", "real_contact_area"):
        total.add(panel)
    seen = total.spectrum()
    if seen.power <= (NEAREST * area_cumulants(stretch.model).mean) ** 2:
        raise Refused("the real contact area does not vary in this stretch, so it has no spectrum")
    return seen


def _least(seen: Spectrum) -> float:
    """Return the smallest density that has a logarithm; where the theory has zeros, nobody looks that far down."""
    return float(seen.density.min(where=seen.density > 0.0, initial=float(seen.density.max())))


def _draw_exact(axes: "Axes", stretch: Stretch, seen: Spectrum) -> None:
    """Draw S(k), unless it is 0, and mark the lines that regular births have beside it or instead."""
    wavenumber = np.geomspace(seen.wavenumber[1], seen.wavenumber[-1], POINTS)
    density = spectral_density(stretch.model, wavenumber)
    if density.any():
        axes.plot(wavenumber, density, color=VERMILION, lw=2.4, label="exact S(k)")
    lines, _ = visible_lines(stretch.model)
    label = "exact lines"
    for line in lines[:MOST_LINES]:
        axes.axvline(line, color=VERMILION, lw=0.8, ls=(0, (1, 2)), zorder=0, label=label)
        label = "_one entry is enough"


def _draw_expected(axes: "Axes", stretch: Stretch, seen: Spectrum) -> None:
    window, tick = hann(seen.ticks), stretch.model.tick
    wavenumber, expected = expected_periodogram(stretch.model, tick, window)
    axes.plot(wavenumber[1:], expected[1:], color=INK, lw=1.0, ls=(0, (4, 2)), label="expected of the estimate")
