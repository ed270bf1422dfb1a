"""Junctions one by one: the contact from above, each pair at its own place; a run and one of its lives."""

from dataclasses import dataclass
from math import ceil, pi, sqrt
from typing import Any, Final

import numpy as np

from rubnoise.analysis.junctions import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures import Axes, Figure
from rubnoise.figures.panes import draw_along, draw_layers
from rubnoise.figures.style import DISTANCE, FAINT, INK, PALE
from rubnoise.figures.tracks import Stretch, Track

MOST_AT_ONCE: Final = 400  # pairs that a stage can show apart

LEAD, BORN = 0.15, 0.3
"""How long, in diameters, a pair is seen before its first and after its last touch, and a birth has its sign."""

CELL, MARGIN, ASPECT = (2.9, 1.12), 0.6, 2.2
"""Width and height of a pair's place in diameters of the largest, places left free at an edge, width over height."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Junctions at a sliding distance and the places of their lower circles, in um; the places are only for the eye."""

    junctions: Neighbours
    distance: float
    x: Doubles
    y: Doubles
    width: float
    height: float

    def draw(self, axes: Axes) -> None:
        """Draw the pairs, their overlaps in shades of area, and signs of births and deaths."""
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize
        from matplotlib.patches import Circle

        pairs = self.junctions
        shift = self.distance - pairs.birth - pairs.half_life
        alive = (pairs.birth <= self.distance) & (self.distance < pairs.death)
        areas = pairs.chosen(alive).area(self.distance)
        shades = ScalarMappable(Normalize(0.0, 0.25 * pi * float(pairs.diameter.max(initial=1.0)) ** 2), "Blues")
        lower = self._circles(axes, 0.0 * shift, -0.5, facecolor=PALE, edgecolor=FAINT, zorder=1)
        upper = self._circles(axes, shift, 0.5, facecolor="none", edgecolor=INK, zorder=3)
        for row, colour in zip(np.flatnonzero(alive).tolist(), shades.to_rgba(areas), strict=True):
            overlap = axes.add_patch(Circle(upper[row], 0.5 * pairs.diameter[row], color=colour, lw=0.0, zorder=2))
            overlap.set_clip_path(Circle(lower[row], 0.5 * pairs.diameter[row], transform=axes.transData))
        label = "upper surface, sliding \N{RIGHTWARDS ARROW}"
        axes.plot([], [], marker="o", ms=8.0, mfc="none", mew=0.7, ls="", color=INK, label=label)
        self._signs(axes, pairs.birth, BORN, marker="o", mfc="white", ms=5.0, label="birth")
        self._signs(axes, pairs.death, LEAD, marker="x", ms=6.0, label="death")
        axes.set(aspect="equal", xlim=(0.0, self.width), ylim=(-0.1 * self.height, self.height), yticks=[])
        axes.xaxis.set_major_formatter("{x:g} µm")
        axes.tick_params(axis="x", direction="in", pad=-14.0)  # below the pairs
        axes.spines["left"].set_visible(False)
        axes.figure.colorbar(shades, ax=axes, pad=0.01, aspect=25.0, label="area of a junction (µm²)")

    def _signs(self, axes: Axes, events: Doubles, lasting: float, **look: Any) -> None:
        """Mark the first and last touch of pairs, and early ends, for some diameters of sliding."""
        pairs = self.junctions
        which = (events <= self.distance) & (self.distance < events + lasting * pairs.diameter)
        middle = self.x + 0.5 * (events - pairs.birth - pairs.half_life)
        axes.plot(middle[which], self.y[which], ls="", color=INK, mew=1.2, zorder=4, **look)

    def _circles(self, axes: Axes, shift: Doubles, aside: float, **look: Any) -> Doubles:
        """Draw circles ``shift`` um along the motion and a part of their offsets across it; return their centres."""
        from matplotlib.collections import EllipseCollection

        size, offset = self.junctions.diameter, self.junctions.offset
        places = np.stack([self.x + shift, self.y + (0.0 if offset is None else aside * offset)], axis=-1)
        look |= {"units": "xy", "offsets": places, "offset_transform": axes.transData, "lw": 0.7}
        axes.add_collection(EllipseCollection(size, size, 0.0 * size, **look))
        return places


