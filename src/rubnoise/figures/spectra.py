"""The pane of a spectrum: Welch's estimate, the exact density, and the estimate over its expectation."""

from collections.abc import Sequence
from functools import partial
from math import pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.selection import first_row
from rubnoise.analysis.spectra import Spectrum, WelchSum, hann, shared_variance
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.panes import looks_of
from rubnoise.figures.style import BLUE, FAINT, INK, NEAREST, VERMILION, logarithmic
from rubnoise.figures.tracks import Track
from rubnoise.theory.sampling import expected_periodogram, through_window
from rubnoise.theory.second_order import area_noise

if TYPE_CHECKING:
    from matplotlib.axes import Axes


FIRST: Final = 2
"""The first bin that is drawn: the mean that is subtracted from each segment changes those before."""

FEWEST_ROWS: Final = 16
OF_CONTACT, OF_MOTION = (30, 40.0), (12, 400.0)
"""Segments at least, and how long one is at most: mean lives of a contact, natural periods of a motion."""

STICKS: Final = 40.0
"""Mean times from stick to stick that a segment may hold, if that is longer."""

FARTHEST: Final = 40.0
"""Natural frequencies up to which the spectrum of a motion is shown."""

POINTS, MOST_LINES = 1500, 30
ROUNDING: Final = 1e-12
"""Expected density over the largest below which a ratio would be one of rounding errors."""

NATURAL: Final = {"slider": "natural frequency", "load": "contact resonance"}
ONE_WAY: Final = "exact, one-way"
Seen = tuple[Track, Spectrum]


