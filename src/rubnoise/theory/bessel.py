"""Bessel functions of order 1 far out, where the lens's transform needs them: Hankel's series, right to rounding.

scipy.special has them too, and takes longer to be imported than a short run takes to run.
"""

from math import factorial, prod

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]
Complexes = NDArray[np.complex128]

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
