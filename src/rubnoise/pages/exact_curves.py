"""The exact curves beside the statistics of a window in a page: expected spectra, and the density of the area."""

from collections.abc import Callable
from functools import partial
from math import log2
from typing import Any, Final

import numpy as np

from rubnoise.analysis.spectra import hann
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Rows
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
    found: dict[str, Any] = {
        "area": {
            "step": model.tick,
            "ticks": ticks,
            "expected": _known(lambda: expected_periodogram(model, model.tick, hann(ticks))[1]) if is_known else None,
        },
        "density": _known(lambda: np.stack(_density(model))) if is_known else None,
        "velocity": None,
        "normal": None,
        "load": None,
    }
    if "slider" in file.columns and file.rows("slider") > 1 and model.slider is not None:
        step = float(file.column("slider", "time", 1, 2)[0] - file.column("slider", "time", 0, 1)[0])
        own = partial(motion_spectrum, "velocity", model) if is_known and not model.is_two_way else None
        found["velocity"] = _of_motion(model.slider, step, own)
    if "load" in file.columns and model.held is not None and model.tick_duration is not None:
        contact, step = model.held.oscillator, model.tick_duration
        normal = partial(motion_spectrum, "normal_velocity", model) if is_known else None
        found["normal"] = _of_motion(contact, step, normal)
        found["load"] = _of_motion(contact, step, partial(motion_spectrum, "load", model) if is_known else None)
    return found


def _of_motion(slider: Slider, step: float, exact: Callable[[Doubles], Doubles] | None) -> dict[str, Any]:
    """Return the step in s, the ticks of a segment, and the expected spectrum of a motion, None if unknown."""
    ticks = _power_of_two(PERIODS / slider.natural_frequency / step) if slider.stiffness else 1 << 10
    expected = None if exact is None else _known(lambda: through_window(exact, step, hann(ticks), ticks // 2))
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
