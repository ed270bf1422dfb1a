"""The kinds of panes that pictures are put together from: curves, histograms, counts, lives and a plane.

Blue is simulated and vermilion exact; two runs are a broad pale curve and a thin dark one.
"""

from collections.abc import Sequence
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.landmarks import Flights
from rubnoise.analysis.selection import Neighbours
from rubnoise.arrays import Doubles
from rubnoise.figures import style
from rubnoise.figures.tracks import Track

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def looks_of(tracks: Sequence[Track]) -> list[dict[str, Any]]:
    """Return labels and styles of the curves of one run, or of two, the first broad and pale.

    Labels distinguish runs by their coupling, or else by the names of their files.
    """
    if len(tracks) == 1:
        return [{"color": style.BLUE, "lw": 0.9, "label": "simulated"}]
    labels = [f"{track.swings.coupling} coupling" for track in tracks if track.swings is not None]
    if len(set(labels)) < len(tracks):
        labels = [track.stretch.name for track in tracks]
    broad, thin = {"color": "#6fb3df", "lw": 1.8, "solid_joinstyle": "round"}, {"color": "#04213a", "lw": 0.8}
    return [{**look, "label": label} for look, label in zip((broad, thin), labels, strict=True)]


# Curves along the run.


def draw_along(axes: "Axes", tracks: Sequence[Track], *, last: bool = True, **look: Any) -> None:
    """Draw a quantity of one run or two over place or time, about its exact mean and spread if theory knows them.

    Sticks of a two-way slider and flights of a free one are shaded; ``last``: whether the axis below has its label.
    """
    first = tracks[0]
    known = first.quantity.moments(first.model) if len(tracks) == 1 and first.has_theory else None
    if known is not None:
        style.exact_band(axes, *known)
    for track, own in zip(tracks, looks_of(tracks), strict=True):
        axes.plot(*track.curve(), **(own | look))
    shade(axes, next((track for track in tracks if track.model.is_two_way), first))
    axes.set_xlim(first.begin, first.end)
    if first.group == "trace":
        highest = max(float(axes.dataLim.y1), 0.0)
        axes.set_ylim(0.0, max(axes.get_ylim()[1], 1.05 * highest))
    else:
        low, high = axes.get_ylim()
        middle = 0.5 * (low + high)
        if high - low < style.NEAREST * abs(middle):  # what differs by rounding alone: no axis has the digits for less
            axes.set_ylim(middle - 0.1 * abs(middle), middle + 0.1 * abs(middle))
    axes.set_ylabel(first.quantity.label)
    if last:
        axes.set_xlabel("time (s)" if first.timed else style.DISTANCE)
    else:
        axes.tick_params(labelbottom=False)


MOST_SPANS: Final = 1500
"""Sticks that are shaded one by one; of more each column of the picture is as dark as their share of it."""


def shade(axes: "Axes", track: Track) -> None:
    """Shade where a two-way slider sticks, or where a slider that may leave its contact is off the surface."""
    found = track.landmarks()
    if found is None:
        return
    start, width, share = spans(found.begin, found.end, track.begin, track.end)
    if start.size:
        axes.broken_barh(
            list(zip(start.tolist(), width.tolist(), strict=True)),
            (0.0, 1.0),
            transform=axes.get_xaxis_transform(),
            facecolors=[(*style.STUCK, each) for each in share.tolist()],
            lw=0.0,
            zorder=0,
            label="off the surface" if isinstance(found, Flights) else "stick",
        )


def spans(begin: Doubles, end: Doubles, first: float, last: float) -> tuple[Doubles, Doubles, Doubles]:
    """Return the spans to shade: begins and widths in s, and the share of each that the intervals take."""
    if begin.size <= MOST_SPANS:
        return begin, end - begin, np.ones(begin.size)
    edges = np.linspace(first, last, MOST_SPANS + 1)
    # The time taken up to each edge is piecewise linear, with kinks where an interval begins or ends.
    kinks = np.stack([begin, end], axis=-1).ravel()
    taken = np.stack([np.cumsum(end - begin) - (end - begin), np.cumsum(end - begin)], axis=-1).ravel()
    share = np.diff(np.interp(edges, kinks, taken)) / np.diff(edges)
    return edges[:-1], np.diff(edges), np.clip(share, 0.0, 1.0)


