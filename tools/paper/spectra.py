"""Figures 7 to 9 of the paper: the spread of the real contact area, and its spectral density."""

from itertools import cycle
from math import pi, sqrt
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from paper.figures import Sources
from rubnoise.analysis.spectra import Spectrum, hann, welch
from rubnoise.api.running import simulate
from rubnoise.arrays import Doubles
from rubnoise.figures.style import BLUE, CONFIDENCE, INK, SERIES, VERMILION, logarithmic, new_figure
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.runs.measuring import Measurement
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sampling import expected_periodogram, standard_errors
from rubnoise.theory.second_order import spectral_density

LAW: Final = 1.5 * sqrt(2.0 * pi / 3.0 - 64.0 / 45.0)
"""std/mean times sqrt(N) for lenses of one size: sqrt(c_2) / (c_1 sqrt(2 / N)) with c_1 = 2/3, c_2 = pi/3 - 32/45."""

APART: Final = 0.018
"""How far points of one number of junctions are set apart, as a part of it, so that none hides another."""

Spot = tuple[Model, float, float]
"""A model, the standard deviation of its runs, and the standard error of that from theory."""


def spreads_of(sources: Sources) -> list[list[Spot]]:
    """Run the sweep of Figure 7, and return its points for each mean area, the replicates of a point taken together."""
    runs: dict[tuple[float, float], tuple[Model, list[float]]] = {}
    variance = Measurement(sink=MemoryRecord, read=lambda _, record: float(record["trace"]["real_contact_area"].var()))
    for point, found in sources.points("fig7", variance):
        model = point.scenario.model()
        place = model.mean_real_contact_area, model.mean_junction_count
        runs.setdefault(place, (model, []))[1].append(found)
    spots = {
        place: (model, sqrt(sum(found) / len(found)), standard_errors(model)["std"] / sqrt(len(found)))
        for place, (model, found) in sorted(runs.items(), key=lambda each: each[0])
    }
    return [[spot for place, spot in spots.items() if place[0] == area] for area in sorted({area for area, _ in spots})]


def draw_fig7(sources: Sources) -> Figure:
    """Draw the standard deviation for each mean area, and all of them over their mean on logarithmic axes."""
    figure = new_figure(7.2, 3.8)
    absolute, relative = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
    lines = spreads_of(sources)
    for number, (spots, (colour, marker)) in enumerate(zip(lines, cycle(SERIES), strict=False)):
        count = np.array([model.mean_junction_count for model, _, _ in spots])
        seen, error = np.array([numbers for _, *numbers in spots]).T
        exact = [area_cumulants(model) for model, _, _ in spots]
        mean, law = (np.array([getattr(each, name) for each in exact]) for name in ("mean", "std"))
        look: dict[str, Any] = {"color": colour, "fmt": marker, "ms": 4.5, "capsize": 2.0, "zorder": 3}
        label = f"{spots[0][0].mean_real_contact_area:g} µm²"
        absolute.errorbar(count, seen, CONFIDENCE * error, **look)
        # Between the points by 1/sqrt(N), from which the law hardly departs.
        fine = np.linspace(count[0], count[-1], 201)
        absolute.plot(fine, np.interp(fine, count, law * np.sqrt(count)) / np.sqrt(fine), color=VERMILION, lw=1.2)
        absolute.annotate(label, (count[-1], law[-1]), xytext=(7.0, 0.0), textcoords="offset points", va="center")
        # A little beside their places, so that none hides another.
        beside = (1.0 + APART * (number - 2.0)) * count
        relative.errorbar(beside, seen / mean, CONFIDENCE * error / mean, label=label, **look)
    _draw_law(relative, np.array([0.9 * count[0], 1.1 * count[-1]]))
    absolute.errorbar([], [], [], label="simulated, 95 % interval", color=INK, fmt="o", ms=4.5, capsize=2.0)
    absolute.plot([], [], color=VERMILION, lw=1.2, label="exact")
    absolute.legend(loc="upper right")
    absolute.set(title="For five mean areas", xlabel="mean number of junctions")
    absolute.set_ylabel("standard deviation of\nthe real contact area (µm²)")
    absolute.set_ylim(bottom=0.0)
    return figure


