"""Figures 8 and 9 of the paper: spectral densities of the real contact area."""

from itertools import cycle
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.spectra import Spectrum, hann, welch
from rubnoise.api.running import simulate
from rubnoise.arrays import Doubles
from rubnoise.figures.paper_sources import Sources
from rubnoise.figures.style import BLUE, INK, SERIES, VERMILION, logarithmic, new_figure
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.runs.measuring import Measurement
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.periodogram import expected_periodogram
from rubnoise.theory.second_order import spectral_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SEGMENT: Final = 1024.0
"""Length of a segment in um, some hundred mean lives and more: a resolution far finer than the corner of a spectrum."""

PER_DECADE: Final = 40
WIDEST: Final = 0.1
"""Bins drawn as one: a fortieth of a decade of wavenumbers, and no more than a fraction of a swing of the tail."""

FIRST: Final = 2
"""The first bin that is drawn: through the window the subtracted mean reaches those before."""

SIMULATED: Final[dict[str, Any]] = {"lw": 2.6, "alpha": 0.55, "solid_joinstyle": "round"}
"""A simulated spectrum is drawn broad and pale, for the exact one lies on it."""

ONE_OF_SEVERAL: Final[dict[str, Any]] = {"lw": 2.6, "solid_joinstyle": "round"}
"""One among others keeps its full colour, by which it is known."""

WAVENUMBER: Final = "wavenumber (rad/µm)"
DENSITY: Final = "two-sided spectral\ndensity (µm⁴ per rad/µm)"


def spectrum_of(model: Model, record: MemoryRecord) -> Spectrum:
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


LINEAR_PHASE: Final = 12.0
"""Largest wavenumber of the linear axes, times the mean life."""

TAIL_PHASE: Final = 3.0
"""Where the tail's law begins to be drawn, as a wavenumber times the mean diameter."""

ALIASED: Final = 0.1
"""From which part of the largest wavenumber on the ratio to the exact density is drawn."""

EXACT_SAMPLES: Final = 1500


def draw_fig8(sources: Sources) -> "Figure":
    """Draw Welch's estimate and S(k), the mean of its tail, and near the end the ratio of both, with the aliases."""
    scenario = sources.scenario("fig8.toml")
    model = scenario.model()
    seen = spectrum_of(model, simulate(scenario).reader())
    wavenumber, density = merged_bins(seen)
    figure = new_figure(7.2, 4.6)
    panes: Any = figure.subplot_mosaic([["linear", "tail"], ["linear", "ratio"]], height_ratios=[2.2, 1.0])
    linear, tail = panes["linear"], panes["tail"]
    highest = LINEAR_PHASE / model.mean_life_distance
    shown = wavenumber <= highest
    linear.plot(wavenumber[shown], density[shown], color=BLUE, label="simulated", **SIMULATED)
    _draw_exact_density(linear, model, np.linspace(0.0, highest, EXACT_SAMPLES))
    linear.set_xlim(0.0, highest)
    linear.set_ylim(bottom=0.0)
    tail.plot(wavenumber, density, color=BLUE, label="simulated", **SIMULATED)
    _draw_exact_density(tail, model, np.geomspace(wavenumber[0], wavenumber[-1], EXACT_SAMPLES))
    _draw_tail(tail, model, float(wavenumber[-1]))
    _draw_aliased(panes["ratio"], model, seen)
    logarithmic(tail.xaxis, tail.yaxis)
    tail.set_xlim(wavenumber[0], wavenumber[-1])
    _label_tail(linear, tail)
    linear.set_xlabel(WAVENUMBER)
    panes["ratio"].set_xlabel(WAVENUMBER)
    return figure


def _draw_exact_density(axes: "Axes", model: Model, wavenumber: Doubles) -> None:
    axes.plot(wavenumber, spectral_density(model, wavenumber), color=VERMILION, lw=1.0, label="exact", zorder=3)


def _draw_tail(axes: "Axes", model: Model, highest: float) -> None:
    """Draw 4 lam m_2 / k^4, about which the density of lenses swings."""
    ends = np.array([TAIL_PHASE / model.calibrated_diameter, highest])
    level = 4.0 * model.birth_rate * model.sizes.moment(2)
    axes.plot(ends, level / ends**4, color=INK, lw=1.0, ls=(0, (4, 3)), label="mean of the tail, 4λE[d²]/k⁴")


