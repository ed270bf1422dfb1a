"""The contact along the sliding distance: its real area, the single junctions under it, and their number."""

from heapq import heappop, heappush
from math import exp, lgamma, log
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.errors import Refused
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import (
    AREA,
    BLUE,
    DISTANCE,
    FAINT,
    INK,
    PALE,
    VERMILION,
    add_title,
    exact_band,
    from_zero,
    legend_above,
    new_figure,
)
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.moments import area_cumulants

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


TRACE_LIVES: Final = 40.0
"""Mean lives that are shown by default."""


def trace_figure(stretch: Stretch) -> "Figure":
    """Draw A_r of a stretch, and above it the place of the stretch in the whole record."""
    shown = stretch.narrowed(TRACE_LIVES * stretch.model.mean_life_distance)
    whole = stretch.whole()
    parted = (shown.start, shown.stop) != (whole.start, whole.stop)
    figure = new_figure(7.2, 4.6 if parted else 3.4)
    add_title(figure, stretch, "The real contact area")
    if parted:
        strip, axes = figure.subplots(2, 1, height_ratios=[1, 2.6])
        _draw_whole_run(strip, whole, shown)
    else:
        axes = figure.subplots()
    _draw_area(axes, shown)
    return figure


def _draw_area(axes: "Axes", stretch: Stretch) -> None:
    if stretch.has_theory:
        area = area_cumulants(stretch.model)
        exact_band(axes, area.mean, area.std)
    axes.plot(*stretch.curve("trace", "real_contact_area"), color=BLUE, lw=0.9, label="simulated")
    axes.set_xlim(stretch.start, stretch.stop)
    from_zero(axes)
    axes.set_xlabel(DISTANCE)
    axes.set_ylabel(AREA)
    legend_above(axes)


def _draw_whole_run(axes: "Axes", whole: Stretch, shown: Stretch) -> None:
    axes.axvspan(shown.start, shown.stop, color=PALE, lw=0.0, zorder=0)
    axes.plot(*whole.curve("trace", "real_contact_area"), color=FAINT, lw=0.5)
    axes.set_xlim(whole.start, whole.stop)
    from_zero(axes)
    axes.set_ylabel("µm²")
    axes.set_xlabel("sliding distance (µm), the stretch below shaded")


LAYER_LIVES: Final = 4.0
MOST_DRAWN: Final = 2000
DEFAULT_DRAWN: Final = 400
"""Junctions that are drawn at most, and about how many by default."""

FEWEST_SAMPLES: Final = 800
SAMPLES_A_LIFE: Final = 40
MOST_SAMPLES: Final = 4000
MOST_MARKED: Final = 250
"""Lives whose births and deaths are marked: with more, the marks would hide one another."""

LARGE_MARKS: Final = 100
"""Lives up to which the marks are large."""

LAYER_SHADES: Final = ("#e3eef5", "#a9cce3", "#c6dcea", "#8dbbd9")
"""Pale blues of neighbouring layers."""


def lives_figure(stretch: Stretch) -> "Figure":
    """Draw the areas of all junctions of a stretch, stacked to their sum, and each by itself.

    Raises Refused for a stretch with more junctions than a picture can show.
    """
    shown = stretch.narrowed(default_width(stretch))
    alive = neighbours(stretch.file, -1, shown.start, shown.stop)
    _refuse_too_many(alive)
    figure = new_figure(7.2, 5.2)
    add_title(figure, stretch, f"{alive.rows.size} junctions and their sum")
    draw_lives(figure, shown, alive)
    return figure


def _refuse_too_many(alive: Neighbours) -> None:
    if alive.rows.size > MOST_DRAWN:
        raise Refused(
            f"{alive.rows.size:,} junctions live in this stretch, of which a picture shows {MOST_DRAWN:,} at most;"
            " --from and --to choose a shorter one"
        )


def draw_lives(figure: "Figure", shown: Stretch, alive: Neighbours) -> None:
    """Draw the sum of the areas of junctions in a stretch, and below it each area by itself."""
    lives = (shown.stop - shown.start) / shown.model.mean_life_distance
    samples = int(min(max(FEWEST_SAMPLES, SAMPLES_A_LIFE * lives), MOST_SAMPLES))
    distance = np.linspace(shown.start, shown.stop, samples)
    areas = alive.areas(distance)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1])
    _draw_sum(above, shown, distance, areas)
    _draw_each(below, shown, distance, areas)
    mark_ends(below, shown.start, shown.stop, alive.birth, alive.death)
    legend_above(below, columns=5)


def default_width(stretch: Stretch) -> float:
    """Return the width in um of a stretch that shows single lives: several, but not too many."""
    births = max(DEFAULT_DRAWN - stretch.model.mean_junction_count, 0.1 * stretch.model.mean_junction_count)
    return min(LAYER_LIVES * stretch.model.mean_life_distance, births * stretch.model.mean_birth_spacing)


