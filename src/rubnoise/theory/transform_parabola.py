"""The Fourier transform of the parabolic pulse of unit diameter, and what is left of it without its swing."""

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles

_SERIES_BELOW = 1.0
# (sin z - z cos z) / z^3 = sum over n of (-1)^n (2n + 2) z^2n / (2n + 3)!, by the factor from one term to the next.
_RATIOS = tuple(-(2.0 * n + 2.0) / (2.0 * n * (2.0 * n + 2.0) * (2.0 * n + 3.0)) for n in range(1, 10))


def amplitude(phase: ArrayLike) -> Doubles:
    """Return a^(z) = pi (sin z - z cos z) / z^3, the transform of the parabola about its middle; a^(0) = pi/3.

    z = k d >= 0, of any shape. Source: pi j_1(z) / z with the spherical Bessel function of DLMF 10.49.3.
    """
    z = np.asarray(phase, dtype=np.float64)
    far = np.maximum(z, _SERIES_BELOW)
    closed = (np.sin(far) - far * np.cos(far)) / far**3
    square, series = np.square(np.minimum(z, _SERIES_BELOW)), np.ones_like(z)
    for ratio in reversed(_RATIOS):
        series = 1.0 + ratio * square * series
    return np.asarray(np.pi * np.where(z < _SERIES_BELOW, series / 3.0, closed), dtype=np.float64)


def level(phase: Doubles) -> Doubles:
    """Return 0: without a kink at mid-life nothing of a^(z) is left when its swing is averaged out."""
    return np.zeros_like(phase)


def swing(phase: Doubles) -> Doubles:
    """Return the mean square of the swing of a^(z), (pi^2 / 2) (1 / z^4 + 1 / z^6), for z > 0."""
    inverse = 1.0 / np.square(phase)
    return 0.5 * np.pi**2 * np.square(inverse) * (1.0 + inverse)


def birth_level(phase: Doubles) -> Complexes:
    """Return what is left of exp(i z) a^(z) without its swing, (pi/2) (-1 / z^2 + i / z^3): birth alone, for z > 0."""
    return np.asarray(0.5 * np.pi * (1j / phase - 1.0) / np.square(phase), dtype=np.complex128)
