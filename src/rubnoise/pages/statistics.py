"""The statistics of a run in its page: spectra, histograms and the phase plane, and the exact curves beside them."""

from collections.abc import Callable
from math import inf
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.tracks import Stretch, Track
from rubnoise.model import Model
from rubnoise.record.reader import Rows, column_chunks
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.web_page import packed

LIVES: Final = 8.0  # length of a segment in mean lives, for the area

_PERIODS: Final = 16.0  # length of a segment in periods of what swings, for its velocity
_TICKS: Final = (6, 14)  # powers of two between which a segment has ticks
_SPREADS, _POINTS = 5.0, 200  # how far the density of the area is drawn, in standard deviations, and at how many areas
_BARS: Final = 60  # of a histogram

CELLS: Final = (96, 72)  # cells of the phase plane across and up

QUANTITIES: Final = {"area": "area", "velocity": "velocity", "normal": "normal-velocity", "load": "load"}
"""What has statistics, by its name in a page, as it is called in pictures."""


def statistics(stretch: Stretch) -> dict[str, Any]:
    """Return what a page says of area, velocities and load over a whole run, beside what theory expects.

    Of each, None if the run does not have it: the step in um or s; the ticks of a segment, their number, and the
    two-sided density in um^4 per rad/um, um^2/s^2 per rad/s or uN^2 per rad/s with its expectation, None if theory has
    none; ``ends`` and ``counts`` of bars. Zeros of area and load of a slider that leaves the contact are among
    ``rows``, and not drawn. Beside them is the exact density of the area in 1/um^2. The phase plane has its ticks in
    each cell of displacement (across) and velocity (up), row by row from below.
    """
    whole, model = stretch.whole(), stretch.model
    return {
        "density": _known(lambda: _density(model)) if stretch.has_theory else None,
        "phase": _phase(stretch.file) if "slider" in stretch.file.columns else None,
        **{name: _of_quantity(whole, drawn) for name, drawn in QUANTITIES.items()},
    }


def _of_quantity(whole: Stretch, name: str) -> dict[str, Any] | None:
    try:
        track = Track.of(whole, name)
    except Refused:
        return None
    per_unit, column = track.quantity.scale**-2, (track.group, track.quantity.column)
    length = (LIVES if track.swings is None else _PERIODS) / track.natural if track.natural else inf
    ticks = 1 << int(np.clip(np.rint(np.log2(max(length / track.step, 1.0))), *_TICKS))
    spectrum, values = welch(column_chunks(whole.file, *column), ticks, track.step), whole.file.column(*column)
    shown, ends = values if whole.has_theory or name == "normal-velocity" else values[values > 0.0], _ends(values)
    return {
        "step": track.step,
        "ticks": ticks,
        "expected": _known(lambda: per_unit * track.expected(ticks, ticks // 2)) if track.has_theory else None,
        "density": packed(spectrum.density),
        "segments": spectrum.segments,
        "ends": ends,
        "counts": packed(np.histogram(shown, _BARS, ends)[0].astype(np.uint32)),
        "rows": values.size,
    }


def _density(model: Model) -> Doubles:
    exact = area_cumulants(model)
    highest = exact.mean + _SPREADS * exact.std
    area = np.linspace(max(exact.mean - _SPREADS * exact.std, highest / _POINTS), highest, _POINTS)
    return np.stack([area, distribution(model).density(area)])


def _known(curve: Callable[[], Doubles]) -> dict[str, str] | None:
    try:
        return packed(curve().ravel())
    except Refused:
        return None


def _ends(values: NDArray[Any]) -> tuple[float, float]:
    """Return the lowest and the highest value, which are never equal."""
    low, high = float(values.min()), float(values.max())
    return (low, high) if low < high else (low - 0.5, low + 0.5)


def _phase(file: Rows) -> dict[str, Any]:
    x, v = (file.column("slider", name) for name in ("displacement", "velocity"))
    place, velocity = _ends(x), _ends(v)
    counts = np.histogram2d(x, v, CELLS, (place, velocity))[0]
    return {"across": CELLS[0], "place": place, "velocity": velocity, "counts": packed(counts.T.astype(np.uint32))}