def spectrum_of(track: Track) -> Spectrum:
    """Return Welch's two-sided estimate over rad/um or rad/s, in the square of the axis's unit.

    Raises Refused for too few rows, and if nothing but rounding varies.
    """
    segments, longest = OF_CONTACT if track.swings is None else OF_MOTION
    length = longest / track.natural
    if track.group == "slider" and track.model.is_two_way:
        first, last = (first_row(track.stretch.file, "landmarks", "time", time) for time in (track.begin, track.end))
        length = max(length, STICKS * 2.0 * (track.end - track.begin) / max(last - first, 1))
    rows = 2 * (min(2 * (track.last - track.first) // (segments + 1), int(length / track.step)) // 2)
    if rows < FEWEST_ROWS:
        needed = FEWEST_ROWS * (segments + 1) / 2 * track.step
        if not track.timed:
            tick = f"with a tick every {track.step:g} um"
            raise Refused(f"a spectrum needs a stretch of {needed:.3g} um or more, {tick}")
        raise Refused(f"a spectrum needs {needed:.3g} s of a {track.quantity.words} that varies")
    total, values = WelchSum(rows, track.step), 0.0
    for chunk in track.chunks():
        total.add(chunk)
        values += float(chunk.sum())
    seen, still = total.spectrum(), NEAREST * abs(values) / (track.last - track.first)
    if track.quantity.column == "velocity":  # whose mean is 0; beside the drive's speed it may be small, but not that
        still = NEAREST**2 * track.quantity.scale * (track.model.sliding_speed or 0.0)
    if seen.density.sum() * seen.wavenumber[1] / pi <= still**2:
        raise Refused(f"the {track.quantity.words} does not vary in this stretch, so it has no spectrum")
    return seen


def draw_spectra(axes: "Axes", found: Sequence[Seen], ratio: "Axes | None" = None) -> None:
    """Draw two-sided densities of a contact over rad/um, or one-sided ones of a motion over Hz, and the exact one.

    In ``ratio`` the first estimate that theory knows is drawn over its expectation.
    """
    tracks, (first, seen) = [track for track, _ in found], found[0]
    turn, sides = _turn_and_sides(first)
    lowest = min(float(each.wavenumber[FIRST]) for _, each in found) / turn
    highest = max(float(each.wavenumber[-1]) for _, each in found) / turn
    if first.swings is not None:
        highest = min(highest, max(FARTHEST * first.natural, 10.0 * lowest))
        axes.axvline(first.natural, color=FAINT, lw=0.8, ls=(0, (1, 2)), zorder=0, label=NATURAL[first.group])
    looks = looks_of(tracks)
    if len(looks) == 1:
        looks[0]["label"] = f"simulated ({seen.segments} segments)"
    for (_, each), look in zip(found, looks, strict=True):
        place, density = each.wavenumber[FIRST:] / turn, sides * each.density[FIRST:]
        axes.plot(place[place <= highest], density[place <= highest], **look)
    if first.swings is None:  # zeros of the theory lie far below what has a logarithm
        top = sides * float(seen.density.max())
        axes.set_ylim(0.1 * sides * float(seen.density.min(where=seen.density > 0.0, initial=top)), 10.0 * top)
    _draw_exact(axes, next((track for track in tracks if track.has_theory), first), lowest, highest)
    if ratio is not None:
        number = next(number for number, track in enumerate(tracks) if is_expected(track))
        _draw_expected(axes, ratio, found[number], highest * turn, looks[number]["label"] if number else "simulated")
    logarithmic(axes.xaxis, axes.yaxis)
    axes.set_xlim(lowest, highest)
    (axes if ratio is None else ratio).set_xlabel("frequency (Hz)" if first.timed else "wavenumber (rad/µm)")
    axes.set_ylabel(_density_label(first))


def _turn_and_sides(track: Track) -> tuple[float, float]:
    """Return wavenumbers to a unit of the axis, and densities to one of the estimate: in time one-sided, over Hz."""
    return (2.0 * pi, 2.0) if track.timed else (1.0, 1.0)


def _density_label(track: Track) -> str:
    unit = track.quantity.unit
    if not track.timed:
        return "two-sided spectral density\n(µm⁴ per rad/µm)"
    squared = f"({unit})²" if "/" in unit else f"{unit}²"
    return f"spectral density\nof {track.quantity.words} ({squared}/Hz)"


def is_expected(track: Track) -> bool:
    """Whether theory knows what a spectrum should be: not of two-way or free motion, and not of lines alone."""
    try:
        known = not track.timed or track.quantity.density(track.model, np.array([2.0 * pi * track.natural])).any()
    except Refused:
        return False
    return track.has_theory and bool(known)


def _draw_expected(axes: "Axes", ratio: "Axes", found: Seen, highest: float, label: str) -> None:
    """Draw the band of an estimate about its expectation, and in other axes the estimate over its expectation."""
    (track, seen), (turn, sides), window = found, _turn_and_sides(found[0]), hann(found[1].ticks)
    last = int(np.searchsorted(seen.wavenumber, highest * (1.0 + 1e-9), side="right"))
    if track.timed:
        expected = through_window(partial(track.quantity.density, track.model), track.step, window, last - 1)
    else:
        expected = expected_periodogram(track.model, track.step, window)[1]
    place, level = seen.wavenumber[FIRST:last] / turn, sides * expected[FIRST:last]
    error = sqrt(float(shared_variance(seen.ticks, seen.segments, 0)[0]) / seen.segments)
    if not track.timed:
        axes.plot(place, level, color=INK, lw=1.0, ls=(0, (4, 2)), label="expected of the estimate")
    low, high = level * max(1.0 - 2.0 * error, 0.0), level * (1.0 + 2.0 * error)
    axes.fill_between(place, low, high, color=VERMILION, alpha=0.2, lw=0.0, zorder=1, label="± 2 std errors")
    known = level > ROUNDING * float(level.max())
    draw_ratio(ratio, place[known], sides * seen.density[FIRST:last][known] / level[known], error, label)


def _draw_exact(axes: "Axes", track: Track, lowest: float, highest: float) -> None:
    """Draw the exact density, of a two-way slider that of one-way coupling, and what else there is to compare with."""
    (turn, sides), quantity, model = _turn_and_sides(track), track.quantity, track.model
    place = np.geomspace(lowest, highest, POINTS)
    if track.swings is not None:
        place = np.sort(np.append(place, np.linspace(0.8, 1.2, POINTS) * track.natural))
        place = place[(lowest <= place) & (place <= highest)]
    try:
        density = sides * quantity.density(model, turn * place) if track.stretch.has_theory else np.zeros(1)
        white = quantity.white(model, turn * place) if track.swings and track.stretch.has_theory else None
    except Refused:
        return
    if density.any():
        words: dict[str, Any] = {"label": "exact"} if track.has_theory else {"ls": (0, (4, 2)), "label": ONE_WAY}
        look: dict[str, Any] = {"lw": 1.0} if track.timed else {"lw": 2.4, "zorder": 1.9}
        axes.plot(place, density, color=VERMILION, **words, **look)
    for number, line in enumerate(() if track.timed else area_noise(model).lines[0][:MOST_LINES]):
        label = "_one entry is enough" if number else "exact lines"
        axes.axvline(line, color=VERMILION, lw=0.8, ls=(0, (1, 2)), zorder=0, label=label)
    if white is not None and white.any():
        axes.plot(place, sides * white, color=INK, lw=0.8, ls=(0, (1, 1.5)), label="white noise (Kilburn)")


BINS_PER_DECADE: Final = 24.0
"""Bins of a ratio over a logarithmic axis: so few that the band of each can be seen."""

NEIGHBOURS: Final = {1: 4.0 / 9.0, 2: 1.0 / 36.0}
"""Correlation of neighbouring bins under a Hann window, by their distance: the squares of 2/3 and 1/6."""


def draw_ratio(axes: "Axes", place: Doubles, ratio: Doubles, error: float, whose: str) -> None:
    """Draw an estimate over what it is expected to be, in bins of a logarithmic axis.

    ``whose`` is the label of the estimate. ``error`` is the standard error of one value; the band about 1 is two
    standard errors of the mean of a bin's values.
    """
    bins = np.floor(BINS_PER_DECADE * np.log10(place / place[0])).astype(np.int64)
    _, first, count = np.unique(bins, return_index=True, return_counts=True)
    middle, mean = np.exp(np.add.reduceat(np.log(place), first) / count), np.add.reduceat(ratio, first) / count
    near = sum(2.0 * share * np.maximum(1.0 - lag / count, 0.0) for lag, share in NEIGHBOURS.items())
    band = 2.0 * error * np.sqrt((1.0 + near) / count)
    look: dict[str, Any] = {"color": VERMILION, "alpha": 0.2, "lw": 0.0, "label": "± 2 std errors of a bin"}
    axes.fill_between(middle, 1.0 - band, 1.0 + band, **look)
    axes.axhline(1.0, color=VERMILION, lw=1.0)
    axes.plot(middle, mean, "o-", color=BLUE, lw=0.7, ms=2.2, label=f"{whose} over expected")
    axes.set(ylim=(0.0, 2.0 + 2.0 * error), ylabel="ratio")
