"""Figure 3: the life of a junction, and the triangle that Rabinowicz put in its place."""

from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.api import simulate
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.figures.sources import Sources
from rubnoise.figures.style import BLUE, FAINT, INK, VERMILION, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.scenario import Scenario

SCENARIO: Final = "fig3.toml"
DOTS: Final = 36


def draw(sources: Sources) -> "Figure":
    """Draw one life as a lens and as a triangle of the same diameter, simulated and by formula."""
    lens = sources.scenario(SCENARIO)
    triangle = sources.scenario(SCENARIO, _as_triangle(lens))
    figure = new_figure(7.2, 3.4)
    panels = figure.subplots(1, 2, sharey=True)
    titles = ("The overlap of two circles", "Rabinowicz's triangle")
    for axes, scenario, title in zip(panels, (lens, triangle), titles, strict=True):
        _draw_life(axes, scenario)
        axes.set_title(title)
    panels[0].set_ylabel("junction area (µm²)")
    _draw_beside(panels[1], lens)
    return figure


def _as_triangle(lens: "Scenario") -> list[str]:
    """Return the changes that make the junctions triangles of the same diameter, whose mean area is (pi/8) d^2."""
    model = lens.model()
    area = model.mean_junction_count * TRIANGLE.life_integral(1) / 2.0 * model.calibrated_diameter**2
    settings = {"pulse.shape": "triangle", "interface.calibration": "exact"}
    settings["interface.mean_real_contact_area"] = f"{area!r} um^2"
    return [f"{key}={value}" for key, value in settings.items()]


def _draw_life(axes: "Axes", scenario: "Scenario") -> None:
    model, (age, area) = scenario.model(), _first_life(scenario)
    diameter, pulse = model.calibrated_diameter, model.pulse
    slid = np.linspace(0.0, 2.0 * diameter, 401)
    axes.plot(slid, pulse.area(slid, diameter), color=VERMILION, lw=1.6, label="exact")
    axes.plot(age, area, "o", color=BLUE, ms=3.4, mew=0.0, label="simulated", zorder=3)
    _mark_size(axes, diameter)
    _mark_mean(axes, pulse, diameter)
    axes.set_xlabel("sliding distance since first touch (µm)")
    axes.set_xlim(-0.02 * diameter, 2.22 * diameter)
    axes.set_ylim(0.0, 1.2 * 0.25 * pi * diameter**2)
    axes.legend(loc="upper right", borderaxespad=0.0, handlelength=1.4)


def _first_life(scenario: "Scenario") -> tuple[Doubles, Doubles]:
    """Return ages and areas at some ticks of the first junction that is born, which lives and dies alone."""
    record = simulate(scenario)
    rows, trace = record["junctions"], record["trace"]
    first = int(np.argmax(rows["birth_distance"] > 0.0))
    ends = rows["birth_distance"][first], rows["death_distance"][first]
    ticks = np.arange(*np.searchsorted(trace["distance"], ends))
    some = ticks[:: max(1, ticks.size // DOTS)]
    return trace["distance"][some] - ends[0], trace["real_contact_area"][some]


def _mark_size(axes: "Axes", diameter: float) -> None:
    peak = 0.25 * pi * diameter**2
    axes.plot([0.0, diameter], [peak, peak], color=FAINT, lw=0.8, ls=(0, (4, 3)), zorder=0)
    axes.plot([diameter, diameter], [0.0, peak], color=FAINT, lw=0.8, ls=(0, (4, 3)), zorder=0)
    axes.text(0.0, 1.02 * peak, f"πd²/4 = {peak:.2f} µm²", ha="left", va="bottom")
    axes.text(1.03 * diameter, 0.02 * peak, "d", ha="left", va="bottom", style="italic")
    axes.text(2.02 * diameter, 0.02 * peak, "2d", ha="left", va="bottom", style="italic")


def _mark_mean(axes: "Axes", pulse: Pulse, diameter: float) -> None:
    mean = 0.5 * pulse.life_integral(1) * diameter**2
    name = "d²/3" if pulse is LENS else "πd²/8"
    axes.plot([0.0, 2.2 * diameter], [mean, mean], color=INK, lw=0.9, ls=(0, (6, 3)), zorder=1)
    axes.text(2.22 * diameter, 1.03 * mean, f"mean {name}\n= {mean:.2f} µm²", ha="right", va="bottom")


def _draw_beside(axes: "Axes", lens: "Scenario") -> None:
    model = lens.model()
    slid = np.linspace(0.0, 2.0 * model.calibrated_diameter, 401)
    axes.plot(
        slid, model.pulse.area(slid, model.calibrated_diameter), color=FAINT, lw=1.2, label="the overlap", zorder=0
    )
    axes.legend(loc="upper right", borderaxespad=0.0, handlelength=1.4)
