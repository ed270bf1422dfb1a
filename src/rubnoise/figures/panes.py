"""The kinds of panes that pictures are put together from: curves, histograms, lives and spectra.

Blue is simulated and vermilion exact; two runs are a broad pale curve and a thin dark one.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import pi, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.junctions import Neighbours, first_row
from rubnoise.analysis.motion import Flights
from rubnoise.analysis.spectra import shared_variance, welch
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures import Axes, style
from rubnoise.figures.style import BLUE, FAINT, INK, NEAREST, VERMILION
from rubnoise.figures.tracks import Track
from rubnoise.theory.sampling import EstimatedSpectrum
from rubnoise.theory.second_order import area_noise


def looks_of(tracks: Sequence[Track]) -> list[dict[str, Any]]:
    """Return labels and styles of the curves of one run, or of two, the first broad and pale.

    Labels distinguish runs by their coupling, or else by the names of their files.
    """
    if len(tracks) == 1:
        return [{"color": BLUE, "lw": 0.9, "label": "simulated"}]
    labels = [f"{track.swings.coupling} coupling" for track in tracks if track.swings is not None]
    if len(set(labels)) < len(tracks):
        labels = [track.stretch.name for track in tracks]
    broad, thin = {"color": "#6fb3df", "lw": 1.8, "solid_joinstyle": "round"}, {"color": "#04213a", "lw": 0.8}
    return [{**look, "label": label} for look, label in zip((broad, thin), labels, strict=True)]


# Curves along the run.

MOST_SHADED: Final = 1500  # sticks or flights that are shaded: more would make the whole pane grey


def draw_along(axes: Axes, tracks: Sequence[Track], *, last: bool = True, **look: Any) -> None:
    """Draw a quantity of one run or two over place or time, about its exact mean and spread if theory knows them.

    Sticks of a two-way slider and flights of a free one are shaded; ``last``: whether the axis below has its label.
    """
    first = tracks[0]
    if len(tracks) == 1 and first.has_theory:
        style.exact_band(axes, *first.moments())
    for track, own in zip(tracks, looks_of(tracks), strict=True):
        axes.plot(*track.curve(), **(own | look))
    found = next((track for track in tracks if track.model.is_two_way), first).landmarks()
    if found is not None and 0 < found.begin.size <= MOST_SHADED:
        spans = list(zip(found.begin.tolist(), (found.end - found.begin).tolist(), strict=True))
        label = "off the surface" if isinstance(found, Flights) else "stick"
        shade: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "color": style.PALE, "lw": 0.0, "zorder": 0}
        axes.broken_barh(spans, (0.0, 1.0), label=label, **shade)
    low, high = axes.get_ylim()
    middle = 0.5 * (low + high)
    if first.group == "trace":
        low, high = 0.0, 1.05 * high
    elif high - low < NEAREST * abs(middle):  # what differs by rounding alone: no axis has the digits for less
        low, high = middle - 0.1 * abs(middle), middle + 0.1 * abs(middle)
    axes.set(xlim=first.ends, ylim=(low, high), ylabel=first.quantity.label)
    if last:
        axes.set_xlabel("time (s)" if first.timed else style.DISTANCE)
    else:
        axes.tick_params(labelbottom=False)


# Histograms.


def edges_of(values: Doubles, bins: int) -> Doubles:
    """Return edges of bins from the least value to the largest; values that differ by rounding alone are in one."""
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    largest = max(abs(low), abs(high))
    room = (1e-9 if high - low > NEAREST * largest else 0.1) * (largest or 1.0)
    return np.linspace(low - room if low <= 0.0 else max(low - room, 0.0), high + room, bins + 1)


def draw_histogram(axes: Axes, values: Doubles, edges: Doubles, total: int, law: Doubles | None) -> Doubles:
    """Draw and return the density of values among ``total``, and draw the exact one of bins of probability ``law``."""
    width = np.diff(edges)
    density = np.asarray(np.histogram(values, edges)[0] / (total * width), dtype=np.float64)
    axes.stairs(density, edges, fill=True, color=BLUE, alpha=0.45, lw=0.0, label="simulated")
    if law is not None:
        axes.stairs(law / width, edges, color=VERMILION, lw=1.4, label="exact")
    return density


def draw_density(axes: Axes, x: Doubles, y: Doubles) -> None:
    """Draw the share of the time in each small box of a plane, in logarithmic shades."""
    *_, drawn = axes.hist2d(x, y, bins=(180, 140), weights=np.full(x.size, 1.0 / x.size), cmap="Blues", norm="log")
    drawn.set_rasterized(True)
    bar = axes.figure.colorbar(drawn, ax=axes, pad=0.02, label="share of the time in a box")
    style.logarithmic(bar.ax.yaxis)


def draw_counts(axes: Axes, values: Doubles, what: str, label: str, unit: str, mark: tuple[float, str]) -> None:
    """Draw how many values are in bins of equal ratio, and mark their median and a place to compare with."""
    shown, (place, words) = values[values > 0.0], mark
    axes.set(xlabel=f"{label} ({unit})", ylabel=f"number of {what}s")
    if not shown.size:
        axes.text(0.5, 0.5, f"no {what}s", transform=axes.transAxes, ha="center")
        return
    name, median = f"{values.size:,} {what}{'s' * (values.size != 1)}", float(np.median(values))
    counts, edges = np.histogram(np.log10(shown), "auto")
    axes.stairs(counts, 10.0**edges, fill=True, color=BLUE, alpha=0.55, lw=0.0, label=name)
    axes.axvline(median, color=INK, lw=1.2, label=f"median {median:.3g} {unit}")
    axes.axvline(place, color=VERMILION, lw=1.2, ls=(0, (5, 3)), label=words)
    axes.locator_params(axis="y", integer=True)
    style.logarithmic(axes.xaxis)


# Lives.

MOST_MARKED: Final = 250  # lives whose births and deaths are marked: with more, the marks would hide one another

LAYER_SHADES: Final = ("#e3eef5", "#a9cce3", "#c6dcea", "#8dbbd9")
"""Pale blues of neighbouring layers."""


def draw_layers(
    axes: Axes, place: Doubles, areas: Doubles, marked: int, words: str = "their sum, the simulated area"
) -> None:
    """Draw areas, a row for each junction, as layers with their sum on top; one of them is black."""
    base = np.zeros(place.size)
    for number, row in enumerate(areas):
        alive, shade = row > 0.0, INK if number == marked else LAYER_SHADES[number % len(LAYER_SHADES)]
        axes.fill_between(place[alive], base[alive], (base + row)[alive], color=shade, lw=0.0, rasterized=True)
        base = base + row
    axes.plot(place, areas.sum(axis=0), color=BLUE, lw=1.6, label=words)
    axes.set_xlim(place[0], place[-1])
    axes.set_ylim(bottom=0.0)


def mark_ends(axes: Axes, lives: Neighbours, births: Doubles, deaths: Doubles) -> None:
    """Mark births by rings and deaths by crosses at heights, if there is room for them."""
    if lives.rows.size <= MOST_MARKED:
        look: dict[str, Any] = {"color": INK, "ls": "", "ms": 3.4 if lives.rows.size <= 100 else 2.4, "mew": 0.8}
        axes.plot(lives.birth, births, "o", mfc="white", label="birth", **look)
        axes.plot(lives.death, deaths, "x", label="death", **look)


def draw_lanes(axes: Axes, lives: Neighbours, middle: float) -> None:
    """Draw lives as bars in lanes; those alive at a distance are blue."""
    lane = lanes(lives.birth, lives.death).astype(np.float64)
    highest = max(float(lane.max(initial=0.0)) + 2.0, 3.0)
    axes.set(ylim=(-1.0, highest), yticks=[], ylabel="lives")
    crossed = (lives.birth <= middle) & (middle < lives.death)
    width = 0.4 * 72.0 * axes.figure.figure.get_figheight() / (highest + 1.0)  # of a line in points, with room beside
    looks = (~crossed, FAINT, "other lives"), (crossed, BLUE, f"{crossed.sum()} alive at the line")
    for rows, colour, label in looks:
        axes.hlines(lane[rows], lives.birth[rows], lives.death[rows], color=colour, lw=width, label=label)
    mark_ends(axes, lives, lane, lane)


def lanes(birth: Doubles, death: Doubles) -> NDArray[np.int64]:
    """Return for each life the lowest lane that is free at its birth; births in order, um, death later than birth."""
    found, free_from = np.zeros(birth.size, dtype=np.int64), np.full(birth.size, -np.inf)
    for row, begin in enumerate(birth.tolist()):
        found[row] = np.argmax(free_from <= begin)
        free_from[found[row]] = death[row]
    return found


# Spectra.

FIRST: Final = 2  # the first bin that is drawn: the mean that is subtracted from each segment changes those before

FEWEST_ROWS: Final = 16
OF_CONTACT, OF_MOTION = (30, 40.0), (12, 400.0)
"""Segments at least, and how long one is at most: mean lives of a contact, natural periods of a motion."""

STICKS: Final = 40.0  # mean times from stick to stick that a segment may hold, if that is longer
FARTHEST: Final = 40.0  # natural frequencies up to which the spectrum of a motion is shown

POINTS, MOST_LINES = 1500, 30
ROUNDING: Final = 1e-12
"""Expected density over the largest below which a ratio would be one of rounding errors."""

BINS_PER_DECADE: Final = 24.0  # bins of a ratio over a logarithmic axis: so few that the band of each can be seen

NEIGHBOURS: Final = {1: 4.0 / 9.0, 2: 1.0 / 36.0}
"""Correlation of neighbouring bins under a Hann window, by their distance: the squares of 2/3 and 1/6."""

NATURAL: Final = {"slider": "natural frequency", "load": "contact resonance"}
Seen = tuple[Track, EstimatedSpectrum]


def spectrum_of(track: Track) -> EstimatedSpectrum:
    """Return Welch's estimate as it is drawn: of a contact two-sided over rad/um, of what has times one-sided over Hz.

    Raises Refused for too few rows, and if nothing but rounding varies.
    """
    segments, longest = OF_CONTACT if track.swings is None else OF_MOTION
    length, (begin, end) = longest / track.natural, track.ends
    if track.group == "slider" and track.model.is_two_way:
        turns = [first_row(track.stretch.file, "landmarks", "time", time) for time in (begin, end)]
        length = max(length, STICKS * 2.0 * (end - begin) / max(turns[1] - turns[0], 1))
    rows = 2 * (min(2 * (track.last - track.first) // (segments + 1), int(length / track.step)) // 2)
    if rows < FEWEST_ROWS:
        needed, unit = FEWEST_ROWS * (segments + 1) / 2 * track.step, "s" if track.timed else "um"
        raise Refused(f"a spectrum needs {needed:.3g} {unit} or more, with a row every {track.step:.3g} {unit}")
    seen = welch(track.chunks(), rows, track.step)
    still = NEAREST * abs(float(track.record().mean()))
    if track.quantity.column == "velocity":  # whose mean is 0; beside the drive's speed it may be small, but not that
        still = NEAREST**2 * track.quantity.scale * (track.model.sliding_speed or 0.0)
    if seen.density.sum() * seen.wavenumber[1] / pi <= still**2:
        raise Refused(f"the {track.quantity.words} does not vary in this stretch, so it has no spectrum")
    highest = max(2.0 * pi * FARTHEST * track.natural, 10.0 * seen.wavenumber[FIRST]) * (1.0 + 1e-9)
    shown = slice(FIRST, int(np.sum(seen.wavenumber <= highest)) if track.swings is not None else None)
    turn, sides = _turn_and_sides(track)
    return replace(seen, wavenumber=seen.wavenumber[shown] / turn, density=sides * seen.density[shown])


def draw_spectra(axes: Axes, found: Sequence[Seen]) -> None:
    """Draw two-sided densities of a contact over rad/um, or one-sided ones of a motion over Hz, and the exact one."""
    tracks, (first, seen) = [track for track, _ in found], found[0]
    lowest = min(float(each.wavenumber[0]) for _, each in found)
    highest = max(float(each.wavenumber[-1]) for _, each in found)
    if first.swings is not None:
        axes.axvline(first.natural, color=FAINT, lw=0.8, ls=(0, (1, 2)), zorder=0, label=NATURAL[first.group])
    looks = looks_of(tracks)
    if len(looks) == 1:
        looks[0]["label"] = f"simulated ({seen.segments} segments)"
    for (_, each), look in zip(found, looks, strict=True):
        axes.plot(each.wavenumber, each.density, **look)
    if first.swings is None:  # zeros of the theory lie far below what has a logarithm
        top = float(seen.density.max())
        axes.set_ylim(0.1 * float(seen.density.min(where=seen.density > 0.0, initial=top)), 10.0 * top)
    _draw_exact(axes, next((track for track in tracks if track.has_theory), first), lowest, highest)
    style.logarithmic(axes.xaxis, axes.yaxis)
    axes.set(xlim=(lowest, highest), xlabel="frequency (Hz)" if first.timed else "wavenumber (rad/µm)")
    unit = f"({first.quantity.unit})²" if "/" in first.quantity.unit else f"{first.quantity.unit}²"
    of_motion = f"spectral density\nof {first.quantity.words} ({unit}/Hz)"
    axes.set_ylabel(of_motion if first.timed else "two-sided spectral density\n(µm⁴ per rad/µm)")


def _turn_and_sides(track: Track) -> tuple[float, float]:
    """Return wavenumbers to a unit of the axis, and densities to one of the estimate: in time one-sided, over Hz."""
    return (2.0 * pi, 2.0) if track.timed else (1.0, 1.0)


def _draw_exact(axes: Axes, track: Track, lowest: float, highest: float) -> None:
    """Draw the exact density, of a two-way slider that of one-way coupling, and what else there is to compare with."""
    if not track.stretch.has_theory:
        return
    (turn, sides), place = _turn_and_sides(track), np.geomspace(lowest, highest, POINTS)
    if track.swings is not None:
        place = np.sort(np.append(place, np.linspace(0.8, 1.2, POINTS) * track.natural))
        place = place[(lowest <= place) & (place <= highest)]
    try:
        density, white = track.density(turn * place), track.white(turn * place)
    except Refused:
        return
    if density.any():
        look: dict[str, Any] = {"lw": 1.0} if track.timed else {"lw": 2.4, "zorder": 1.9}
        look |= {"label": "exact"} if track.has_theory else {"ls": (0, (4, 2)), "label": "exact, one-way"}
        axes.plot(place, sides * density, color=VERMILION, **look)
    for number, line in enumerate(() if track.timed else area_noise(track.model).lines[0][:MOST_LINES]):
        label = "_one entry is enough" if number else "exact lines"
        axes.axvline(line, color=VERMILION, lw=0.8, ls=(0, (1, 2)), zorder=0, label=label)
    if white is not None and white.any():
        axes.plot(place, sides * white, color=INK, lw=0.8, ls=(0, (1, 1.5)), label="white noise (Kilburn)")


def expectation(track: Track, seen: EstimatedSpectrum) -> Doubles | None:
    """Return what theory expects of an estimate, bin by bin; None of two-way or free motion, and of lines alone."""
    if not track.has_theory:
        return None
    try:
        expected = track.expected(seen.ticks, FIRST + seen.density.size - 1)[FIRST:]
    except Refused:
        return None
    return _turn_and_sides(track)[1] * expected if expected.any() else None


def draw_expected(axes: Axes, ratio: Axes, found: Seen, expected: Doubles, whose: str) -> None:
    """Draw the expectation of an area's estimate, and below the estimate over it in bins, with two standard errors."""
    track, seen = found
    error = sqrt(float(shared_variance(seen.ticks, seen.segments, 0)[0]) / seen.segments)
    known = expected > ROUNDING * float(expected.max())
    place, level, values = seen.wavenumber[known], expected[known], seen.density[known] / expected[known]
    look: dict[str, Any] = {"color": VERMILION, "alpha": 0.2, "lw": 0.0}
    low, high = level * max(1.0 - 2.0 * error, 0.0), level * (1.0 + 2.0 * error)
    axes.fill_between(place, low, high, label="± 2 std errors", zorder=1, **look)
    if not track.timed:
        axes.plot(place, level, color=INK, lw=1.0, ls=(0, (4, 2)), label="expected of the estimate")
    bins = np.floor(BINS_PER_DECADE * np.log10(place / place[0])).astype(np.int64)
    _, first, count = np.unique(bins, return_index=True, return_counts=True)
    middle, mean = np.exp(np.add.reduceat(np.log(place), first) / count), np.add.reduceat(values, first) / count
    near = sum(2.0 * share * np.maximum(1.0 - lag / count, 0.0) for lag, share in NEIGHBOURS.items())
    band = 2.0 * error * np.sqrt((1.0 + near) / count)
    ratio.fill_between(middle, 1.0 - band, 1.0 + band, label="± 2 std errors of a bin", **look)
    ratio.axhline(1.0, color=VERMILION, lw=1.0)
    ratio.plot(middle, mean, "o-", color=BLUE, lw=0.7, ms=2.2, label=f"{whose} over expected")
    ratio.set(ylim=(0.0, 2.0 + 2.0 * error), ylabel="ratio", xlabel=axes.get_xlabel())
    axes.set_xlabel("")
