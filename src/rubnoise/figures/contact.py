"""The contact from above: junctions as pairs of circles, each pair at its own place."""

from dataclasses import dataclass
from math import ceil, pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import area_of
from rubnoise.errors import Refused
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import FAINT, INK, PALE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

MOST_AT_ONCE: Final = 400
"""Pairs that a stage can show apart."""

LEAD, BORN = 0.15, 0.3
"""How long, in diameters, a pair is seen before its first and after its last touch, and a birth has its sign."""

CELL, MARGIN, ASPECT = (2.9, 1.12), 0.6, 2.2
"""Width and height of a pair's place in diameters of the largest, places left free at an edge, width over height."""

ARC_POINTS: Final = 25
SHADES: Final = ("#c9dfee", "#0072b2", "#04213a")
"""From little area to much; a grey printer keeps them in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Junctions at a sliding distance and the places of their lower circles, in um; the places are only for the eye."""

    junctions: Neighbours
    distance: float
    x: Doubles
    y: Doubles
    width: float
    height: float
    largest_area: float

    def draw(self, axes: "Axes") -> None:
        """Draw the pairs, their overlaps in shades of area, and signs of births and deaths."""
        from matplotlib.collections import PolyCollection
        from matplotlib.colors import LinearSegmentedColormap

        pairs, shades = self.junctions, LinearSegmentedColormap.from_list("area", SHADES)
        shift = self.distance - pairs.birth - pairs.half_life
        touching = np.flatnonzero((self.distance >= pairs.birth) & (self.distance < pairs.death))
        aside = None if pairs.offset is None else pairs.offset[touching]
        areas = area_of(pairs.pulse, self.distance - pairs.birth[touching], pairs.diameter[touching], aside)
        lenses = [self._lens(i, float(shift[i])) for i in touching.tolist()]
        overlaps = PolyCollection(lenses, array=areas, cmap=shades, clim=(0.0, self.largest_area), lw=0.0, zorder=2)
        axes.add_collection(self._circles(0.0 * shift, -0.5, facecolor=PALE, edgecolor=FAINT, zorder=1))
        axes.add_collection(overlaps)
        upper = "upper surface, sliding \N{RIGHTWARDS ARROW}"
        axes.add_collection(self._circles(shift, 0.5, facecolor="none", edgecolor=INK, zorder=3))
        axes.plot([], [], marker="o", ms=8.0, mfc="none", mew=0.7, ls="", color=INK, label=upper)
        self._signs(axes, pairs.birth, BORN, marker="o", mfc="white", ms=5.0, label="birth")
        self._signs(axes, pairs.death, LEAD, marker="x", ms=6.0, label="death")
        axes.set(aspect="equal", xlim=(0.0, self.width), ylim=(-0.1 * self.height, self.height), yticks=[])
        axes.xaxis.set_major_formatter("{x:g} µm")
        axes.tick_params(axis="x", direction="in", pad=-14.0)  # below the pairs
        axes.spines["left"].set_visible(False)
        axes.figure.colorbar(overlaps, ax=axes, pad=0.01, aspect=25.0, label="area of a junction (µm²)")

    def _signs(self, axes: "Axes", events: Doubles, lasting: float, **look: Any) -> None:
        """Mark the first and last touch of pairs, and early ends, for some diameters of sliding."""
        pairs = self.junctions
        which = (events <= self.distance) & (self.distance < events + lasting * pairs.diameter)
        middle = self.x + 0.5 * (events - pairs.birth - pairs.half_life)
        axes.plot(middle[which], self.y[which], ls="", color=INK, mew=1.2, zorder=4, **look)

    def _circles(self, shift: Doubles, aside: float, **look: Any) -> "PolyCollection":
        """Return circles ``shift`` um along the motion and a part of their offsets across it."""
        from matplotlib.collections import PolyCollection

        turn = np.linspace(0.0, 2.0 * pi, 2 * ARC_POINTS, endpoint=False)
        radius = 0.5 * self.junctions.diameter[:, np.newaxis]
        x = (self.x + shift)[:, np.newaxis] + radius * np.cos(turn)
        across = 0.0 if self.junctions.offset is None else aside * self.junctions.offset[:, np.newaxis]
        y = self.y[:, np.newaxis] + across + radius * np.sin(turn)
        return PolyCollection(list(np.stack([x, y], axis=-1)), lw=0.7, **look)

    def _lens(self, row: int, shift: float) -> Doubles:
        """Return the outline of the overlap of a pair's circles, with centres ``shift`` um apart along the motion."""
        radius = 0.5 * float(self.junctions.diameter[row])
        across = 0.0 if self.junctions.offset is None else float(self.junctions.offset[row])
        apart, turn = np.hypot(shift, across), np.arctan2(across, shift)
        half = np.arccos(min(apart / (2.0 * radius), 1.0))
        arc = np.linspace(-half, half, ARC_POINTS)
        along = np.concatenate([radius * np.cos(arc) - 0.5 * apart, 0.5 * apart - radius * np.cos(arc)])
        beside = np.concatenate([radius * np.sin(arc), -radius * np.sin(arc)])
        x = 0.5 * shift + along * np.cos(turn) - beside * np.sin(turn)
        y = along * np.sin(turn) + beside * np.cos(turn)
        return np.stack([self.x[row] + x, self.y[row] + y], axis=-1)


def stage_of(stretch: Stretch, distance: float) -> Stage:
    """Return the pairs that are near each other at a distance, each at its own place.

    Raises Refused if there are more of them than a picture shows.
    """
    margin = stretch.model.mean_life_distance
    junctions = neighbours(stretch.file, -1, distance - margin, distance + margin)
    lead = LEAD * junctions.diameter
    junctions = junctions.chosen((distance >= junctions.birth - lead) & (distance < junctions.death + lead))
    count = junctions.diameter.size
    if count > MOST_AT_ONCE:
        raise Refused(f"{count:,} junctions are there at once, of which a picture shows {MOST_AT_ONCE} at most")
    largest = float(junctions.diameter.max(initial=1.0))
    # Circles that miss the centre lie on either side of the line of motion.
    wide, high = CELL[0] * largest, (1.0 if junctions.offset is None else 2.0) * CELL[1] * largest
    cells = max(count, 1)
    sizes = {n: ((n + 2.0 * MARGIN - 0.6) * wide, (ceil(cells / n) + 0.2) * high) for n in range(1, cells + 1)}
    columns = min(sizes, key=lambda n: max(sizes[n][1], sizes[n][0] / ASPECT))
    row, column = np.divmod(np.arange(count), columns)
    return Stage(
        junctions=junctions,
        distance=distance,
        x=(column + MARGIN + 0.4 * (row % 2)) * wide,
        y=(row + MARGIN) * high,
        width=sizes[columns][0],
        height=sizes[columns][1],
        largest_area=float(0.25 * pi * largest**2),
    )


def draw_contact(figure: "Figure", stretch: Stretch) -> str:
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
