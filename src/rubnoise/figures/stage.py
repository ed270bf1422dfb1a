"""The contact seen through the upper surface: pairs of circles that slide over each other, each in its own place."""

from dataclasses import dataclass
from math import ceil, pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import Neighbours
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.style import FAINT, INK, PALE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap

MOST_AT_ONCE: Final = 400
"""Pairs that a stage can show apart."""

LEAD: Final = 0.25
"""How long, in diameters, a pair is seen before it touches and after it has parted."""

CELL: Final = (3.1, 1.3)
"""Width and height of a pair's place, in diameters of the largest."""

SPARE: Final = 1.2
ARC_POINTS: Final = 25
GOLDEN: Final = (sqrt(5.0) - 1.0) / 2.0
SHADES: Final = ("#c9dfee", "#0072b2", "#04213a")
"""From little area to much; a grey printer keeps them in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Junctions and where their lower circles stand, in um; the model has no places, so these are for the eye alone."""

    junctions: Neighbours
    x: Doubles
    y: Doubles
    width: float
    height: float
    largest_area: float

    def draw(self, axes: "Axes", distance: float) -> list[Any]:
        """Draw the pairs that are near each other at a distance in um, and return what was drawn."""
        from matplotlib.collections import PolyCollection

        pairs = self.junctions
        shift = distance - pairs.birth - pairs.diameter
        lead = LEAD * pairs.diameter
        near = np.flatnonzero((distance >= pairs.birth - lead) & (distance < pairs.death + lead))
        touching = np.flatnonzero((distance >= pairs.birth) & (distance < pairs.death))
        areas = pairs.pulse.area(distance - pairs.birth[touching], pairs.diameter[touching])
        lenses = [self._lens(i, float(shift[i])) for i in touching.tolist()]
        overlap = PolyCollection(lenses, array=areas, cmap=_shades(), clim=(0.0, self.largest_area), lw=0.0, zorder=2)
        drawn = [
            axes.add_collection(self._circles(near, 0.0 * shift, facecolor=PALE, edgecolor=FAINT, zorder=1)),
            axes.add_collection(overlap),
            axes.add_collection(self._circles(near, shift, facecolor="none", edgecolor=INK, zorder=3)),
        ]
        return [*drawn, *_marks(axes, self.width, self.height, distance)]

    def _circles(self, which: NDArray[np.int64], shift: Doubles, **look: Any) -> Any:
        from matplotlib.collections import PolyCollection

        turn = np.linspace(0.0, 2.0 * pi, 2 * ARC_POINTS, endpoint=False)
        radius = 0.5 * self.junctions.diameter[which][:, np.newaxis]
        x = (self.x + shift)[which][:, np.newaxis] + radius * np.cos(turn)
        y = self.y[which][:, np.newaxis] + radius * np.sin(turn)
        return PolyCollection(list(np.stack([x, y], axis=-1)), lw=0.7, **look)

    def _lens(self, row: int, shift: float) -> Doubles:
        """Return the outline of what both circles of a pair cover, their centres ``shift`` um apart."""
        radius = 0.5 * float(self.junctions.diameter[row])
        half = np.arccos(min(abs(shift) / (2.0 * radius), 1.0))
        arc = np.linspace(-half, half, ARC_POINTS)
        # The right edge is that of the circle farther left, and the other way round.
        left, right = min(shift, 0.0), max(shift, 0.0)
        x = np.concatenate([left + radius * np.cos(arc), right - radius * np.cos(arc)])
        y = np.concatenate([radius * np.sin(arc), -radius * np.sin(arc)])
        return np.stack([self.x[row] + x, self.y[row] + y], axis=-1)


def stage_of(junctions: Neighbours, aspect: float) -> Stage:
    """Return a stage of a width over height, on which no two pairs that are seen at once have the same place.

    Raises Refused where more of them are there at once than a picture shows.
    """
    largest = float(junctions.diameter.max(initial=1.0))
    order, slots = _slots(junctions)
    if slots > MOST_AT_ONCE:
        raise Refused(f"{slots:,} junctions are there at once, of which a film shows {MOST_AT_ONCE} at most")
    cells = ceil(SPARE * max(slots, 1))
    wide, high = CELL[0] * largest, CELL[1] * largest
    columns = max(1, round(sqrt(cells * aspect * high / wide)))
    rows = ceil(cells / columns)
    cell = _scattered(columns * rows)[order]
    row, column = np.divmod(cell, columns)
    return Stage(
        junctions=junctions,
        x=(column + 0.75 + 0.5 * (row % 2)) * wide,
        y=(row + 0.75) * high,
        width=(columns + 1.0) * wide,
        height=(rows + 0.5) * high,
        largest_area=float(0.25 * pi * largest**2),
    )


def shades(count: int) -> NDArray[np.uint8]:
    """Return the colours of areas from none to the largest, a row of red, green and blue each."""
    colours: NDArray[np.uint8] = _shades()(np.linspace(0.0, 1.0, count), bytes=True)[:, :3]
    return colours


def _slots(junctions: Neighbours) -> tuple[NDArray[np.int64], int]:
    """Return a number for each junction, unlike that of any other there at once, and how many are there at once."""
    lead = LEAD * junctions.diameter
    free_from: list[float] = []
    numbers = np.empty(junctions.rows.size, dtype=np.int64)
    for i in np.argsort(junctions.birth - lead, kind="stable").tolist():
        begins, ends = float(junctions.birth[i] - lead[i]), float(junctions.death[i] + lead[i])
        # The place that has been empty longest, so that births are seen all over the stage.
        emptiest = min(range(len(free_from)), key=free_from.__getitem__, default=-1)
        if emptiest < 0 or free_from[emptiest] > begins:
            emptiest = len(free_from)
            free_from.append(ends)
        free_from[emptiest] = ends
        numbers[i] = emptiest
    return numbers, len(free_from)


def _scattered(count: int) -> NDArray[np.int64]:
    """Return 0 ... count - 1 in an order that leaves no corner empty for long (multiples of the golden section)."""
    return np.argsort(np.arange(1, count + 1) * GOLDEN % 1.0, kind="stable")


def _marks(axes: "Axes", width: float, height: float, distance: float) -> list[Any]:
    """Draw marks along both edges, those of the upper surface moving with it."""
    from matplotlib.collections import LineCollection

    spacing, length = width / 24.0, 0.035 * height
    drawn = []
    for edge, inwards, shift, colour in ((height, -length, distance % spacing, INK), (0.0, length, 0.0, FAINT)):
        places = np.arange(0.0, width, spacing) + shift
        marks = [[(x, edge), (x, edge + inwards)] for x in places.tolist()]
        drawn.append(axes.add_collection(LineCollection(marks, colors=colour, lw=1.0)))
    return drawn


def _shades() -> "Colormap":
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("area", SHADES)
