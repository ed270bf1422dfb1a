"""The pane of a spectrum: Welch's estimate, the exact density, and the estimate over its expectation."""

from collections.abc import Sequence
from functools import partial
from math import pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.landmarks import first_landmark
from rubnoise.analysis.spectra import Spectrum, WelchSum, hann, shared_variance
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.panes import curve_styles
from rubnoise.figures.style import FAINT, INK, NEAREST, VERMILION, draw_band, draw_ratio, legend_above, logarithmic
from rubnoise.figures.tracks import Track, labels_of
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
Seen = tuple[Track, Spectrum]


def spectrum_of(track: Track) -> Spectrum:
    """Return Welch's two-sided estimate over rad/um or rad/s, in the square of the axis's unit.

    Raises Refused for too few rows, and if nothing but rounding varies.
    """
    segments, longest = OF_CONTACT if track.swings is None else OF_MOTION
    length = longest / track.natural
    if track.group == "slider" and track.model.is_two_way:
        file = track.stretch.file
        sticks = first_landmark(file, track.end) - first_landmark(file, track.begin)
        length = max(length, STICKS * 2.0 * (track.end - track.begin) / max(sticks, 1))
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
    if seen.power <= still**2:
        raise Refused(f"the {track.quantity.words} does not vary in this stretch, so it has no spectrum")
    return seen


def draw_spectra(axes: "Axes", found: Sequence[Seen], ratio: "Axes | None" = None) -> None:
    """Draw two-sided densities of a contact over rad/um, or one-sided ones of a motion over Hz, and the exact one.

    In ``ratio`` the first estimate that theory knows is drawn over its expectation.
    """
    tracks, (first, _) = [track for track, _ in found], found[0]
    turn, sides = (2.0 * pi, 2.0) if first.timed else (1.0, 1.0)
    lowest = min(float(seen.wavenumber[FIRST]) for _, seen in found) / turn
    highest = max(float(seen.wavenumber[-1]) for _, seen in found) / turn
    if first.swings is not None:
        highest = min(highest, max(FARTHEST * first.natural, 10.0 * lowest))
        name = NATURAL[first.group]
        axes.axvline(first.natural, color=FAINT, lw=0.8, ls=(0, (1, 2)), zorder=0, label=name)
    labels = labels_of(tracks) if len(found) > 1 else [f"simulated ({found[0][1].segments} segments)"]
    for (_, seen), label, look in zip(found, labels, curve_styles(len(found)), strict=True):
        place, density = seen.wavenumber[FIRST:] / turn, sides * seen.density[FIRST:]
        axes.plot(place[place <= highest], density[place <= highest], label=label, **look)
    if first.swings is None:  # zeros of the theory lie far below what has a logarithm
        density = found[0][1].density
        top = sides * float(density.max())
        axes.set_ylim(0.1 * sides * float(density.min(where=density > 0.0, initial=top)), 10.0 * top)
    _draw_exact(axes, next((track for track in tracks if track.has_theory), first), lowest, highest)
    if ratio is not None:
        number = next(number for number, track in enumerate(tracks) if is_expected(track))
        _draw_expected(axes, ratio, found[number], highest * turn, labels[number] if number else "simulated")
    logarithmic(axes.xaxis, axes.yaxis)
    axes.set_xlim(lowest, highest)
    (axes if ratio is None else ratio).set_xlabel("frequency (Hz)" if first.timed else "wavenumber (rad/µm)")
    axes.set_ylabel(_density_label(first))
    legend_above(axes)


def _density_label(track: Track) -> str:
    unit = track.quantity.unit
    if not track.timed:
        return "two-sided spectral density\n(µm⁴ per rad/µm)"
    squared = f"({unit})²" if "/" in unit else f"{unit}²"
    return f"spectral density\nof {track.quantity.words} ({squared}/Hz)"


def is_expected(track: Track) -> bool:
    """Whether theory knows what a spectrum should be: not of two-way or free motion, and not of lines alone."""
    if not track.has_theory or track.quantity.density is None:
        return False
    try:
        return not track.timed or bool(track.quantity.density(track.model, np.array([2.0 * pi * track.natural])).any())
    except Refused:
        return False


def expected_of(track: Track, seen: Spectrum, highest: float) -> Doubles:
    """Return what the estimate is expected to be at its bins up to ``highest``, of a track whose spectrum is known."""
    last, window = int(np.searchsorted(seen.wavenumber, highest * (1.0 + 1e-9), side="right")) - 1, hann(seen.ticks)
    if not track.timed or track.quantity.density is None:
        return expected_periodogram(track.model, track.step, window)[1][: last + 1]
    density = partial(track.quantity.density, track.model)
    return track.quantity.scale**2 * through_window(density, track.step, window, last)


def _draw_expected(axes: "Axes", ratio: "Axes", found: Seen, highest: float, label: str) -> None:
    """Draw the band of an estimate about its expectation, and in other axes the estimate over its expectation."""
    track, seen = found
    expected = expected_of(track, seen, highest)
    turn, sides = (2.0 * pi, 2.0) if track.timed else (1.0, 1.0)
    place, level = seen.wavenumber[FIRST : expected.size] / turn, sides * expected[FIRST:]
    error = sqrt(float(shared_variance(seen.ticks, seen.segments, 0)[0]) / seen.segments)
    if not track.timed:
        axes.plot(place, level, color=INK, lw=1.0, ls=(0, (4, 2)), label="expected of the estimate")
    draw_band(axes, place, level, error)
    known = level > ROUNDING * float(level.max())
    draw_ratio(ratio, place[known], sides * seen.density[FIRST : expected.size][known] / level[known], error, label)


def _draw_exact(axes: "Axes", track: Track, lowest: float, highest: float) -> None:
    """Draw the exact density, of a two-way slider that of one-way coupling, and what else there is to compare with."""
    quantity, model = track.quantity, track.model
    if quantity.density is None or not track.stretch.has_theory:
        return
    place = np.geomspace(lowest, highest, POINTS)
    if track.swings is not None:
        place = np.sort(np.append(place, np.linspace(0.8, 1.2, POINTS) * track.natural))
        place = place[(lowest <= place) & (place <= highest)]
    turn, sides = (2.0 * pi, 2.0 * quantity.scale**2) if track.timed else (1.0, 1.0)
    try:
        density = sides * quantity.density(model, turn * place)
    except Refused:
        return
    if density.any():
        look: dict[str, Any] = (
            {"label": "exact"} if track.has_theory else {"ls": (0, (4, 2)), "label": "exact, one-way"}
        )
        lines: dict[str, Any] = {"lw": 1.0} if track.timed else {"lw": 2.4, "zorder": 1.9}
        axes.plot(place, density, color=VERMILION, **lines, **look)
    if not track.timed:
        for number, line in enumerate(area_noise(model).lines[0][:MOST_LINES]):
            label = "_one entry is enough" if number else "exact lines"
            axes.axvline(line, color=VERMILION, lw=0.8, ls=(0, (1, 2)), zorder=0, label=label)
    elif quantity.white and track.swings and model.separation is None and track.swings.excitation != "base":
        white = sides * quantity.white(model, turn * place)
        if white.any():
            axes.plot(place, white, color=INK, lw=0.8, ls=(0, (1, 1.5)), label="white noise (Kilburn)")
