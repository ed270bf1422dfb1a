"""The Fourier transform of one junction's life, for every pulse shape: itself, its square, their means over a swing."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.pulses import Pulse, Shape
from rubnoise.theory import off_centre, transform_lens, transform_parabola, transform_triangle
from rubnoise.theory.quadrature import complementary_error

_STEP_FROM = 32.0
# The step from the transform itself to its mean over a swing: an error function of width 8.5 about phase 90. It holds
# no component of phase frequency 1 above exp(-8.5^2 / 2) = 2e-16, so cutting the swing off along it loses nothing.
_STEP_CENTRE = 90.0
_STEP_WIDTH = 8.5
STEP_END = 160.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PulseTransform:
    """The transform a^(z) of a pulse of unit diameter about its middle, z = k d >= 0; A^(k) = d^3 a^(k d) in um^3.

    Far out a^(z) is a level, which falls as 1/z^2, and a swing about it; about the birth, exp(i z) a^(z), only what
    begins at birth does not swing. ``level``, ``swing`` (its mean square) and ``birth_level`` are asked for z >= 32
    alone. Everything takes z of any shape.
    """

    amplitude: Callable[[ArrayLike], Doubles]
    level: Callable[[Doubles], Doubles]
    swing: Callable[[Doubles], Doubles]
    birth_level: Callable[[Doubles], Complexes]

    def square(self, phase: ArrayLike) -> Doubles:
        """Return a^(z)^2, the energy spectrum of the pulse of unit diameter."""
        return np.square(self.amplitude(phase))

    def from_birth(self, phase: ArrayLike) -> Complexes:
        """Return exp(i z) a^(z), the transform about the birth, where junctions of all sizes begin."""
        z = np.asarray(phase, dtype=np.float64)
        return np.asarray(np.exp(1j * z) * self.amplitude(z), dtype=np.complex128)

    def mean_from_birth(self, phase: ArrayLike) -> Complexes:
        """Return exp(i z) a^(z) with its swing averaged out for large z, as averages over sizes need it.

        It is the transform below z = 32, what begins at birth above 160, and a smooth blend between. Its integral
        against anything smooth on the scale z = 10 is that of exp(i z) a^(z) to 1e-15.
        """
        z, amplitude, upper, kept = self._blended(phase)
        result = np.asarray(np.exp(1j * np.minimum(z, STEP_END)) * amplitude, dtype=np.complex128)
        result[upper] = kept * result[upper] + (1.0 - kept) * self.birth_level(z[upper])
        return result

    def mean_square(self, phase: ArrayLike) -> Doubles:
        """Return a^(z)^2 with its swing averaged out for large z, as integrals over z need it; as `mean_from_birth`."""
        z, result, upper, kept = self._blended(phase)
        beyond = z[upper]
        settled = np.square(self.level(beyond)) + self.swing(beyond)
        result = np.square(result)
        result[upper] = kept * result[upper] + (1.0 - kept) * settled
        return result

    def _blended(self, phase: ArrayLike) -> tuple[Doubles, Doubles, NDArray[np.bool_], Doubles]:
        """Return z, a^(min(z, 160)), where z is beyond the beginning of the step, and what it leaves of a^ there."""
        z = np.asarray(phase, dtype=np.float64)
        upper = z > _STEP_FROM
        return z, self.amplitude(np.minimum(z, STEP_END)), upper, swing_left(z[upper])


class Energy(Protocol):
    """The energy spectrum of a pulse of unit diameter, itself and without its swing, for z of any shape."""

    def square(self, phase: ArrayLike) -> Doubles:
        """Return the mean of |a^(z)|^2."""
        ...

    def mean_square(self, phase: ArrayLike) -> Doubles:
        """Return it with its swing averaged out for large z, as `PulseTransform.mean_square`."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class OffCentreEnergy:
    """The energy spectrum of passes off the centre line, averaged over offsets, and what it is without its swing."""

    square: Callable[[ArrayLike], Doubles]
    level: Callable[[Doubles], Doubles]

    def mean_square(self, phase: ArrayLike) -> Doubles:
        """Return it with its swing averaged out for large z, as `PulseTransform.mean_square`."""
        z = np.asarray(phase, dtype=np.float64)
        result = self.square(np.minimum(z, STEP_END))
        upper = z > _STEP_FROM
        kept = swing_left(z[upper])
        result[upper] = kept * result[upper] + (1.0 - kept) * self.level(z[upper])
        return result


def energy_of(pulse: Pulse) -> Energy:
    """Return the energy spectrum of a pulse."""
    return transform_of(pulse) if pulse.offset == "none" else _OFF_CENTRE[pulse.shape]


_TRANSFORMS: dict[Shape, PulseTransform] = {
    "lens": PulseTransform(
        amplitude=transform_lens.amplitude,
        level=transform_lens.level,
        swing=transform_lens.swing,
        birth_level=transform_lens.birth_level,
    ),
    "triangle": PulseTransform(
        amplitude=transform_triangle.amplitude,
        level=transform_triangle.level,
        swing=transform_triangle.swing,
        birth_level=transform_triangle.birth_level,
    ),
    "parabola": PulseTransform(
        amplitude=transform_parabola.amplitude,
        level=transform_parabola.level,
        swing=transform_parabola.swing,
        birth_level=transform_parabola.birth_level,
    ),
}

_OFF_CENTRE: dict[Shape, Energy] = {
    "lens": OffCentreEnergy(square=off_centre.mean_square, level=off_centre.level),
    "parabola": OffCentreEnergy(
        square=transform_parabola.off_centre_mean_square, level=transform_parabola.off_centre_level
    ),
}


def transform_of(pulse: Pulse) -> PulseTransform:
    """Return the transform of a pulse shape."""
    return _TRANSFORMS[pulse.shape]


def life_from_birth(phase: ArrayLike) -> Complexes:
    """Return (exp(2iz) - 1)/(iz), the transform about the birth of a count of 1 over the life of unit diameter."""
    z = np.asarray(phase, dtype=np.float64)
    return np.exp(1j * z) * 2.0 * np.sinc(z / np.pi)


def mean_life_from_birth(phase: ArrayLike) -> Complexes:
    """Return `life_from_birth` with the swing of the end of the life averaged out for large z, leaving i/z."""
    z = np.asarray(phase, dtype=np.float64)
    result = life_from_birth(np.minimum(z, STEP_END))
    upper = z > _STEP_FROM
    beyond = z[upper]
    result[upper] = (swing_left(beyond) * np.exp(2j * beyond) - 1.0) / (1j * beyond)
    return result


def swing_left(phase: Doubles) -> Doubles:
    """Return what the step leaves of the swing at phases: 1 below 20, 0 above 160, and smooth between."""
    left = (phase < STEP_END).astype(np.float64)
    blended = (phase > 2.0 * _STEP_CENTRE - STEP_END) & (phase < STEP_END)
    left[blended] = 0.5 * complementary_error((phase[blended] - _STEP_CENTRE) / (np.sqrt(2.0) * _STEP_WIDTH))
    return left