def _draw_law(axes: Axes, counts: Doubles) -> None:
    """Draw the law for sizes that are all the same, which no mean area enters, and finish its axes."""
    axes.plot(counts, LAW / np.sqrt(counts), color=VERMILION, lw=1.2, zorder=2)
    middle = float(np.sqrt(counts.prod()))
    place = (middle, LAW / sqrt(middle))
    axes.annotate(f"exact, one size:\n{LAW:.5g}/√N", place, xytext=(8.0, 8.0), textcoords="offset points")
    logarithmic(axes.xaxis, axes.yaxis)
    for axis in (axes.xaxis, axes.yaxis):
        # By its own numbers, not by powers of ten, of which so short an axis has one.
        axis.set_major_locator(FixedLocator([0.1, 0.15, 0.2, 0.3, 0.4, 10.0, 20.0, 30.0, 40.0, 50.0]))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set(title="Over their mean: one law", ylabel="standard deviation over mean")
    axes.set_xlabel("mean number of junctions\n(points of one number side by side)")
    axes.legend(loc="lower left", title="simulated", alignment="left")


SEGMENT: Final = 1024.0
"""Length of a segment in um, some hundred mean lives and more: a resolution far finer than the corner of a spectrum."""

PER_DECADE, WIDEST = 40, 0.1
"""Bins drawn as one: a fortieth of a decade of wavenumbers, and no more than a fraction of a swing of the tail."""

FIRST: Final = 2
"""The first bin that is drawn: through the window the subtracted mean reaches those before."""

WAVENUMBER, DENSITY = "wavenumber (rad/µm)", "two-sided spectral\ndensity (µm⁴ per rad/µm)"
SIMULATED: Final[dict[str, Any]] = {"lw": 2.6, "solid_joinstyle": "round"}
"""A simulated spectrum is drawn broad, for the exact one lies on it."""


def spectrum_of(model: Model, record: Any) -> Spectrum:
    """Return Welch's estimate of the two-sided S(k) of A_r in a run, in um^4 per rad/um."""
    return welch(record["trace"]["real_contact_area"], model.tick, 2 * round(0.5 * SEGMENT / model.tick))


def merged_bins(spectrum: Spectrum) -> tuple[Doubles, Doubles]:
    """Return wavenumbers and the mean density of the bins about each: first of single bins, then of more and more."""
    wavenumber, density = spectrum.wavenumber[FIRST:], spectrum.density[FIRST:]
    edges = [float(wavenumber[0])]
    while edges[-1] < wavenumber[-1]:
        edges.append(edges[-1] + min(edges[-1] * (10.0 ** (1.0 / PER_DECADE) - 1.0), WIDEST))
    starts = np.unique(np.searchsorted(wavenumber, edges[:-1]))
    counts = np.diff([*starts.tolist(), wavenumber.size])
    return np.add.reduceat(wavenumber, starts) / counts, np.add.reduceat(density, starts) / counts


def draw_fig8(sources: Sources) -> Figure:
    """Draw Welch's estimate and S(k), the mean of its tail, and near the end the ratio of both, with the aliases."""
    scenario = sources.scenario("fig8")
    model = scenario.model()
    seen = spectrum_of(model, simulate(scenario).reader())
    wavenumber, density = merged_bins(seen)
    figure = new_figure(7.2, 4.6)
    panes: Any = figure.subplot_mosaic([["linear", "tail"], ["linear", "ratio"]], height_ratios=[2.2, 1.0])
    linear, tail = panes["linear"], panes["tail"]
    ends = {linear: (0.0, 12.0 / model.mean_life_distance), tail: (float(wavenumber[0]), float(wavenumber[-1]))}
    for axes, (low, high) in ends.items():
        shown = wavenumber <= high
        exact = np.linspace(low, high, 1500) if axes is linear else np.geomspace(low, high, 1500)
        axes.plot(wavenumber[shown], density[shown], color=BLUE, alpha=0.55, label="simulated", **SIMULATED)
        axes.plot(exact, spectral_density(model, exact), color=VERMILION, lw=1.0, label="exact", zorder=3)
        axes.set_xlim(low, high)
    _draw_tail(tail, model, float(wavenumber[-1]))
    _draw_aliased(panes["ratio"], model, seen)
    linear.set(title="As the paper has it", xlabel=WAVENUMBER, ylabel=DENSITY)
    linear.set_ylim(bottom=0.0)
    linear.legend(loc="upper right")
    return figure


