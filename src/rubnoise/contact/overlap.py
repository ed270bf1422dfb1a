"""The overlap of two circles sliding over each other: the area of one junction through its life."""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray


def junction_area(distance_since_birth: ArrayLike, diameter: ArrayLike) -> NDArray[np.float64]:
    """Return the area of a junction at a sliding distance after its birth.

    A(s; d) = d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2), x = |d - s|, for 0 <= s <= 2d, and 0 outside (um^2; s, d in um; the
    arguments broadcast). Paper Eq. (2) with segments of height s/2; Eq. (3) as printed adds a length^2 to a length^3
    under its root and cannot be used.
    """
    d = np.asarray(diameter, dtype=np.float64)
    x = np.minimum(np.abs(d - np.asarray(distance_since_birth, dtype=np.float64)), d)
    return 0.5 * (d * d * np.arccos(x / d) - x * np.sqrt((d - x) * (d + x)))


def max_area(diameter: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return A_jmax = pi d^2 / 4, the area at full overlap, in um^2 (paper Eq. 4)."""
    return 0.25 * np.pi * diameter * diameter


@cache
def life_integral(power: int) -> float:
    """Return c_n, where the integral of A^n over a life is c_n d^(2n+1).

    c_1 = 2/3 and c_2 = pi/3 - 32/45; any n >= 1 by quadrature at 30 digits of
    c_n = 2 int_0^(pi/2) ((theta - sin theta cos theta)/2)^n sin theta d theta  (s = d (1 - cos theta)).
    """
    import mpmath

    with mpmath.workdps(30):
        half = mpmath.quad(
            lambda t: ((t - mpmath.sin(t) * mpmath.cos(t)) / 2) ** power * mpmath.sin(t), [0, mpmath.pi / 2]
        )
        return float(2 * half)