def stage_of(stretch: Stretch, distance: float) -> Stage:
    """Return the pairs that are near each other at a distance, each at its own place.

    Raises Refused if there are more of them than a picture shows.
    """
    margin = stretch.model.mean_life_distance
    junctions = neighbours(stretch.file, distance - margin, distance + margin)
    lead = LEAD * junctions.diameter
    junctions = junctions.chosen((distance >= junctions.birth - lead) & (distance < junctions.death + lead))
    count = junctions.diameter.size
    if count > MOST_AT_ONCE:
        raise Refused(f"{count:,} junctions are there at once, of which a picture shows {MOST_AT_ONCE} at most")
    largest = float(junctions.diameter.max(initial=1.0))
    # Circles that miss the centre lie on either side of the line of motion.
    wide, high = CELL[0] * largest, (1.0 if junctions.offset is None else 2.0) * CELL[1] * largest
    columns = max(1, round(sqrt(count * ASPECT * high / wide)))
    row, column = np.divmod(np.arange(count), columns)
    return Stage(
        junctions=junctions,
        distance=distance,
        x=(column + MARGIN + 0.4 * (row % 2)) * wide,
        y=(row + MARGIN) * high,
        width=(columns + 2.0 * MARGIN - 0.6) * wide,
        height=(max(1, ceil(count / columns)) + 0.2) * high,
    )


def draw_contact(figure: Figure, stretch: Stretch) -> str:
    """Draw the junctions alive at the start of a stretch, in the middle of a run if none was chosen.

    The model has no places: those of junctions are only for the eye. Raises Refused if there are more of them than a
    picture shows.
    """
    distance = stretch.start if stretch.chosen else 0.5 * (stretch.start + stretch.stop)
    stage = stage_of(stretch, distance)
    alive = stage.junctions.alive(distance)
    words = f"{alive.rows.size} junctions, {float(alive.area(distance).sum()):.4g} µm² in contact"
    stage.draw(figure.subplots())
    return f"The contact from above at {distance:,.1f} µm: {words}"


BESIDE: Final = 1.5  # how far the window goes beyond the junction on either side, in its own lives


def draw_overview(figure: Figure, stretch: Stretch) -> str:
    """Draw a run, and the life of one of its junctions: one in its middle, of about the mean diameter.

    Below are force and displacement of its slider, without one area and count beside theory. Raises Refused for a run
    without junctions.
    """
    model, file, middle = stretch.model, stretch.file, 0.5 * (stretch.start + stretch.stop)
    if not file.rows("junctions"):
        raise Refused("no junction lives in this run; there is nothing to draw")
    first = min(stretch.first_born(middle), file.rows("junctions") - 1)
    last = max(stretch.first_born(middle + model.mean_life_distance), first + 1)
    diameter = file.column("junctions", "diameter", first, last)
    number = first + int(np.argmin(np.abs(diameter - model.sizes.moment(1))))
    ends = (file.column("junctions", name, number, number + 1) for name in ("birth_distance", "death_distance"))
    birth, death = (float(end[0]) for end in ends)
    shown, age = stretch.about(birth, death, BESIDE), np.linspace(0.0, death - birth, 400)
    window, alive = np.linspace(shown.start, shown.stop, 1200), neighbours(file, shown.start, shown.stop)
    names = ["area", "count"]
    if model.slider is not None:
        names = ["base" if model.slider.excitation == "base" else "force", "displacement"]
    layout: Any = [["sum", "sum", "life"], *([name] * 3 for name in names)]
    axes: Any = figure.subplot_mosaic(layout)
    draw_layers(axes["sum"], window, alive.areas(window), int(np.argmax(alive.rows == number)))
    axes["sum"].set(xlabel=DISTANCE, ylabel="area (µm²)")
    area = alive.chosen(alive.rows == number).areas(birth + age)[0]
    axes["life"].fill_between(age, area, color=INK, alpha=0.18, lw=0.0)
    axes["life"].plot(age, area, color=INK, lw=2.2)
    axes["life"].set(xlim=(0.0, age[-1]), xlabel="its age (µm)", ylabel="its area (µm²)")
    axes["life"].set_ylim(bottom=0.0)
    upper, lower = (Track.of(stretch, name) for name in names)
    lower = lower.shown()
    draw_along(axes[names[0]], [upper.between(*lower.ends)], last=False)
    draw_along(axes[names[1]], [lower])
    axes[names[0]].sharex(axes[names[1]])
    for name in names:  # the panes are low
        axes[name].set_ylabel(axes[name].get_ylabel().replace("contact ", "contact\n").replace("live ", "live\n"))
    return f"The run at a glance, and the life of junction {number} (black)"
