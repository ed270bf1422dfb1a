"""The contact from above: junctions as pairs of circles, each pair at its own place."""

from dataclasses import dataclass
from math import ceil, floor, log10, pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.contact.off_centre import area_of
from rubnoise.errors import Refused
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import FAINT, INK, PALE, add_title, legend_above

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

MOST_AT_ONCE: Final = 400
"""Pairs that a stage can show apart."""

LEAD: Final = 0.15
"""How long, in diameters, a pair is seen before it touches and after it has parted, then with the sign of a death."""

BORN: Final = 0.3
"""How long, in diameters, a birth has its sign."""

CELL: Final = (2.9, 1.12)
"""Width and height of a pair's place, in diameters of the largest."""

MARGINS: Final = (0.6, 0.4, 0.2)
"""From the edge to the first pair, of every second row to the right, and above the last row, in places."""

ASPECT: Final = 2.2
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

    def set_up(self, axes: "Axes") -> None:
        """Give axes the size of the stage and a key, and remove their ticks and edges."""
        axes.set_aspect("equal")
        axes.set_xlim(0.0, self.width)
        axes.set_ylim(-0.1 * self.height, self.height)  # below the stage is the scale bar
        axes.set_xticks([])
        axes.set_yticks([])
        for side in ("left", "bottom"):
            axes.spines[side].set_visible(False)
        _add_scale_bar(axes, self.width, self.height)
        _add_key(axes, self.largest_area)

    def draw(self, axes: "Axes") -> None:
        """Draw the pairs, their overlaps, and signs of births and deaths."""
        from matplotlib.collections import PolyCollection

        pairs = self.junctions
        shift = self.distance - pairs.birth - pairs.half_life
        touching = np.flatnonzero((self.distance >= pairs.birth) & (self.distance < pairs.death))
        aside = None if pairs.offset is None else pairs.offset[touching]
        areas = area_of(pairs.pulse, self.distance - pairs.birth[touching], pairs.diameter[touching], aside)
        lenses = [self._lens(i, float(shift[i])) for i in touching.tolist()]
        axes.add_collection(self._circles(0.0 * shift, -0.5, facecolor=PALE, edgecolor=FAINT, zorder=1))
        axes.add_collection(
            PolyCollection(lenses, array=areas, cmap=_shades(), clim=(0.0, self.largest_area), lw=0.0, zorder=2)
        )
        axes.add_collection(self._circles(shift, 0.5, facecolor="none", edgecolor=INK, zorder=3))
        self._signs(axes, pairs.birth, BORN, marker="o", mfc="white", ms=5.0)
        self._signs(axes, pairs.death, LEAD, marker="x", ms=6.0)
        _edge_marks(axes, self.width, self.height, self.distance)

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
    spread = 1.0 if junctions.offset is None else 2.0  # circles lie on either side of the line of motion
    wide, high = CELL[0] * largest, spread * CELL[1] * largest
    cells = max(count, 1)
    columns = min(range(1, cells + 1), key=lambda columns: _height(cells, columns, spread))
    rows = ceil(cells / columns)
    row, column = np.divmod(np.arange(count), columns)
    return Stage(
        junctions=junctions,
        distance=distance,
        x=(column + MARGINS[0] + MARGINS[1] * (row % 2)) * wide,
        y=(row + MARGINS[0]) * high,
        width=_columns_width(columns) * wide,
        height=(rows + MARGINS[2]) * high,
        largest_area=float(0.25 * pi * largest**2),
    )


def _columns_width(columns: int) -> float:
    return columns - 1.0 + 2.0 * MARGINS[0] + MARGINS[1]


def _height(cells: int, columns: int, spread: float) -> float:
    """Return the height in diameters of a view with the places in ``columns`` columns.

    Places are ``spread`` times as high as those of centred passes.
    """
    return max((ceil(cells / columns) + MARGINS[2]) * spread * CELL[1], _columns_width(columns) * CELL[0] / ASPECT)


def _add_scale_bar(axes: "Axes", width: float, height: float) -> None:
    """Draw a bar of 1, 2 or 5 times a power of ten below the stage, an eighth of its width at most."""
    power = 10.0 ** floor(log10(0.125 * width))
    length = power * max(digit for digit in (1.0, 2.0, 5.0) if digit * power <= 0.125 * width)
    start, below = 0.02 * width, -0.05 * height
    axes.plot([start, start + length], [below, below], color=INK, lw=2.5, solid_capstyle="butt")
    axes.text(start + 1.2 * length, below, f"{length:g} µm", va="center")


def _edge_marks(axes: "Axes", width: float, height: float, distance: float) -> None:
    """Draw marks along both edges, those of the upper surface moving with it."""
    from matplotlib.collections import LineCollection

    spacing, length = width / 24.0, 0.035 * height
    for edge, inwards, shift, colour in ((height, -length, distance % spacing, INK), (0.0, length, 0.0, FAINT)):
        places = np.arange(0.0, width, spacing) + shift
        marks = [[(x, edge), (x, edge + inwards)] for x in places.tolist()]
        axes.add_collection(LineCollection(marks, colors=colour, lw=1.0))


def _shades() -> "Colormap":
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("area", SHADES)


def _add_key(axes: "Axes", largest_area: float) -> None:
    """Draw a key for outlines, signs and shades of area."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    shown: dict[str, Any] = {"ls": "", "color": INK}
    upper = "upper surface, sliding \N{RIGHTWARDS ARROW}"
    axes.plot([], [], marker="o", ms=8.0, mfc="none", mew=0.7, label=upper, **shown)
    axes.plot([], [], marker="o", ms=5.0, mfc="white", mew=1.2, label="birth", **shown)
    axes.plot([], [], marker="x", ms=6.0, mew=1.2, label="death", **shown)
    legend_above(axes)
    scale = ScalarMappable(Normalize(0.0, largest_area), _shades())
    axes.figure.colorbar(scale, ax=axes, pad=0.01, aspect=25.0, label="area of a junction (µm²)")


def draw_contact(figure: "Figure", stretch: Stretch) -> None:
    """Draw the junctions alive at the start of a stretch, in the middle of a run if none was chosen.

    The model has no places: those of junctions are only for the eye. Raises Refused if there are more of them than a
    picture shows.
    """
    distance = stretch.start if stretch.chosen else 0.5 * (stretch.start + stretch.stop)
    stage = stage_of(stretch, distance)
    alive = stage.junctions.alive(distance)
    words = f"{alive.rows.size} junctions, {float(alive.area(distance).sum()):.4g} µm² in contact"
    add_title(figure, stretch, f"The contact from above at {distance:,.1f} µm: {words}")
    axes = figure.subplots()
    stage.set_up(axes)
    stage.draw(axes)
