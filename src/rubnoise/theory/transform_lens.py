"""The Fourier transform of the lens pulse of unit diameter, and what is left of it when its swing is averaged out.

Far out it needs Bessel functions of order 1: Hankel's series, right to rounding. scipy.special has them too, and takes
longer to be imported than a short run takes to run.
"""

from fractions import Fraction
from functools import cache
from math import factorial, prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Complexes, Doubles

_TERMS = 18
# a_n(1) = prod over j of (4 - (2j - 1)^2) / (n! 8^n), DLMF 10.17.1.
_SERIES = tuple(prod(4 - (2 * j - 1) ** 2 for j in range(1, n + 1)) / (factorial(n) * 8**n) for n in range(_TERMS))


def hankel_modulus(z: Doubles) -> Doubles:
    """Return J_1(z)^2 + Y_1(z)^2 for z >= 32 of any shape, which does not swing."""
    p, q = _hankel_series(z)
    return 2.0 / (np.pi * z) * (p * p + q * q)


def hankel_without_swing(z: Doubles) -> Complexes:
    """Return exp(i z) (Y_1(z) + i J_1(z)) for z >= 32 of any shape, which does not swing either."""
    p, q = _hankel_series(z)
    return np.sqrt(1.0 / (np.pi * z)) * (1j * (q - p) - (p + q))


def y1(z: Doubles) -> Doubles:
    """Return Y_1(z) for z >= 32 of any shape.

    sqrt(2 / (pi z)) (P sin(z - 3 pi/4) + Q cos(z - 3 pi/4)), relative to its modulus right to 1e-15. Source: DLMF
    10.17.4.
    """
    p, q = _hankel_series(z)
    sine, cosine = np.sin(z), np.cos(z)
    return np.sqrt(1.0 / (np.pi * z)) * (q * (sine - cosine) - p * (sine + cosine))


def _hankel_series(z: Doubles) -> tuple[Doubles, Doubles]:
    """Return P = sum of (-1)^n a_2n / z^2n and Q = sum of (-1)^n a_2n+1 / z^(2n+1)."""
    inverse = 1.0 / z
    square = -inverse * inverse
    p, q = np.zeros_like(inverse), np.zeros_like(inverse)
    for even, odd in zip(reversed(_SERIES[0::2]), reversed(_SERIES[1::2]), strict=True):
        p = p * square + even
        q = q * square + odd
    return p, q * inverse


_SERIES_FROM = 32.0
_SEGMENTS = ((0.0, 10.0), (10.0, 20.0), (20.0, _SERIES_FROM))
_DEGREE = 28
# H_1 - Y_1 = (2/pi) (1 + 1/z^2 - 3/z^4 + 45/z^6 - ...), DLMF 11.6.1: the factor from one term to the next.
_STRUVE_RATIOS = tuple(-(2.0 * n - 1.0) * (2.0 * n - 3.0) for n in range(1, 13))


@cache
def _chebyshev(segment: int) -> Doubles:
    """Interpolate pi H_1(z) / z^2 on a segment; scipy's struve takes 10 us a value and loses digits near z = 25."""
    low, high = _SEGMENTS[segment]
    nodes = np.polynomial.chebyshev.chebpts1(_DEGREE + 1)
    phases = 0.5 * (high + low) + 0.5 * (high - low) * nodes
    return chebyshev_series(np.array([_power_series(z) for z in phases.tolist()]))


def chebyshev_series(values: NDArray[Any]) -> NDArray[Any]:
    """Return the coefficients of the series through values at as many Chebyshev nodes."""
    nodes = np.polynomial.chebyshev.chebpts1(values.size)
    coefficients = (2.0 / nodes.size) * (values @ np.polynomial.chebyshev.chebvander(nodes, nodes.size - 1))
    coefficients[0] *= 0.5
    return coefficients


_BITS = 160  # more than a double has: at z = 32 terms of 1e12 leave a sum of 1e-3
_ONE = 1 << _BITS


def _power_series(z: float) -> float:
    """Return pi H_1(z) / z^2 = 2/3 (1 - z^2/(3 5) + z^4/(3 5 5 7) - ...) for z < 32, DLMF 11.2.1, rounded once."""
    square = int(Fraction(z) ** 2 * _ONE)
    total, term, n = 0, _ONE, 3
    while term:
        total += term if n % 4 == 3 else -term
        term, n = term * square // (n * (n + 2) * _ONE), n + 2
    return 2 * total / (3 * _ONE)


def _struve_tail(phase: Doubles) -> Doubles:
    """Return H_1(z) - Y_1(z) for z >= 32."""
    inverse = 1.0 / (phase * phase)
    total = np.ones_like(phase)
    for ratio in reversed(_STRUVE_RATIOS):
        total = 1.0 + ratio * inverse * total
    return (2.0 / np.pi) * total


def amplitude(phase: ArrayLike) -> Doubles:
    """Return a^(z) = pi H_1(z) / z^2, the transform of the lens pulse of unit diameter about its middle; a^(0) = 2/3.

    z = k d >= 0, of any shape. Relative error below 1e-13 for z <= 1e6.
    Source: int_0^1 sqrt(1 - x^2) sin(z x) dx, DLMF 11.5.1.
    """
    z = np.asarray(phase, dtype=np.float64)
    result = np.empty_like(z)
    far = z >= _SERIES_FROM
    beyond = z[far]
    result[far] = np.pi * (y1(beyond) + _struve_tail(beyond)) / (beyond * beyond)
    for segment, (low, high) in enumerate(_SEGMENTS):
        inside = (z >= low) & (z < high)
        x = (z[inside] - 0.5 * (high + low)) / (0.5 * (high - low))
        result[inside] = np.polynomial.chebyshev.chebval(x, _chebyshev(segment))
    return result


def level(phase: Doubles) -> Doubles:
    """Return what is left of a^(z) when its swing is averaged out, pi (H_1 - Y_1) / z^2, for z >= 32 of any shape."""
    return np.pi * _struve_tail(phase) / (phase * phase)


def swing(phase: Doubles) -> Doubles:
    """Return the mean square of the swing of a^(z) about its level, (pi / z^2)^2 (J_1^2 + Y_1^2) / 2, for z >= 32."""
    return 0.5 * hankel_modulus(phase) * np.square(np.pi / (phase * phase))


def birth_level(phase: Doubles) -> Complexes:
    """Return what is left of exp(i z) a^(z) without its swing, (pi / z^2) exp(i z) (Y_1 + i J_1) / 2, for z >= 32.

    It is the transform of what begins at birth, where A grows as s^1.5: the half of Y_1 that turns with exp(-i z).
    """
    return 0.5 * np.pi / (phase * phase) * hankel_without_swing(phase)
