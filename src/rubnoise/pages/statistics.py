"""The statistics of a run in its page: spectra, histograms and the phase plane, and the exact curves beside them."""

from collections.abc import Callable, Mapping
from functools import partial
from math import log2
from typing import Any, Final

import numpy as np

from rubnoise.analysis.spectra import hann, welch
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Rows, column_chunks
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.theory.motion import motion_spectrum
from rubnoise.theory.sampling import expected_periodogram, through_window
from rubnoise.web_page import packed

LIVES: Final = 8.0
PERIODS: Final = 16.0
"""Length of a segment in mean lives, for the area, and in periods of the slider, for its velocity."""

TICKS: Final = (6, 14)
"""Powers of two between which a segment has ticks."""

SPREADS: Final = 5.0
POINTS: Final = 200
"""How far the density of the area is drawn, in standard deviations, and at how many areas."""


def exact_curves(file: Rows, model: Model) -> dict[str, Any]:
    """Return for area, velocities and load the ticks of a segment and the expectation of its spectrum.

    Densities are two-sided, in um^4 per rad/um, um^2/s^2 per rad/s and uN^2 per rad/s; one that theory does not know is
    None, as is the density of the area in 1/um^2. A motion that the run does not have is None.
    """
    ticks, is_known = _power_of_two(LIVES * model.mean_life_distance / model.tick), model.free is None
    expected = _known(lambda: expected_periodogram(model, model.tick, hann(ticks))[1]) if is_known else None
    found: dict[str, Any] = {
        "area": {"step": model.tick, "ticks": ticks, "expected": expected},
        "density": _known(lambda: np.stack(_density(model))) if is_known else None,
        **dict.fromkeys(("velocity", "normal", "load")),
    }
    if "slider" in file.columns and file.rows("slider") > 1 and model.slider is not None:
        own = "velocity" if is_known and not model.is_two_way else None
        first, second = file.column("slider", "time", 0, 2).tolist()
        found["velocity"] = _of_motion(model, model.slider, second - first, own)
    if "load" in file.columns and model.held is not None and model.tick_duration is not None:
        for name, quantity in (("normal", "normal_velocity"), ("load", "load")):
            known = quantity if is_known else None
            found[name] = _of_motion(model, model.held.oscillator, model.tick_duration, known)
    return found


def _of_motion(model: Model, slider: Slider, step: float, quantity: str | None) -> dict[str, Any]:
    """Return the step in s, the ticks of a segment, and the expected spectrum of a quantity, None if unknown."""
    ticks = _power_of_two(PERIODS / slider.natural_frequency / step) if slider.stiffness else 1 << 10
    expected = None
    if quantity is not None:
        exact = partial(motion_spectrum, quantity, model)
        expected = _known(lambda: through_window(exact, step, hann(ticks), ticks // 2))
    return {"step": step, "ticks": ticks, "expected": expected}


def _density(model: Model) -> tuple[Doubles, Doubles]:
    exact = area_cumulants(model)
    highest = exact.mean + SPREADS * exact.std
    area = np.linspace(max(exact.mean - SPREADS * exact.std, highest / POINTS), highest, POINTS)
    return area, distribution(model).density(area)


def _power_of_two(ticks: float) -> int:
    lowest, highest = TICKS
    return 1 << int(np.clip(round(log2(max(ticks, 1.0))), lowest, highest))


def _known(curve: Callable[[], Doubles]) -> dict[str, str] | None:
    try:
        return packed(curve().ravel())
    except Refused:
        return None


QUANTITIES: Final = {
    "area": ("trace", "real_contact_area"),
    "velocity": ("slider", "velocity"),
    "normal": ("load", "velocity"),
    "load": ("load", "load"),
}
"""Group and column of each quantity of `exact_curves`."""

BARS: Final = 60
CELLS: Final = (96, 72)
"""Bars of a histogram; cells of the phase plane across and up."""


def whole_run(file: Rows, curves: Mapping[str, Any], *, leaves: bool) -> dict[str, Any]:
    """Return the statistics of each quantity that has a curve, and of the phase plane, read in chunks.

    ``leaves`` says that the slider leaves the contact: zeros of area and load are then counted, and not drawn.
    """
    found = {
        name: _statistics(file, name, curves[name]["ticks"], curves[name]["step"], leaves=leaves and name != "normal")
        for name in QUANTITIES
        if curves[name] is not None
    }
    return {**found, "phase": _phase(file) if "slider" in file.columns else None}


def _statistics(file: Rows, name: str, ticks: int, step: float, *, leaves: bool) -> dict[str, Any]:
    """Return two-sided spectrum and histogram of a column: ``ends`` and ``counts`` of its bars, and all ``rows``."""
    group, column = QUANTITIES[name]
    spectrum = welch(column_chunks(file, group, column), ticks, step)
    ends, counts = _ends(file, group, column), np.zeros(BARS, dtype=np.uint32)
    for values in column_chunks(file, group, column):
        counts += np.histogram(values[values > 0.0] if leaves else values, BARS, ends)[0].astype(np.uint32)
    return {
        "density": packed(spectrum.density),
        "segments": spectrum.segments,
        "ends": ends,
        "counts": packed(counts),
        "rows": file.rows(group),
    }


def _ends(file: Rows, group: str, column: str) -> tuple[float, float]:
    """Return the lowest and the highest value of a column, which are never equal."""
    ends = np.array([(values.min(), values.max()) for values in column_chunks(file, group, column)])
    low, high = float(ends[:, 0].min()), float(ends[:, 1].max())
    return (low, high) if low < high else (low - 0.5, low + 0.5)


def _phase(file: Rows) -> dict[str, Any]:
    """Return how many ticks are in each cell of displacement (across) and velocity (up), row by row from below."""
    place, velocity = (_ends(file, "slider", name) for name in ("displacement", "velocity"))
    counts = np.zeros(CELLS)
    for x, v in zip(
        column_chunks(file, "slider", "displacement"), column_chunks(file, "slider", "velocity"), strict=True
    ):
        counts += np.histogram2d(x, v, CELLS, (place, velocity))[0]
    return {"across": CELLS[0], "place": place, "velocity": velocity, "counts": packed(counts.T.astype(np.uint32))}