def _draw_tail(axes: Axes, model: Model, highest: float) -> None:
    """Draw 4 lam m_2 / k^4, about which the density of lenses swings."""
    ends = np.array([3.0 / model.calibrated_diameter, highest])
    level = 4.0 * model.birth_rate * model.sizes.moment(2)
    axes.plot(ends, level / ends**4, color=INK, lw=1.0, ls=(0, (4, 3)), label="mean of the tail, 4λE[d²]/k⁴")
    logarithmic(axes.xaxis, axes.yaxis)
    axes.set_title("On logarithmic axes: a tail, no floor")
    axes.legend(loc="lower left")


def _draw_aliased(axes: Axes, model: Model, seen: Spectrum) -> None:
    """Draw the estimate over S(k) near the last wavenumber, and its expectation with the aliases of the ticks."""
    wavenumber, density = merged_bins(seen)
    bins, level = expected_periodogram(model, model.tick, hann(seen.ticks))
    shown, lifted = wavenumber > 0.1 * wavenumber[-1], bins > 0.1 * bins[-1]
    ratio = density[shown] / spectral_density(model, wavenumber[shown])
    axes.plot(wavenumber[shown], ratio, color=BLUE, alpha=0.55, **SIMULATED)
    axes.axhline(1.0, color=VERMILION, lw=1.0)
    expected = level[lifted] / spectral_density(model, bins[lifted])
    axes.plot(bins[lifted], expected, color=INK, lw=1.2, ls=(0, (3, 1.5)), label="with the ticks' aliases")
    axes.set(xlim=(bins[lifted][0], bins[-1]), ylim=(0.0, 1.15 * float(expected[-1])))
    axes.set(xlabel=WAVENUMBER, ylabel="ratio to exact")
    axes.legend(loc="upper left")


def draw_fig9(sources: Sources) -> Figure:
    """Draw S(k) of every point, and all of them again over variance and mean life."""
    figure = new_figure(7.2, 3.9)
    plain, scaled = figure.subplots(1, 2)
    points = sources.points("fig9", Measurement(sink=MemoryRecord, read=spectrum_of))
    for number, ((point, seen), (colour, _)) in enumerate(zip(points, cycle(SERIES), strict=False)):
        model = point.scenario.model()
        life, variance = model.mean_life_distance, area_cumulants(model).variance
        wavenumber, density = merged_bins(seen)
        shown = wavenumber <= 60.0 / life
        exact = np.geomspace(wavenumber[0], 60.0 / life, 900)
        law = spectral_density(model, exact)
        for axes, across, up in ((plain, 1.0, 1.0), (scaled, life, 1.0 / (variance * life))):
            axes.plot(across * exact, up * law, color=VERMILION, lw=0.8, zorder=3)
            label = f"{model.mean_junction_count:g}"
            axes.plot(across * wavenumber[shown], up * density[shown], color=colour, label=label, **SIMULATED)
        away = (-4.0 - 14.0 * (number % 2), 0.0)
        look: dict[str, Any] = {"textcoords": "offset points", "ha": "right", "va": "center", "fontsize": 7.5}
        plain.annotate(label, (exact[0], law[0]), xytext=away, **look)
    for axes in (plain, scaled):
        logarithmic(axes.xaxis, axes.yaxis)
        axes.plot([], [], color=VERMILION, lw=0.8, label="exact")
    plain.set_xlim(left=0.4 * plain.get_xlim()[0])
    plain.set(title="Five mean numbers of junctions", xlabel=WAVENUMBER, ylabel=DENSITY)
    plain.legend(loc="lower left", title="simulated, junctions", alignment="left")
    scaled.set(title="Over variance and life: one curve", xlabel="wavenumber times mean life (rad)")
    scaled.set_ylabel("density over variance\nand mean life (1/rad)")
    return figure
