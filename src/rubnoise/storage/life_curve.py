"""The life of any junction of a run as a table that any tool can interpolate."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import PULSES, Shape

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
