"""The area of a live junction of unit diameter: how long a pulse stays about each area."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import Pulse, Shape

Doubles = NDArray[np.float64]
UnitDensity = Callable[[Doubles], Doubles]

_PEAK = 0.25 * np.pi
_DEGREE = 28


def unit_density(pulse: Pulse) -> UnitDensity:
    """Return the density du/da of the area a in (0, pi/4] of a live junction of unit diameter.

    u in [0, 1] is the half-life so far, as likely at every place; the falling half is the mirror image.
    """
    return _DENSITIES[pulse.shape]


def _lens(area: Doubles) -> Doubles:
    """Return 1/sqrt(u (2 - u)), the area of a lens growing by sqrt(1 - (1 - u)^2) du."""
    scaled = np.minimum(area / _PEAK, 1.0) ** (2.0 / 3.0)
    u = scaled * np.polynomial.chebyshev.chebval(2.0 * scaled - 1.0, _lens_ages())
    return np.asarray(1.0 / np.sqrt(u * (2.0 - u)), dtype=np.float64)


def _triangle(area: Doubles) -> Doubles:
    """Return 4/pi, the rise being straight."""
    return np.full_like(area, 1.0 / _PEAK)


_DENSITIES: dict[Shape, UnitDensity] = {"lens": _lens, "triangle": _triangle}


@cache
def _lens_ages() -> Doubles:
    """Interpolate u/w over w = (4 a/pi)^(2/3) in [0, 1], where a lens of unit diameter has area a at the half-life u.

    With u = 1 - cos(y), a = (y - sin(y) cos(y))/2; analytic up to w = 2^(2/3), where y = pi.
    """
    import mpmath

    nodes = np.polynomial.chebyshev.chebpts1(_DEGREE + 1)
    with mpmath.workdps(30):
        scaled = [(1 + mpmath.mpf(x)) / 2 for x in nodes.tolist()]
        values = np.array([float((1 - mpmath.cos(_lens_angle(w))) / w) for w in scaled])
    return np.polynomial.chebyshev.chebfit(nodes, values, _DEGREE)


def _lens_angle(scaled: Any) -> Any:
    """Return y in [0, pi/2] with y - sin(y) cos(y) = (pi/2) w^(3/2), an mpmath number."""
    import mpmath

    double_area = mpmath.pi / 2 * scaled**1.5
    return mpmath.findroot(
        lambda y: y - mpmath.sin(y) * mpmath.cos(y) - double_area, mpmath.pi / 2 * mpmath.sqrt(scaled)
    )
