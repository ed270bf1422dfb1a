"""The statistics of a run in its page: spectra, histograms and the phase plane, and the exact curves beside them."""

from collections.abc import Callable, Mapping
from math import inf
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.tracks import QUANTITIES as DRAWN
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


def exact_curves(stretch: Stretch) -> dict[str, Any]:
    """Return for area, velocities and load of a run the ticks of a segment and the expectation of its spectrum.

    Densities are two-sided, in um^4 per rad/um, um^2/s^2 per rad/s and uN^2 per rad/s; one that theory does not know is
    None, as is the density of the area in 1/um^2. A motion that the run does not have is None.
    """
    curves = {name: _curve(stretch.whole(), drawn) for name, drawn in QUANTITIES.items()}
    return {"density": _known(lambda: _density(stretch.model)) if stretch.has_theory else None, **curves}


def _curve(whole: Stretch, name: str) -> dict[str, Any] | None:
    """Return the step in um or s, the ticks of a segment, and the expected spectrum, None if unknown."""
    try:
        track = Track.of(whole, name)
    except Refused:
        return None
    length = (LIVES if track.swings is None else _PERIODS) / track.natural if track.natural else inf
    ticks = 1 << int(np.clip(np.rint(np.log2(max(length / track.step, 1.0))), *_TICKS))
    per_unit = track.quantity.scale**-2
    expected = _known(lambda: per_unit * track.expected(ticks, ticks // 2)) if track.has_theory else None
    return {"step": track.step, "ticks": ticks, "expected": expected}


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


def whole_run(stretch: Stretch, curves: Mapping[str, Any]) -> dict[str, Any]:
    """Return the statistics of each quantity that has a curve: two-sided spectrum, ``ends`` and ``counts`` of bars.

    Zeros of area and load of a slider that leaves the contact are among ``rows``, and not drawn. The phase plane has
    its ticks in each cell of displacement (across) and velocity (up), row by row from below.
    """
    file = stretch.file
    found: dict[str, Any] = {"phase": _phase(file) if "slider" in file.columns else None}
    for name, about in ((name, DRAWN[each]) for name, each in QUANTITIES.items() if curves[name] is not None):
        spectrum = welch(column_chunks(file, about.group, about.column), curves[name]["ticks"], curves[name]["step"])
        values = file.column(about.group, about.column)
        shown, ends = values if stretch.has_theory or name == "normal" else values[values > 0.0], _ends(values)
        found[name] = {
            "density": packed(spectrum.density),
            "segments": spectrum.segments,
            "ends": ends,
            "counts": packed(np.histogram(shown, _BARS, ends)[0].astype(np.uint32)),
            "rows": values.size,
        }
    return found


def _ends(values: NDArray[Any]) -> tuple[float, float]:
    """Return the lowest and the highest value, which are never equal."""
    low, high = float(values.min()), float(values.max())
    return (low, high) if low < high else (low - 0.5, low + 0.5)


def _phase(file: Rows) -> dict[str, Any]:
    x, v = (file.column("slider", name) for name in ("displacement", "velocity"))
    place, velocity = _ends(x), _ends(v)
    counts = np.histogram2d(x, v, CELLS, (place, velocity))[0]
    return {"across": CELLS[0], "place": place, "velocity": velocity, "counts": packed(counts.T.astype(np.uint32))}
