"""Figures 2 and 3 of the paper: the geometry of one junction, and its life."""

from math import pi
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from paper.figures import Sources
from rubnoise.api.running import simulate
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.figures.style import BLUE, FAINT, INK, PALE, VERMILION, new_figure
from rubnoise.model import Model
from rubnoise.scenario import Scenario

SHARE: Final = 0.6
"""How far the shown junction has come, as a share of its diameter: on its way up."""

HEIGHT, FLANK, ABOVE = 0.5, 0.5, 2.9
"""Height of the cones, how far they widen, and how far to the right the circles are drawn, all in diameters."""

DOTS: Final = 36


def draw_fig2(sources: Sources) -> Figure:
    """Draw the cones from the side and their tops from above, in diameters, at one tick of a simulated junction."""
    model, (age, area, diameter) = sources.scenario("fig2").model(), _first_life(sources.scenario("fig2"))
    tick = int(np.argmin(np.abs(age - SHARE * diameter)))
    slid = float(age[tick])
    figure = new_figure(7.2, 3.0)
    axes = figure.subplots()
    _draw_side(axes, slid / diameter)
    _draw_above(axes, slid / diameter)
    areas = (
        f"shaded: {float(model.pulse.area(slid, diameter)):.3f} µm² by Eq. (2),\n{area[tick]:.3f} µm² in the simulation"
    )
    sizes = f"s = {slid:.2f} µm of d = {diameter:.2f} µm\n{areas}"
    axes.text(ABOVE + 0.5 * slid / diameter, -0.85, sizes, ha="center", va="top")
    axes.set(aspect="equal", xlim=(-1.5, 4.5), ylim=(-1.25, 1.1))
    axes.set_axis_off()
    return figure


def _first_life(scenario: Scenario) -> tuple[Doubles, Doubles, float]:
    """Return ages and areas at the ticks of the first junction that is born, which lives and dies alone, and its d."""
    record = simulate(scenario)
    rows, trace = record["junctions"], record["trace"]
    first = int(np.argmax(rows["birth_distance"] > 0.0))
    ends = rows["birth_distance"][first], rows["death_distance"][first]
    ticks = np.arange(*np.searchsorted(trace["distance"], ends))
    return trace["distance"][ticks] - ends[0], trace["real_contact_area"][ticks], float(rows["diameter"][first])


def _draw_side(axes: Axes, slid: float) -> None:
    """Draw the cones, the resting one with its top from 0 to 1 and the other so far to the left that they overlap."""
    cone = np.array([[0.0, 0.0], [1.0, 0.0], [1.0 + FLANK, -HEIGHT], [-FLANK, -HEIGHT]])
    apart = 1.0 - slid
    for corners in (cone, cone * [1.0, -1.0] + [-apart, 0.0]):
        axes.add_patch(Polygon(corners, facecolor=PALE, edgecolor=INK, lw=1.0))
    axes.plot([0.0, slid], [0.0, 0.0], color=BLUE, lw=4.0, solid_capstyle="butt")
    # Both tops lie in the plane of contact, so their diameters are marked off it.
    _measure(axes, (0.0, 1.0), -0.25, "d", ground=PALE)
    _measure(axes, (-apart, slid), 0.25, "d", ground=PALE)
    _mark_overlap(axes, 0.0, slid)
    arrow = {"arrowstyle": "-|>", "color": INK, "lw": 1.2}
    axes.annotate("", (0.95 - apart, 0.68), (0.05 - apart, 0.68), arrowprops=arrow)
    axes.text(0.5 - apart, 0.72, "sliding", ha="center", va="bottom")
    axes.text(-1.45, 1.0, "The asperities, from the side", fontsize=10.0)


def _draw_above(axes: Axes, slid: float) -> None:
    middle, other = (ABOVE + 0.5, 0.0), (ABOVE + slid - 0.5, 0.0)
    moving = Circle(other, 0.5, facecolor="none", edgecolor=INK, lw=1.0)
    lens = Circle(middle, 0.5, facecolor=BLUE, alpha=0.35, edgecolor="none")
    for circle in (Circle(middle, 0.5, facecolor="none", edgecolor=INK, lw=1.0), moving, lens):
        axes.add_patch(circle)
    lens.set_clip_path(moving)
    axes.plot(*zip(middle, other, strict=True), "+", color=INK, ms=7.0)
    _measure(axes, (ABOVE, ABOVE + 1.0), 0.65, "d")
    _mark_overlap(axes, ABOVE, ABOVE + slid)
    axes.text(ABOVE - 0.45, 1.0, "Their flat tops, from above", fontsize=10.0)


