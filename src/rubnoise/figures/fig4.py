"""Figure 4: a portion of the trace of real contact area, and the junctions whose sum it is."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.api import simulate
from rubnoise.figures.marks import AREA, DISTANCE, exact_band, legend_above
from rubnoise.figures.sources import Sources, envelope
from rubnoise.figures.style import BLUE, FAINT, INK, new_figure
from rubnoise.theory.campbell import area_cumulants

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.model import Model

SAMPLES: Final = 41


def draw(sources: Sources) -> "Figure":
    """Draw A_r over the whole of a short run, and below it the area of every junction."""
    scenario = sources.scenario("fig4.toml")
    model, record = scenario.model(), simulate(scenario)
    figure = new_figure(7.2, 4.4)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
    exact = area_cumulants(model)
    exact_band(above, exact.mean, exact.std)
    trace = record["trace"]
    above.plot(
        *envelope(trace["distance"], trace["real_contact_area"]),
        color=BLUE,
        lw=1.5,
        label="sum of the junctions, simulated",
    )
    above.set_ylabel(AREA)
    above.set_ylim(bottom=0.0)
    legend_above(above)
    _draw_junctions(below, record["junctions"], model)
    below.set_ylabel("junction area (µm²)")
    below.set_xlabel(DISTANCE)
    below.set_xlim(0.0, model.distance)
    return figure


def _draw_junctions(axes: "Axes", rows: dict[str, Any], model: "Model") -> None:
    """Draw every life, and one in the middle on top so that the eye finds a whole one."""
    births, diameters = rows["birth_distance"], rows["diameter"]
    chosen = int(np.searchsorted(births, 0.5 * model.distance))
    age = 1.0 - np.cos(np.linspace(0.0, np.pi, SAMPLES))
    for row, (birth, diameter) in enumerate(zip(births, diameters, strict=True)):
        one = row == chosen
        axes.plot(
            birth + age * diameter,
            model.pulse.area(age * diameter, diameter),
            color=INK if one else FAINT,
            lw=1.6 if one else 0.5,
            zorder=3 if one else 1,
            label=f"one of {births.size}" if one else None,
        )
    axes.set_ylim(0.0, 1.1 * float(0.25 * np.pi * diameters.max() ** 2))
    legend_above(axes)
