"""Figures 7 to 9 of the paper: the spread of the real contact area, and its spectral density."""

from itertools import cycle
from math import sqrt
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from paper.figures import Sources
from rubnoise.analysis.spectra import welch
from rubnoise.api.running import simulate
from rubnoise.arrays import Doubles
from rubnoise.figures.style import BLUE, CONFIDENCE, INK, SERIES, VERMILION, logarithmic, new_figure
from rubnoise.model import Model
from rubnoise.record.rows import Reader
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sampling import EstimatedSpectrum, standard_errors
from rubnoise.theory.second_order import spectral_density

Spot = tuple[Model, float, float]
"""A model, the standard deviation of its runs, and the standard error of that from theory."""


def spreads_of(sources: Sources) -> list[list[Spot]]:
    """Run the sweep of Figure 7, and return its points for each mean area, the replicates of a point taken together."""
    runs: dict[tuple[float, float], tuple[Model, list[float]]] = {}
    for point, record in sources.points("fig7"):
        model = point.scenario.model()
        place = model.mean_real_contact_area, model.mean_junction_count
        runs.setdefault(place, (model, []))[1].append(float(record.column("trace", "real_contact_area").var()))
    spots = {
        place: (model, sqrt(sum(found) / len(found)), standard_errors(model)["std"] / sqrt(len(found)))
        for place, (model, found) in sorted(runs.items(), key=lambda each: each[0])
    }
    return [[spot for place, spot in spots.items() if place[0] == area] for area in sorted({area for area, _ in spots})]


def draw_fig7(sources: Sources) -> Figure:
    """Draw the standard deviation for each mean area, simulated with 95 % intervals and exact."""
    figure = new_figure(7.2, 3.8)
    axes = figure.subplots()
    for spots, (colour, marker) in zip(spreads_of(sources), cycle(SERIES), strict=False):
        count = np.array([model.mean_junction_count for model, _, _ in spots])
        seen, error = np.array([numbers for _, *numbers in spots]).T
        law = np.array([area_cumulants(model).std for model, _, _ in spots])
        axes.errorbar(count, seen, CONFIDENCE * error, color=colour, fmt=marker, ms=4.5, capsize=2.0, zorder=3)
        # Between the points by 1/sqrt(N), from which the law hardly departs.
        fine = np.linspace(count[0], count[-1], 201)
        axes.plot(fine, np.interp(fine, count, law * np.sqrt(count)) / np.sqrt(fine), color=VERMILION, lw=1.2)
        label = f"{spots[0][0].mean_real_contact_area:g} µm²"
        axes.annotate(label, (count[-1], law[-1]), xytext=(7.0, 0.0), textcoords="offset points", va="center")
    axes.errorbar([], [], [], label="simulated, 95 % interval", color=INK, fmt="o", ms=4.5, capsize=2.0)
    axes.plot([], [], color=VERMILION, lw=1.2, label="exact")
    axes.legend(loc="upper right")
    axes.set(title="For five mean areas", xlabel="mean number of junctions")
    axes.set_ylabel("standard deviation of\nthe real contact area (µm²)")
    axes.set_ylim(bottom=0.0)
    return figure


SEGMENT: Final = 1024.0
"""Length of a segment in um, some hundred mean lives and more: a resolution far finer than the corner of a spectrum."""

PER_DECADE, WIDEST = 40, 0.1
"""Bins drawn as one: a fortieth of a decade of wavenumbers, and no more than a fraction of a swing of the tail."""

FIRST: Final = 2
"""The first bin that is drawn: through the window the subtracted mean reaches those before."""

WAVENUMBER, DENSITY = "wavenumber (rad/µm)", "two-sided spectral\ndensity (µm⁴ per rad/µm)"
SIMULATED: Final[dict[str, Any]] = {"lw": 2.6, "solid_joinstyle": "round"}
"""A simulated spectrum is drawn broad, for the exact one lies on it."""


def spectrum_of(model: Model, record: Reader) -> EstimatedSpectrum:
    """Return Welch's estimate of the two-sided S(k) of A_r in a run, in um^4 per rad/um."""
    return welch([record.column("trace", "real_contact_area")], 2 * round(0.5 * SEGMENT / model.tick), model.tick)


def merged_bins(spectrum: EstimatedSpectrum) -> tuple[Doubles, Doubles]:
    """Return wavenumbers and the mean density of the bins about each: first of single bins, then of more and more."""
    wavenumber, density = spectrum.wavenumber[FIRST:], spectrum.density[FIRST:]
    edges = [float(wavenumber[0])]
    while edges[-1] < wavenumber[-1]:
        edges.append(edges[-1] + min(edges[-1] * (10.0 ** (1.0 / PER_DECADE) - 1.0), WIDEST))
    starts = np.unique(np.searchsorted(wavenumber, edges[:-1]))
    counts = np.diff([*starts.tolist(), wavenumber.size])
    return np.add.reduceat(wavenumber, starts) / counts, np.add.reduceat(density, starts) / counts


def draw_fig8(sources: Sources) -> Figure:
    """Draw Welch's estimate and S(k), on linear axes and on logarithmic ones with the mean of its tail."""
    scenario = sources.scenario("fig8")
    model = scenario.model()
    wavenumber, density = merged_bins(spectrum_of(model, simulate(scenario).reader()))
    figure = new_figure(7.2, 3.8)
    linear, tail = figure.subplots(1, 2)
    ends = {linear: (0.0, 12.0 / model.mean_life_distance), tail: (float(wavenumber[0]), float(wavenumber[-1]))}
    for axes, (low, high) in ends.items():
        shown = wavenumber <= high
        exact = np.linspace(low, high, 1500) if axes is linear else np.geomspace(low, high, 1500)
        axes.plot(wavenumber[shown], density[shown], color=BLUE, alpha=0.55, label="simulated", **SIMULATED)
        axes.plot(exact, spectral_density(model, exact), color=VERMILION, lw=1.0, label="exact", zorder=3)
        axes.set_xlim(low, high)
    _draw_tail(tail, model, float(wavenumber[-1]))
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


def draw_fig9(sources: Sources) -> Figure:
    """Draw S(k) of every point, and all of them again over variance and mean life."""
    figure = new_figure(7.2, 3.9)
    plain, scaled = figure.subplots(1, 2)
    points = sources.points("fig9")
    for number, ((point, record), (colour, _)) in enumerate(zip(points, cycle(SERIES), strict=False)):
        model = point.scenario.model()
        life, variance = model.mean_life_distance, area_cumulants(model).variance
        wavenumber, density = merged_bins(spectrum_of(model, record))
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