def _draw_aliased(axes: "Axes", model: Model, seen: Spectrum) -> None:
    """Draw the estimate over S(k) near the last wavenumber, and its expectation with the aliases of the ticks."""
    wavenumber, density = merged_bins(seen)
    bins, level = expected_periodogram(model, model.tick, hann(seen.ticks))
    shown, lifted = wavenumber > ALIASED * wavenumber[-1], bins > ALIASED * bins[-1]
    ratio = density[shown] / spectral_density(model, wavenumber[shown])
    axes.plot(wavenumber[shown], ratio, color=BLUE, **SIMULATED)
    axes.axhline(1.0, color=VERMILION, lw=1.0)
    expected = level[lifted] / spectral_density(model, bins[lifted])
    axes.plot(bins[lifted], expected, color=INK, lw=1.2, ls=(0, (3, 1.5)), label="with the ticks' aliases")
    axes.set_xlim(bins[lifted][0], bins[-1])
    axes.set_ylim(0.0, 1.15 * float(expected[-1]))
    axes.set_ylabel("ratio to exact")
    axes.legend(loc="upper left")


def _label_tail(linear: "Axes", tail: "Axes") -> None:
    linear.set_ylabel(DENSITY)
    linear.set_title("As the paper has it")
    tail.set_title("On logarithmic axes: a tail, no floor")
    linear.legend(loc="upper right")
    tail.legend(loc="lower left")


HIGHEST_PHASE: Final = 60.0
"""Largest wavenumber that is drawn, times the mean life."""

POINT_SAMPLES: Final = 900
ROOM: Final = 0.4
NUMBER_POINTS: Final = 14.0
"""How much farther to the left the axis begins for the numbers beside the curves, and how wide one of them is."""


def draw_fig9(sources: Sources) -> "Figure":
    """Draw S(k) of every point, and all of them again over variance and mean life."""
    figure = new_figure(7.2, 3.9)
    plain, scaled = figure.subplots(1, 2)
    looks = enumerate(cycle(SERIES))
    for (point, seen), (number, (colour, _)) in zip(sources.results("fig9.toml", SPECTRUM), looks, strict=False):
        model = point.scenario.model()
        label = f"{model.mean_junction_count:g}"
        _draw_spectrum(plain, model, seen, colour, label, scales=(1.0, 1.0))
        _name_at_start(plain, model, seen, label, NUMBER_POINTS * (number % 2))
        variance, life = area_cumulants(model).variance, model.mean_life_distance
        _draw_spectrum(scaled, model, seen, colour, label, scales=(life, 1.0 / (variance * life)))
    _finish_points(plain, scaled)
    return figure


SPECTRUM: Final = Measurement(sink=MemoryRecord, read=spectrum_of)


def _draw_spectrum(
    axes: "Axes", model: Model, seen: Spectrum, colour: str, label: str, *, scales: tuple[float, float]
) -> None:
    """Draw a simulated spectrum and the exact one below it, wavenumbers and densities times their scales."""
    highest = HIGHEST_PHASE / model.mean_life_distance
    wavenumber, density = merged_bins(seen)
    shown = wavenumber <= highest
    exact = np.geomspace(wavenumber[0], highest, POINT_SAMPLES)
    across, up = scales
    law = up * spectral_density(model, exact)
    axes.plot(across * exact, law, color=VERMILION, lw=0.8, zorder=3)
    axes.plot(across * wavenumber[shown], up * density[shown], color=colour, label=label, **ONE_OF_SEVERAL)


def _name_at_start(axes: "Axes", model: Model, seen: Spectrum, label: str, away: float) -> None:
    """Write the number of junctions some points away from where the exact curve begins."""
    first = float(seen.wavenumber[FIRST])
    level = float(spectral_density(model, np.array([first]))[0])
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "right", "va": "center", "fontsize": 7.5}
    axes.annotate(label, (first, level), xytext=(-4.0 - away, 0.0), **place)


def _finish_points(plain: "Axes", scaled: "Axes") -> None:
    for axes in (plain, scaled):
        logarithmic(axes.xaxis, axes.yaxis)
        axes.plot([], [], color=VERMILION, lw=0.8, label="exact")
    plain.set_xlim(left=ROOM * plain.get_xlim()[0])
    plain.set_xlabel(WAVENUMBER)
    plain.set_ylabel(DENSITY)
    plain.set_title("Five mean numbers of junctions")
    plain.legend(loc="lower left", title="simulated, junctions", alignment="left")
    scaled.set_xlabel("wavenumber times mean life (rad)")
    scaled.set_ylabel("density over variance\nand mean life (1/rad)")
    scaled.set_title("Over variance and life: one curve")
