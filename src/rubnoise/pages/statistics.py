"""The statistics of a run in its page: spectra, histograms and the phase plane, and the exact curves beside them."""

from collections.abc import Callable, Mapping
from functools import partial
from math import inf
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import hann, welch
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.reader import Rows, column_chunks
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.theory.motion import motion_spectrum
from rubnoise.theory.sampling import expected_periodogram, through_window
from rubnoise.web_page import packed

LIVES: Final = 8.0
"""Length of a segment in mean lives, for the area."""

_PERIODS: Final = 16.0  # length of a segment in periods of what swings, for its velocity
_TICKS: Final = (6, 14)  # powers of two between which a segment has ticks
_SPREADS, _POINTS = 5.0, 200  # how far the density of the area is drawn, in standard deviations, and at how many areas
_BARS: Final = 60  # of a histogram

CELLS: Final = (96, 72)
"""Cells of the phase plane across and up."""

QUANTITIES: Final = {
    "area": ("trace", "real_contact_area", "real_contact_area"),
    "velocity": ("slider", "velocity", "velocity"),
    "normal": ("load", "velocity", "normal_velocity"),
    "load": ("load", "load", "load"),
}
"""Group, column, and name in theory of each quantity that has statistics."""


def exact_curves(file: Rows, model: Model) -> dict[str, Any]:
    """Return for area, velocities and load the ticks of a segment and the expectation of its spectrum.

    Densities are two-sided, in um^4 per rad/um, um^2/s^2 per rad/s and uN^2 per rad/s; one that theory does not know is
    None, as is the density of the area in 1/um^2. A motion that the run does not have is None.
    """
    curves = {name: _curve(file, model, *QUANTITIES[name]) for name in QUANTITIES}
    return {"density": None if model.free is not None else _known(lambda: _density(model)), **curves}


def _curve(file: Rows, model: Model, group: str, _: str, quantity: str) -> dict[str, Any] | None:
    """Return the step in um or s, the ticks of a segment, and the expected spectrum, None if unknown."""
    held = None if model.held is None else model.held.oscillator
    step, length, swings = model.tick, LIVES * model.mean_life_distance, held if group == "load" else model.slider
    if group != "trace":
        if group not in file.columns or swings is None or model.tick_duration is None or file.rows(group) < 2:
            return None
        step, length = model.tick_duration, _PERIODS / swings.natural_frequency if swings.stiffness else inf
    ticks = 1 << int(np.clip(np.rint(np.log2(max(length / step, 1.0))), *_TICKS))
    expected = None
    if model.free is None and group == "trace":
        expected = _known(lambda: expected_periodogram(model, step, hann(ticks))[1])
    elif model.free is None and not (group == "slider" and model.is_two_way):
        exact = partial(motion_spectrum, quantity, model)
        expected = _known(lambda: through_window(exact, step, hann(ticks), ticks // 2))
    return {"step": step, "ticks": ticks, "expected": expected}


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


def whole_run(file: Rows, curves: Mapping[str, Any], *, leaves: bool) -> dict[str, Any]:
    """Return the statistics of each quantity that has a curve: two-sided spectrum, ``ends`` and ``counts`` of bars.

    ``leaves`` says that the slider leaves the contact: zeros of area and load are then among ``rows``, and not drawn.
    The phase plane has its ticks in each cell of displacement (across) and velocity (up), row by row from below.
    """
    found: dict[str, Any] = {"phase": _phase(file) if "slider" in file.columns else None}
    for name, (group, column, _) in QUANTITIES.items():
        if (curve := curves[name]) is not None:
            spectrum = welch(column_chunks(file, group, column), curve["ticks"], curve["step"])
            values = file.column(group, column)
            shown, ends = values[values > 0.0] if leaves and name != "normal" else values, _ends(values)
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
