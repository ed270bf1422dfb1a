"""Figure 9: spectral densities for five numbers of junctions, and what becomes of them over variance and life."""

from itertools import cycle
from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.spectra import Spectrum
from rubnoise.figures.sources import Sources
from rubnoise.figures.spectra import AXIS, DENSITY, SIMULATED, drawn, spectrum_of
from rubnoise.figures.style import SERIES, VERMILION, logarithmic, new_figure
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.sweep.execution import Measure
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.spectrum import spectral_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HIGHEST_PHASE: Final = 60.0
"""Largest wavenumber that is drawn, times the mean life."""

SAMPLES: Final = 900


def draw(sources: Sources) -> "Figure":
    """Draw S(k) of every point, and all of them once more over variance and mean life."""
    figure = new_figure(7.2, 3.9)
    plain, scaled = figure.subplots(1, 2)
    for (point, seen), (colour, _) in zip(sources.results("fig9.toml", SPECTRUM), cycle(SERIES), strict=False):
        model = point.scenario.model()
        label = f"{model.mean_junction_count:g}"
        _draw(plain, model, seen, colour, label, scales=(1.0, 1.0))
        variance, life = area_cumulants(model).variance, model.mean_life_distance
        _draw(scaled, model, seen, colour, label, scales=(life, 1.0 / (variance * life)))
    _finish(plain, scaled)
    return figure


def _spectrum(model: Model, record: MemoryRecord) -> Spectrum:
    return spectrum_of(model, record)


SPECTRUM: Final = Measure(sink=MemoryRecord, read=_spectrum)


def _draw(axes: "Axes", model: Model, seen: Spectrum, colour: str, label: str, *, scales: tuple[float, float]) -> None:
    """Draw a simulated spectrum and the exact one below it, wavenumbers and densities times their scales."""
    highest = HIGHEST_PHASE / model.mean_life_distance
    wavenumber, density = drawn(seen)
    shown = wavenumber <= highest
    exact = np.geomspace(wavenumber[0], highest, SAMPLES)
    across, up = scales
    axes.plot(across * exact, up * spectral_density(model, exact), color=VERMILION, lw=0.8, zorder=3)
    axes.plot(across * wavenumber[shown], up * density[shown], color=colour, label=label, **SIMULATED)


def _finish(plain: "Axes", scaled: "Axes") -> None:
    for axes in (plain, scaled):
        logarithmic(axes.xaxis)
        logarithmic(axes.yaxis)
        axes.plot([], [], color=VERMILION, lw=0.8, label="exact")
    plain.set_xlabel(AXIS)
    plain.set_ylabel(DENSITY)
    plain.set_title("Five mean numbers of junctions")
    plain.legend(loc="lower left", title="simulated, junctions", alignment="left")
    scaled.set_xlabel("wavenumber times mean life (rad)")
    scaled.set_ylabel("density over variance\nand mean life (1/rad)")
    scaled.set_title("Over variance and life: one curve")
