"""The single junctions under the real contact area: how their lives add up to it."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.marks import AREA, DISTANCE, entitle, exact_band, from_zero, legend_above
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, FAINT, INK, VERMILION, new_figure
from rubnoise.theory.campbell import area_cumulants

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIVES: Final = 4.0
MOST_DRAWN: Final = 2000
USUALLY_DRAWN: Final = 400
"""Junctions that are drawn at most, and about how many by default."""

SAMPLES: Final = 800
SAMPLES_A_LIFE: Final = 40
MOST_SAMPLES: Final = 4000
SHADES: Final = ("#e3eef5", "#a9cce3", "#c6dcea", "#8dbbd9")
"""Pale blues of neighbouring layers."""


def lives_figure(stretch: Stretch) -> "Figure":
    """Draw the areas of all junctions of a stretch, layer upon layer up to their sum, and each by itself.

    Raises Refused for a stretch with more junctions than a picture can show.
    """
    shown = stretch.narrowed(_usual_width(stretch))
    alive = neighbours(stretch.file, -1, shown.start, shown.stop)
    if alive.rows.size > MOST_DRAWN:
        raise Refused(
            f"{alive.rows.size:,} junctions live in this stretch, of which a picture shows {MOST_DRAWN:,} at most;"
            " --from and --to choose a shorter one"
        )
    distance = np.linspace(shown.start, shown.stop, _samples(shown))
    areas = _areas(shown, alive, distance)
    figure = new_figure(7.2, 5.2)
    entitle(figure, stretch, f"{alive.rows.size} junctions and their sum")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1])
    _draw_sum(above, shown, distance, areas)
    _draw_each(below, shown, distance, areas)
    return figure


def _usual_width(stretch: Stretch) -> float:
    births = max(USUALLY_DRAWN - stretch.model.mean_junction_count, 0.1 * stretch.model.mean_junction_count)
    return min(LIVES * stretch.model.mean_life_distance, births * stretch.model.mean_birth_spacing)


def _samples(stretch: Stretch) -> int:
    lives = (stretch.stop - stretch.start) / stretch.model.mean_life_distance
    return int(min(max(SAMPLES, SAMPLES_A_LIFE * lives), MOST_SAMPLES))


def _areas(stretch: Stretch, alive: Neighbours, distance: Doubles) -> Doubles:
    """Return the area of every junction, a row each, at sliding distances; 0 where it is not alive."""
    birth, death = alive.birth[:, np.newaxis], alive.death[:, np.newaxis]
    areas = stretch.model.pulse.area(distance - birth, alive.diameter[:, np.newaxis])
    return np.where((birth <= distance) & (distance < death), areas, 0.0)


def _draw_sum(axes: "Axes", stretch: Stretch, distance: Doubles, areas: Doubles) -> None:
    exact = area_cumulants(stretch.model)
    exact_band(axes, exact.mean, exact.std)
    if areas.size:
        axes.stackplot(distance, areas, colors=SHADES, lw=0.0)
    axes.plot(distance, areas.sum(axis=0), color=BLUE, lw=1.6, label="their sum, the simulated area")
    axes.set_xlim(stretch.start, stretch.stop)
    from_zero(axes)
    axes.set_ylabel(AREA)
    legend_above(axes)


def _draw_each(axes: "Axes", stretch: Stretch, distance: Doubles, areas: Doubles) -> None:
    for row in areas:
        axes.plot(distance[row > 0.0], row[row > 0.0], color=FAINT, lw=0.6)
    largest = areas.max(axis=1, initial=0.0)
    if largest.size:
        row = areas[np.argmax(largest)]
        axes.plot(distance[row > 0.0], row[row > 0.0], color=INK, lw=1.6, label="the largest of them")
    peak = 0.25 * np.pi * stretch.model.sizes.moment(2)
    axes.axhline(peak, color=VERMILION, lw=1.2, zorder=0, label="exact mean of the area at mid-life")
    axes.set_ylim(0.0, 1.1 * max(peak, float(largest.max(initial=0.0))))
    axes.set_ylabel("junction area (µm²)")
    axes.set_xlabel(DISTANCE)
    legend_above(axes)
