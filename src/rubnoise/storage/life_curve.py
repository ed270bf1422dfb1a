"""The life of any junction of a run as a table that any tool can interpolate, by the pulse that its file names."""

import json
from collections.abc import Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import LENS, PULSES, Pulse, Shape
from rubnoise.errors import RunFileRefused


def pulse_of(scenario: Mapping[str, object]) -> Pulse:
    """Return the pulse of a resolved scenario; one that names none is of the lens.

    Raises RunFileRefused for a shape that is not known.
    """
    section = scenario.get("pulse", {})
    shape = section.get("shape", LENS.shape) if isinstance(section, Mapping) else section
    if not isinstance(shape, str) or shape not in PULSES:
        raise RunFileRefused(f"the scenario in the file has the pulse shape {str(shape)[:40]!r}, which is not known")
    return PULSES[shape]


def stored_pulse(scenario_resolved: object) -> Pulse:
    """Return the pulse of a resolved scenario as /provenance has it; raises RunFileRefused where it is none."""
    try:
        scenario = json.loads(str(scenario_resolved))
    except (ValueError, RecursionError) as problem:
        raise RunFileRefused("the scenario in the file cannot be read") from problem
    if not isinstance(scenario, Mapping):
        raise RunFileRefused("the scenario in the file cannot be read")
    return pulse_of(scenario)


HALF_POINTS = 512
CURVE_ROWS = 2 * HALF_POINTS + 1


@cache
def life_curve(shape: Shape) -> dict[str, NDArray[np.float64]]:
    """Return ``u`` and ``area_fraction`` so that A(s) = d^2 interp(u), u = (s - birth)/d in [0, 2], within 1e-6 d^2.

    The pulse's own area over d^2 at u = (i/n)^2 and its mirror image: the squares put the points where the lens is a
    power 3/2 and leave a linear interpolation at most 0.15/n^2 off.
    """
    import mpmath

    squares = [(i * i) / (HALF_POINTS * HALF_POINTS) for i in range(HALF_POINTS + 1)]
    with mpmath.workdps(40):
        rising = [float(PULSES[shape].rising_area(mpmath.mpf(u))) for u in squares]
    mirrored = [2.0 - u for u in reversed(squares[:-1])]
    return {
        "u": np.array(squares + mirrored),
        "area_fraction": np.array(rising + rising[-2::-1]),
    }