def _draw_sum(axes: "Axes", stretch: Stretch, distance: Doubles, areas: Doubles) -> None:
    exact = area_cumulants(stretch.model)
    exact_band(axes, exact.mean, exact.std)
    base, largest = np.zeros(distance.size), int(np.argmax(areas.max(axis=1, initial=0.0))) if areas.size else 0
    for number, row in enumerate(areas):
        alive, shade = row > 0.0, INK if number == largest else LAYER_SHADES[number % len(LAYER_SHADES)]
        axes.fill_between(distance[alive], base[alive], (base + row)[alive], color=shade, lw=0.0, rasterized=True)
        base = base + row
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


def mark_ends(axes: "Axes", start: float, stop: float, birth: Doubles, death: Doubles) -> None:
    """Mark births by rings and deaths by crosses below lives from start to stop, in um, if there is room for them."""
    if birth.size > MOST_MARKED:
        return
    highest, size = axes.get_ylim()[1], 3.4 if birth.size <= LARGE_MARKS else 2.4
    for row, places, marker, label in ((1.0, birth, "o", "birth"), (2.0, death, "x", "death")):
        inside = places[(places >= start) & (places <= stop)]
        level = np.full_like(inside, -0.09 * row * highest)
        axes.plot(inside, level, marker, color=INK, ms=size, mfc="white", mew=0.7, ls="", label=label)
    axes.set_ylim(-0.27 * highest, highest)
    axes.set_yticks([tick for tick in axes.get_yticks() if 0.0 <= tick <= highest])


COUNT_LIVES: Final = 40.0
COUNT: Final = "live junctions"


def count_figure(stretch: Stretch) -> "Figure":
    """Draw N(s) of the stretch's beginning, and beside it the share of each live count in the whole stretch."""
    theory = exact(stretch.model) if stretch.has_theory else None
    figure = new_figure(7.2, 3.4)
    add_title(figure, stretch, "How many junctions are alive")
    along, often = figure.subplots(1, 2, width_ratios=[2.2, 1])
    _draw_count(along, stretch.narrowed(COUNT_LIVES * stretch.model.mean_life_distance), theory)
    _draw_count_shares(often, stretch, theory)
    return figure


def _draw_count(axes: "Axes", stretch: Stretch, theory: Exact | None) -> None:
    if theory is not None:
        exact_band(axes, theory.count_mean, theory.count_std)
    axes.plot(*stretch.curve("trace", "junction_count"), color=BLUE, lw=0.8, drawstyle="steps-post", label="simulated")
    axes.set_xlim(stretch.start, stretch.stop)
    from_zero(axes)
    axes.locator_params(axis="y", integer=True)
    axes.set_xlabel(DISTANCE)
    axes.set_ylabel(COUNT)
    legend_above(axes)


def _draw_count_shares(axes: "Axes", stretch: Stretch, theory: Exact | None) -> None:
    lowest, share = _count_shares(stretch)
    numbers = lowest + np.arange(share.size)
    axes.bar(numbers, share, width=1.0, color=BLUE, alpha=0.45, lw=0.0, label="simulated")
    if theory is None:
        pass
    elif isinstance(stretch.model.births, PoissonBirths):
        axes.plot(numbers, _poisson(numbers, theory.count_mean), "o", color=VERMILION, ms=3.0, label="exact: Poisson")
    else:
        axes.axvline(theory.count_mean, color=VERMILION, label="exact mean")
    axes.locator_params(axis="x", integer=True)
    axes.set_xlabel(COUNT)
    axes.set_ylabel("share of the ticks")
    legend_above(axes, columns=1)


def _count_shares(stretch: Stretch) -> tuple[int, NDArray[np.float64]]:
    """Return the smallest live count, and the shares of it and of all larger ones."""
    found: dict[int, int] = {}
    for chunk in stretch.chunks("trace", "junction_count"):
        numbers, often = np.unique(chunk, return_counts=True)
        for number, times in zip(numbers.tolist(), often.tolist(), strict=True):
            found[number] = found.get(number, 0) + times
    lowest, highest = min(found), max(found)
    times = np.array([found.get(number, 0) for number in range(lowest, highest + 1)], dtype=np.float64)
    return lowest, times / times.sum()


def _poisson(numbers: NDArray[np.int64], mean: float) -> NDArray[np.float64]:
    """Return the probabilities m^n exp(-m) / n! of a Poisson number of mean m."""
    return np.array([exp(n * log(mean) - mean - lgamma(n + 1.0)) for n in numbers.tolist()])


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

    In free motion a bar is a touch of a summit. Raises Refused for a stretch with more than a picture can show.
    """
    width = default_width(stretch) if stretch.has_theory else TRACE_LIVES * stretch.model.mean_life_distance
    shown = stretch.narrowed(width)
    alive = neighbours(stretch.file, -1, shown.start, shown.stop, touches=True)
    _refuse_too_many(alive)
    middle = 0.5 * (shown.start + shown.stop)
    figure = new_figure(7.2, 5.2)
    words = "lives, from birth to death" if stretch.has_theory else "touches, from contact made to contact lost"
    add_title(figure, stretch, f"{alive.rows.size} {words}")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    _draw_lives(above, shown, alive, middle)
    _draw_count(below, shown, exact(shown.model) if shown.has_theory else None)
    below.axvline(middle, color=INK, lw=1.0)
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
