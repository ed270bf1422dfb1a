"""Life-lines: a bar from birth to death for each junction, and the count as the number of bars above a place."""

from heapq import heappop, heappush
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.errors import Refused
from rubnoise.figures.area import COUNT, MOST_DRAWN, MOST_MARKED, default_width
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import (
    BLUE,
    DISTANCE,
    FAINT,
    INK,
    add_title,
    exact_band,
    from_zero,
    legend_above,
    new_figure,
)
from rubnoise.theory.exact import exact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BAR: Final = 0.7
"""Height of a bar over that of its lane."""


def lanes(birth: NDArray[np.float64], death: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return for each life the lowest lane that is free at its birth; births in order, um, death later than birth."""
    found = np.zeros(birth.size, dtype=np.int64)
    alive: list[tuple[float, int]] = []
    free: list[int] = []
    used = 0
    for row, (begin, end) in enumerate(zip(birth.tolist(), death.tolist(), strict=True)):
        while alive and alive[0][0] <= begin:
            heappush(free, heappop(alive)[1])
        if not free:
            heappush(free, used)
            used += 1
        found[row] = heappop(free)
        heappush(alive, (end, int(found[row])))
    return found


def lifelines_figure(stretch: Stretch) -> "Figure":
    """Draw the lives of a stretch as bars in lanes, a line across its middle, and below them the count.

    Raises Refused for a stretch with more junctions than a picture can show.
    """
    shown = stretch.narrowed(default_width(stretch))
    alive = neighbours(stretch.file, -1, shown.start, shown.stop)
    if alive.rows.size > MOST_DRAWN:
        raise Refused(
            f"{alive.rows.size:,} junctions live in this stretch, of which a picture shows {MOST_DRAWN:,} at most;"
            " --from and --to choose a shorter one"
        )
    middle = 0.5 * (shown.start + shown.stop)
    figure = new_figure(7.2, 5.2)
    add_title(figure, stretch, f"{alive.rows.size} lives, from birth to death")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    _draw_lives(above, shown, alive, middle)
    _draw_count(below, shown, middle)
    return figure


def _draw_lives(axes: "Axes", stretch: Stretch, lives: Neighbours, middle: float) -> None:
    place = lanes(lives.birth, lives.death).astype(np.float64) - 0.5 * BAR
    crossed = (lives.birth <= middle) & (middle < lives.death)
    for rows, colour, label in (
        (~crossed, FAINT, "other lives"),
        (crossed, BLUE, f"{crossed.sum()} alive at the line"),
    ):
        spans = np.column_stack([lives.birth, lives.death - lives.birth])[rows]
        _draw_bars(axes, spans, place[rows], colour, label)
    if lives.rows.size <= MOST_MARKED:
        axes.plot(lives.birth, place + 0.5 * BAR, "o", color=INK, ms=3.2, mfc="white", mew=0.8, label="birth")
        axes.plot(lives.death, place + 0.5 * BAR, "x", color=INK, ms=3.6, mew=0.9, label="death")
    axes.axvline(middle, color=INK, lw=1.0)
    axes.set_xlim(stretch.start, stretch.stop)
    axes.set_ylim(-1.0, max(float(place.max(initial=0.0)) + 2.0, 3.0))
    axes.set_yticks([])
    axes.set_ylabel("lives")
    legend_above(axes)


def _draw_bars(axes: "Axes", spans: NDArray[np.float64], place: NDArray[np.float64], colour: str, label: str) -> None:
    """Draw bars of spans (first distance, length) in um at heights, as one collection."""
    from matplotlib.collections import PolyCollection

    (first, length), low = spans.T, place
    corners = [(first, low), (first, low + BAR), (first + length, low + BAR), (first + length, low)]
    shapes = np.stack([np.column_stack(corner) for corner in corners], axis=1)
    axes.add_collection(PolyCollection(list(shapes), facecolors=colour, edgecolors="none", label=label))


def _draw_count(axes: "Axes", stretch: Stretch, middle: float) -> None:
    theory = exact(stretch.model)
    exact_band(axes, theory.count_mean, theory.count_std)
    axes.plot(*stretch.curve("trace", "junction_count"), color=BLUE, lw=1.0, drawstyle="steps-post", label="simulated")
    axes.axvline(middle, color=INK, lw=1.0)
    from_zero(axes)
    axes.locator_params(axis="y", integer=True)
    axes.set_ylabel(COUNT)
    axes.set_xlabel(DISTANCE)
    legend_above(axes)