def _mark_overlap(axes: Axes, start: float, end: float) -> None:
    """Mark s, the width of the overlap, below the drawing."""
    axes.vlines([start, end], -0.76, 0.0, color=FAINT, lw=0.8, ls=(0, (3, 3)))
    _measure(axes, (start, end), -0.7, "s")


def _measure(axes: Axes, ends: tuple[float, float], height: float, name: str, ground: str = "white") -> None:
    """Draw a length between two places, with its name in the middle."""
    arrow = {"arrowstyle": "<|-|>", "color": INK, "lw": 0.8, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 8.0}
    axes.annotate("", (ends[1], height), (ends[0], height), arrowprops=arrow)
    label = axes.text(0.5 * sum(ends), height, name, ha="center", va="center", style="italic", fontsize=10.0)
    label.set_bbox({"facecolor": ground, "edgecolor": "none", "pad": 1.5})


def draw_fig3(sources: Sources) -> Figure:
    """Draw one life as a lens and as a triangle of the same diameter, simulated and by formula."""
    lens = sources.scenario("fig3")
    triangle = sources.scenario("fig3", *_as_triangle(lens.model()))
    figure = new_figure(7.2, 3.4)
    both = figure.subplots(1, 2, sharey=True)
    _draw_life(both[0], lens, "The overlap of two circles")
    _draw_life(both[1], triangle, "Rabinowicz's triangle")
    both[0].set_ylabel("junction area (µm²)")
    slid = np.linspace(0.0, 2.0 * lens.model().calibrated_diameter, 401)
    area = lens.model().pulse.area(slid, lens.model().calibrated_diameter)
    both[1].plot(slid, area, color=FAINT, lw=1.2, label="the overlap", zorder=0)
    for axes in both:
        axes.legend(loc="upper right", borderaxespad=0.0, handlelength=1.4)
    return figure


def _as_triangle(model: Model) -> list[str]:
    """Return the changes that make the junctions triangles of the same diameter, whose mean area is (pi/8) d^2."""
    area = model.mean_junction_count * TRIANGLE.life_integral(1) / 2.0 * model.calibrated_diameter**2
    whole = f'interface.mean_real_contact_area="{area!r} um^2"'
    return ["pulse.shape=triangle", "interface.calibration=exact", whole]


def _draw_life(axes: Axes, scenario: Scenario, title: str) -> None:
    model, (age, area, _) = scenario.model(), _first_life(scenario)
    diameter, pulse, some = model.calibrated_diameter, model.pulse, slice(None, None, max(1, age.size // DOTS))
    slid = np.linspace(0.0, 2.0 * diameter, 401)
    axes.plot(slid, pulse.area(slid, diameter), color=VERMILION, lw=1.6, label="exact")
    axes.plot(age[some], area[some], "o", color=BLUE, ms=3.4, mew=0.0, label="simulated", zorder=3)
    peak, mean = 0.25 * pi * diameter**2, 0.5 * pulse.life_integral(1) * diameter**2
    axes.plot([0.0, diameter, diameter], [peak, peak, 0.0], color=FAINT, lw=0.8, ls=(0, (4, 3)), zorder=0)
    axes.text(0.0, 1.02 * peak, f"πd²/4 = {peak:.2f} µm²", ha="left", va="bottom")
    axes.text(1.03 * diameter, 0.02 * peak, "d", ha="left", va="bottom", style="italic")
    axes.text(2.02 * diameter, 0.02 * peak, "2d", ha="left", va="bottom", style="italic")
    axes.plot([0.0, 2.2 * diameter], [mean, mean], color=INK, lw=0.9, ls=(0, (6, 3)), zorder=1)
    name = "d²/3" if pulse is LENS else "πd²/8"
    axes.text(2.22 * diameter, 1.03 * mean, f"mean {name}\n= {mean:.2f} µm²", ha="right", va="bottom")
    axes.set(title=title, xlabel="sliding distance since first touch (µm)")
    axes.set(xlim=(-0.02 * diameter, 2.22 * diameter), ylim=(0.0, 1.2 * peak))
