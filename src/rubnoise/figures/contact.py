"""The contact from above at one sliding distance: a still of the film."""

from typing import TYPE_CHECKING

from rubnoise.analysis.selection import neighbours
from rubnoise.figures.stage import stage_of
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import add_title, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def contact_figure(stretch: Stretch) -> "Figure":
    """Draw the junctions alive at the start of a stretch, in the middle of a run if none was chosen.

    The model has no places: where a junction stands is for the eye alone. Raises Refused if more of them are there than
    a picture shows.
    """
    distance = stretch.start if stretch.chosen else 0.5 * (stretch.start + stretch.stop)
    margin = stretch.model.mean_life_distance
    stage = stage_of(neighbours(stretch.file, -1, distance - margin, distance + margin), 2.2)
    alive = stage.junctions.alive(distance)
    figure = new_figure(7.2, 4.4)
    words = f"{alive.rows.size} junctions, {float(alive.area(distance).sum()):.4g} µm² in contact"
    add_title(figure, stretch, f"The contact from above at {distance:,.1f} µm: {words}")
    axes = figure.subplots()
    stage.set_up(axes)
    stage.draw(axes, distance)
    return figure
