"""Junctions one by one: the contact from above, each pair at its own place; a run and one of its lives; one life."""

from dataclasses import dataclass
from math import ceil, pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.life import Life
from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.panes import draw_along, draw_layers
from rubnoise.figures.style import BLUE, DISTANCE, FAINT, INK, PALE, house_style, new_figure, shortened
from rubnoise.figures.tracks import Stretch, Track
from rubnoise.record.rows import JunctionState

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


MOST_AT_ONCE: Final = 400
"""Pairs that a stage can show apart."""

LEAD, BORN = 0.15, 0.3
"""How long, in diameters, a pair is seen before its first and after its last touch, and a birth has its sign."""

CELL, MARGIN, ASPECT = (2.9, 1.12), 0.6, 2.2
"""Width and height of a pair's place in diameters of the largest, places left free at an edge, width over height."""

ARC_POINTS: Final = 25


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Junctions at a sliding distance and the places of their lower circles, in um; the places are only for the eye."""

    junctions: Neighbours
    distance: float
    x: Doubles
    y: Doubles
    width: float
    height: float

    def draw(self, axes: "Axes") -> None:
        """Draw the pairs, their overlaps in shades of area, and signs of births and deaths."""
        from matplotlib.collections import PolyCollection

        pairs = self.junctions
        shift = self.distance - pairs.birth - pairs.half_life
        alive = (pairs.birth <= self.distance) & (self.distance < pairs.death)
        lenses = [self._lens(row, float(shift[row])) for row in np.flatnonzero(alive).tolist()]
        most = 0.25 * pi * float(pairs.diameter.max(initial=1.0)) ** 2
        look: dict[str, Any] = {"cmap": "Blues", "clim": (0.0, most), "lw": 0.0, "zorder": 2}
        overlaps = PolyCollection(lenses, array=pairs.chosen(alive).area(self.distance), **look)
        self._circles(axes, 0.0 * shift, -0.5, facecolor=PALE, edgecolor=FAINT, zorder=1)
        axes.add_collection(overlaps)
        upper = "upper surface, sliding \N{RIGHTWARDS ARROW}"
        self._circles(axes, shift, 0.5, facecolor="none", edgecolor=INK, zorder=3)
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

    def _circles(self, axes: "Axes", shift: Doubles, aside: float, **look: Any) -> None:
        """Draw circles ``shift`` um along the motion and a part of their offsets across it."""
        from matplotlib.collections import EllipseCollection

        size, offset = self.junctions.diameter, self.junctions.offset
        places = np.stack([self.x + shift, self.y + (0.0 if offset is None else aside * offset)], axis=-1)
        look |= {"units": "xy", "offsets": places, "offset_transform": axes.transData, "lw": 0.7}
        axes.add_collection(EllipseCollection(size, size, 0.0 * size, **look))

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


WINDOW_LIVES: Final = 4.0
"""Width of the window around the junction, in its own lives."""


def draw_overview(figure: "Figure", stretch: Stretch) -> str:
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
    start = max(birth - 0.5 * (WINDOW_LIVES - 1.0) * (death - birth), 0.0)
    window, age = np.linspace(start, start + WINDOW_LIVES * (death - birth), 1200), np.linspace(0.0, death - birth, 400)
    alive = neighbours(file, -1, start, float(window[-1]))
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
    axes["life"].set(xlim=(0.0, age[-1]), xlabel="since its birth (µm)", ylabel="its area (µm²)")
    axes["life"].set_ylim(bottom=0.0)
    upper, lower = (Track.of(stretch, name) for name in names)
    lower = lower.shown()
    draw_along(axes[names[0]], [upper.between(*lower.ends)], last=False)
    draw_along(axes[names[1]], [lower])
    axes[names[0]].sharex(axes[names[1]])
    for name in names:  # the panes are low
        axes[name].set_ylabel(axes[name].get_ylabel().replace("contact ", "contact\n").replace("live ", "live\n"))
    return f"The run at a glance, and the life of junction {number} (black)"


MOST_DRAWN: Final = 60
"""Neighbours drawn, evenly chosen in order of birth; of more the picture would be a grey cloud."""

SAMPLES: Final = 401


@house_style()
def draw_life(life: Life, source: str = "") -> "Figure":
    """Draw one life; ``source`` is the origin in its title."""
    figure = new_figure(6.6, 5.6)
    above, below = figure.subplots(2, 1, sharex=True)
    whose = f"Junction {life.number:,}" + (f" of {shortened(source)}" if source else "")
    ended = ", ended early" if JunctionState.ENDED_EARLY in life.state else ""
    born = f"born at {life.birth_distance:,.2f} µm{ended}"
    above.set_title(f"{whose}\ndiameter {life.diameter:.4g} µm, {born}", pad=10.0)
    _draw_areas(above, life)
    _draw_contact(below, life)
    for axes in (above, below):
        _shade_unknown(axes, life)
        axes.legend(loc="upper right", ncols=3, frameon=True, fancybox=False, edgecolor="none", framealpha=1.0)
    below.set_xlabel("sliding distance since its birth (µm)")
    below.set_xlim(0.0, life.life_distance)
    return figure


def _draw_areas(axes: "Axes", life: Life) -> None:
    """Draw the area of a junction over those of its neighbours."""
    count, age = life.others.birth.size, np.linspace(0.0, life.life_distance, SAMPLES)
    some = life.others.chosen(slice(None, None, max(1, ceil(count / MOST_DRAWN))))
    areas = some.areas(life.birth_distance + age)
    lines = axes.plot(age, np.where(areas > 0.0, areas, np.nan).T, color=FAINT, lw=0.7)
    if lines:
        lines[0].set_label(f"{len(lines)} of the {count:,} others" if len(lines) < count else "the others")
    curve = life.curve()
    age, area = curve["distance"] - life.birth_distance, curve["area"]
    axes.fill_between(age, area, color=BLUE, alpha=0.18, lw=0.0)
    axes.plot(age, area, color=BLUE, lw=2.4, label="this junction")
    peak, words = life.peak, f"largest in the record, {life.peak.area:.4g} µm²"
    axes.plot(peak.age, peak.area, "o", label=words, color=INK, ms=4.5, zorder=5, clip_on=False)
    tallest = max(float(area.max()), float(0.25 * np.pi * np.max(life.others.diameter, initial=0.0) ** 2))
    axes.set_ylim(0.0, 1.32 * tallest)
    axes.set_ylabel("junction area (µm²)")


def _draw_contact(axes: "Axes", life: Life) -> None:
    age = np.linspace(0.0, life.life_distance, SAMPLES)
    distance = life.birth_distance + age
    known = (distance >= 0.0) & (distance <= life.record_end)
    own = life.area_at_age(age)
    total = np.where(known, own + life.others.total_area(distance), np.nan)
    axes.fill_between(age, np.where(known, own, np.nan), color=BLUE, lw=0.0, label="this junction")
    axes.plot(age, total, color=INK, lw=1.4, label="all junctions")
    axes.plot(life.peak.age, life.peak.real_contact_area, "o", color=INK, ms=4.5, clip_on=False)
    axes.set_ylim(0.0, 1.25 * float(np.nanmax(total, initial=life.peak.real_contact_area)))
    axes.set_ylabel("real contact area (µm²)")
    axes.set_title(f"{100.0 * life.peak.area_share:.3g} % of the real contact area at the dot")


def _shade_unknown(axes: "Axes", life: Life) -> None:
    """Mark the parts before the start and after the end of the record, where the other live junctions are unknown."""
    start, end = -life.birth_distance, life.record_end - life.birth_distance
    for first, last, words in ((0.0, start, "before the start"), (end, life.life_distance, "after the end")):
        if first < last:
            # Named in the legend: in the band the words would hide curves, or, in a narrow one, the axis beside it.
            axes.axvspan(first, last, facecolor=PALE, edgecolor=FAINT, hatch="//", lw=0.0, zorder=0, label=words)
