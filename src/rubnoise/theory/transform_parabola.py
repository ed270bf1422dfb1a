"""The Fourier transform of the parabolic pulse of unit diameter, and what is left of it without its swing.

A pass at a lateral offset b is the parabola of the diameter D = sqrt(1 - b^2), with the energy D^6 a^(z D)^2.
"""

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.theory.quadrature import panels

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


_FAR = 32.0
_NODES = 80  # of offsets; the swing turns by twice the phase over them, 64 at most


def settled_square(phase: Doubles) -> Doubles:
    """Return a^(z)^2, and from z = 32 on what is left of it without its swing."""
    far = np.maximum(phase, _FAR)
    return np.where(phase < _FAR, np.square(amplitude(np.minimum(phase, _FAR))), swing(far))


def off_centre_mean_square(phase: ArrayLike) -> Doubles:
    """Return E_b |a^(z; b)|^2 = (pi^2 / z^6) E[(sin(z D) - z D cos(z D))^2] for offsets uniform on (-1, 1).

    With C(w) = E[cos(w D)] = 1 - (pi/2) H_1(w) of Struve, w = 2z, the mean is (1 - C)/2 + z C' + z^2 (2/3 - C'')/2.
    Below z = 32, where these cancel, it is a sum over offsets. Source: DLMF 11.5.4.
    """
    from scipy.special import struve

    z = np.asarray(phase, dtype=np.float64)
    angle, weights = panels([0.0, 0.5 * np.pi], _NODES)
    result, near = np.empty_like(z), z < _FAR
    chord = np.cos(angle)
    result[near] = np.square(amplitude(np.multiply.outer(z[near], chord))) @ (weights * chord**7)
    beyond = z[~near]
    w = 2.0 * beyond
    first, second = 0.5 * np.pi * struve(1, w), 0.5 * np.pi * struve(0, w)
    slope = first / w - second
    bend = first + second / w - 2.0 * first / w**2 - 1.0
    result[~near] = np.pi**2 / beyond**6 * (0.5 * first + beyond * slope + np.square(beyond) * (2.0 / 3.0 - bend) / 2.0)
    return result


def off_centre_level(phase: Doubles) -> Doubles:
    """Return what is left of `off_centre_mean_square` without its swing, about (pi^2 / 3) / z^4, for z >= 32."""
    inverse = 1.0 / np.square(phase)
    series = 1.0 / 3.0 + inverse * (0.5 + inverse * (0.5625 - 0.9375 * inverse))
    return np.asarray(np.pi**2 * np.square(inverse) * series, dtype=np.float64)
