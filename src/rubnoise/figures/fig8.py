"""Figure 8: the spectral density of the real contact area, on linear axes as in the paper and on logarithmic ones."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.spectra import Spectrum, hann
from rubnoise.api import simulate
from rubnoise.arrays import Doubles
from rubnoise.figures.sources import Sources
from rubnoise.figures.spectra import AXIS, DENSITY, SIMULATED, drawn, spectrum_of
from rubnoise.figures.style import BLUE, INK, VERMILION, logarithmic, new_figure
from rubnoise.theory.estimated_spectrum import expected_periodogram
from rubnoise.theory.spectrum import spectral_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.model import Model

LINEAR_PHASE: Final = 12.0
"""Largest wavenumber of the linear axes, times the mean life."""

TAIL_PHASE: Final = 3.0
"""Where the tail's law begins to be drawn, as a wavenumber times the mean diameter."""

ALIASED: Final = 0.5
"""From which part of the largest wavenumber on aliases are to be seen."""

SAMPLES: Final = 1500


def draw(sources: Sources) -> "Figure":
    """Draw Welch's estimate and S(k), and in the logarithmic picture the mean of its tail."""
    scenario = sources.scenario("fig8.toml")
    model = scenario.model()
    seen = spectrum_of(model, simulate(scenario))
    wavenumber, density = drawn(seen)
    figure = new_figure(7.2, 3.8)
    linear, tail = figure.subplots(1, 2)
    highest = LINEAR_PHASE / model.mean_life_distance
    shown = wavenumber <= highest
    linear.plot(wavenumber[shown], density[shown], color=BLUE, label="simulated", **SIMULATED)
    _draw_exact(linear, model, np.linspace(0.0, highest, SAMPLES))
    linear.set_xlim(0.0, highest)
    linear.set_ylim(bottom=0.0)
    tail.plot(wavenumber, density, color=BLUE, label="simulated", **SIMULATED)
    _draw_exact(tail, model, np.geomspace(wavenumber[0], wavenumber[-1], SAMPLES))
    _draw_tail(tail, model, float(wavenumber[-1]))
    _draw_aliased(tail, model, seen)
    logarithmic(tail.xaxis)
    logarithmic(tail.yaxis)
    tail.set_xlim(wavenumber[0], wavenumber[-1])
    _label(linear, tail)
    return figure


def _draw_exact(axes: "Axes", model: "Model", wavenumber: Doubles) -> None:
    axes.plot(wavenumber, spectral_density(model, wavenumber), color=VERMILION, lw=1.0, label="exact", zorder=3)


def _draw_tail(axes: "Axes", model: "Model", highest: float) -> None:
    """Draw 4 lam m_2 / k^4, about which the density of lenses swings."""
    ends = np.array([TAIL_PHASE / model.calibrated_diameter, highest])
    level = 4.0 * model.birth_rate * model.sizes.moment(2)
    axes.plot(ends, level / ends**4, color=INK, lw=1.0, ls=(0, (4, 3)), label="mean of the tail, 4λE[d²]/k⁴")


def _draw_aliased(axes: "Axes", model: "Model", seen: Spectrum) -> None:
    """Draw what the estimate is expected to be where the aliases of the ticks lift it, near the last wavenumber."""
    wavenumber, expected = expected_periodogram(model, model.tick, hann(seen.ticks))
    lifted = wavenumber > ALIASED * wavenumber[-1]
    axes.plot(
        wavenumber[lifted], expected[lifted], color=INK, lw=1.2, ls=(0, (1, 1.5)), label="with the ticks' aliases"
    )


def _label(linear: "Axes", tail: "Axes") -> None:
    linear.set_ylabel(DENSITY)
    linear.set_title("As the paper has it")
    tail.set_title("On logarithmic axes: a tail, no floor")
    linear.legend(loc="upper right")
    tail.legend(loc="lower left")
    for axes in (linear, tail):
        axes.set_xlabel(AXIS)