# Histograms.


def edges_of(values: Doubles, bins: int) -> Doubles:
    """Return edges of bins from the least value to the largest; values that differ by rounding alone are in one."""
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    largest = max(abs(low), abs(high))
    room = (1e-9 if high - low > style.NEAREST * largest else 0.1) * (largest or 1.0)
    return np.linspace(low - room if low <= 0.0 else max(low - room, 0.0), high + room, bins + 1)


def draw_histogram(
    axes: "Axes", values: Doubles, edges: Doubles, total: int, law: Doubles | None = None, *, band: bool = False
) -> Doubles:
    """Draw and return the density of values among ``total``, and draw the exact one of bins of probability ``law``.

    ``band``: whether the values are independent, so that two standard errors of a bin's count are known.
    """
    width = np.diff(edges)
    density = np.asarray(np.histogram(values, edges)[0] / (total * width), dtype=np.float64)
    axes.stairs(density, edges, fill=True, color=style.BLUE, alpha=0.45, lw=0.0, label="simulated")
    if law is None:
        return density
    exact = law / width
    axes.stairs(exact, edges, color=style.VERMILION, lw=1.4, label="exact")
    if band:
        error = 2.0 * np.sqrt(law * (1.0 - law) / total) / width
        look: dict[str, Any] = {"fill": True, "color": style.VERMILION, "alpha": 0.2, "lw": 0.0}
        low = np.maximum(exact - error, 0.0)
        axes.stairs(exact + error, edges, baseline=low, label="± 2 std errors of a bin", **look)
    return density


def mark_mean(axes: "Axes", values: Doubles, label: str) -> None:
    """Mark the mean of values in their histogram."""
    axes.axvline(float(values.mean()), color=style.INK, lw=0.8, ls=(0, (4, 3)), label=label)


PER_DECADE, MOST_DECADES = 8, 8
"""Bins for each factor of ten, and factors of ten at most."""


def draw_counts(axes: "Axes", values: Doubles, what: str, label: str, unit: str, mark: tuple[float, str]) -> None:
    """Draw how many values are in bins of equal ratio, and mark a place to compare with; zeros are in the legend."""
    shown = values[values > 0.0]
    nothing = values.size - shown.size
    axes.set(xlabel=f"{label} ({unit})", ylabel=f"number of {what}s")
    if not values.size:
        axes.set_ylim(0.0, 1.0)
        axes.text(0.5, 0.5, f"no {what}s", transform=axes.transAxes, ha="center")
    if shown.size:
        edges = ratio_bins(shown)
        name = f"{values.size:,} {what}{'s' * (values.size != 1)}" + (f", {nothing:,} of them 0" if nothing else "")
        axes.hist(np.maximum(shown, edges[0]), bins=edges.tolist(), color=style.BLUE, alpha=0.55, lw=0.0, label=name)
        median = float(np.median(values))
        axes.axvline(median, color=style.INK, lw=1.2, label=f"median {median:.3g} {unit}")
        place, words = mark
        axes.axvline(place, color=style.VERMILION, lw=1.2, ls=(0, (5, 3)), label=words)
        style.logarithmic(axes.xaxis)
        axes.set_xlim(min(edges[0], 0.8 * place), max(edges[-1], 1.25 * place))
    axes.locator_params(axis="y", integer=True)


def ratio_bins(values: Doubles) -> Doubles:
    """Return the edges of bins of equal ratio, which include a power of ten and the largest of some values > 0."""
    highest = np.ceil(PER_DECADE * np.log10(values.max()) + 1e-9)
    lowest = max(np.floor(PER_DECADE * np.log10(values.min())), highest - PER_DECADE * MOST_DECADES)
    return 10.0 ** (np.arange(lowest, highest + 1.0) / PER_DECADE)


