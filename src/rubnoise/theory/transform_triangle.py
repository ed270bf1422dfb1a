"""The Fourier transform of the triangular pulse of unit diameter, and what is left of it without its swing."""

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles


def amplitude(phase: ArrayLike) -> Doubles:
    """Return a^(z) = (pi/4) (sin(z/2) / (z/2))^2, the transform of the triangle about its middle; a^(0) = pi/4.

    z = k d >= 0, of any shape. Source: a triangle of base 2 is a square of base 1 convolved with itself.
    """
    z = np.asarray(phase, dtype=np.float64)
    return 0.25 * np.pi * np.square(np.sinc(z / (2.0 * np.pi)))


def level(phase: Doubles) -> Doubles:
    """Return what is left of a^(z) = (pi/2) (1 - cos z) / z^2 when its swing is averaged out, for z > 0."""
    return 0.5 * np.pi / (phase * phase)


def swing(phase: Doubles) -> Doubles:
    """Return the mean square of the swing of a^(z) about its level, half the level's square, for z > 0."""
    return 0.5 * np.square(level(phase))


def birth_level(phase: Doubles) -> Complexes:
    """Return what is left of exp(i z) a^(z) without its swing, -(pi/4) / z^2: the bend at birth alone, for z > 0."""
    return (-0.25 * np.pi / (phase * phase)).astype(np.complex128)