# The phase plane.

BOXES: Final = (180, 140)
SHADES: Final = ("#dcebf5", "#0072b2", "#04213a")
"""From rarely to often; a grey printer keeps them in order."""


def draw_density(axes: "Axes", x: Doubles, y: Doubles) -> None:
    """Draw the share of the time in each small box of a plane, in logarithmic shades."""
    from matplotlib.colors import LinearSegmentedColormap

    shades = LinearSegmentedColormap.from_list("often", SHADES)
    *_, drawn = axes.hist2d(
        x, y, bins=BOXES, weights=np.full(x.size, 1.0 / x.size), cmin=0.5 / x.size, cmap=shades, norm="log"
    )
    drawn.set_rasterized(True)
    bar = axes.figure.colorbar(drawn, ax=axes, pad=0.02, label="share of the time in a box")
    style.logarithmic(bar.ax.yaxis)


# Lives.

MOST_MARKED: Final = 250
"""Lives whose births and deaths are marked: with more, the marks would hide one another."""

LAYER_SHADES: Final = ("#e3eef5", "#a9cce3", "#c6dcea", "#8dbbd9")
"""Pale blues of neighbouring layers."""


def draw_layers(axes: "Axes", place: Doubles, areas: Doubles, marked: int, colour: str) -> None:
    """Draw areas, a row for each junction, as layers with their sum on top; one of them has a colour."""
    base = np.zeros(place.size)
    for number, row in enumerate(areas):
        alive, shade = row > 0.0, colour if number == marked else LAYER_SHADES[number % len(LAYER_SHADES)]
        axes.fill_between(place[alive], base[alive], (base + row)[alive], color=shade, lw=0.0, rasterized=True)
        base = base + row
    axes.plot(place, areas.sum(axis=0), color=style.BLUE, lw=1.6, label="their sum, the simulated area")


def mark_ends(axes: "Axes", lives: Neighbours, births: Doubles, deaths: Doubles) -> None:
    """Mark births by rings and deaths by crosses at heights, if there is room for them."""
    if lives.rows.size <= MOST_MARKED:
        look: dict[str, Any] = {"color": style.INK, "ls": "", "ms": 3.4 if lives.rows.size <= 100 else 2.4, "mew": 0.8}
        axes.plot(lives.birth, births, "o", mfc="white", label="birth", **look)
        axes.plot(lives.death, deaths, "x", label="death", **look)


def draw_lanes(axes: "Axes", lives: Neighbours, middle: float) -> None:
    """Draw lives as bars in lanes; those alive at a distance are blue."""
    lane = lanes(lives.birth, lives.death).astype(np.float64)
    highest = max(float(lane.max(initial=0.0)) + 2.0, 3.0)
    axes.set_ylim(-1.0, highest)
    crossed = (lives.birth <= middle) & (middle < lives.death)
    room = 0.55 * 72.0 * axes.figure.figure.get_figheight() / (highest + 1.0)  # points from lane to lane, about
    for rows, colour, label in (
        (~crossed, style.FAINT, "other lives"),
        (crossed, style.BLUE, f"{crossed.sum()} alive at the line"),
    ):
        axes.hlines(lane[rows], lives.birth[rows], lives.death[rows], color=colour, lw=0.7 * room, label=label)
    mark_ends(axes, lives, lane, lane)
    axes.set(yticks=[], ylabel="lives")


def lanes(birth: Doubles, death: Doubles) -> NDArray[np.int64]:
    """Return for each life the lowest lane that is free at its birth; births in order, um, death later than birth."""
    found = np.zeros(birth.size, dtype=np.int64)
    alive: list[tuple[float, int]] = []
    free: list[int] = []
    for row, (begin, end) in enumerate(zip(birth.tolist(), death.tolist(), strict=True)):
        while alive and alive[0][0] <= begin:
            heappush(free, heappop(alive)[1])
        found[row] = heappop(free) if free else len(alive)
        heappush(alive, (end, int(found[row])))
    return found
