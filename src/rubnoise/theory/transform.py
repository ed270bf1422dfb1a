"""The Fourier transform of one junction's life, for every pulse shape: itself, its square, their means over a swing."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc

from rubnoise.contact.pulses import Pulse, Shape
from rubnoise.theory import transform_lens, transform_triangle

Doubles = NDArray[np.float64]

_STEP_FROM = 32.0
# The step from the transform itself to its mean over a swing: an error function of width 8.5 about phase 90. It holds
# no component of phase frequency 1 above exp(-8.5^2 / 2) = 2e-16, so cutting the swing off along it loses nothing.
_STEP_CENTRE = 90.0
_STEP_WIDTH = 8.5
STEP_END = 160.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PulseTransform:
    """The transform a^(z) of a pulse of unit diameter about its middle, z = k d >= 0; A^(k) = d^3 a^(k d) in um^3.

    Far out a^(z) is a level, which falls as 1/z^2, and a swing about it; ``level`` and ``swing`` (its mean square) are
    asked for z >= 32 alone. Everything takes z of any shape.
    """

    amplitude: Callable[[ArrayLike], Doubles]
    level: Callable[[Doubles], Doubles]
    swing: Callable[[Doubles], Doubles]

    def square(self, phase: ArrayLike) -> Doubles:
        """Return a^(z)^2, the energy spectrum of the pulse of unit diameter."""
        return np.square(self.amplitude(phase))

    def mean_amplitude(self, phase: ArrayLike) -> Doubles:
        """Return a^(z) with its swing averaged out for large z: a^(z) below 32, the level above 160, blended between.

        Its integral against anything smooth on the scale z = 10 is that of a^(z) to 1e-15.
        """
        z, result, upper, kept = self._blended(phase)
        result[upper] = kept * result[upper] + (1.0 - kept) * self.level(z[upper])
        return result

    def mean_square(self, phase: ArrayLike) -> Doubles:
        """Return a^(z)^2 with its swing averaged out for large z, as integrals over z need it; as `mean_amplitude`."""
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
        kept = 0.5 * erfc((z[upper] - _STEP_CENTRE) / (np.sqrt(2.0) * _STEP_WIDTH))
        return z, self.amplitude(np.minimum(z, STEP_END)), upper, kept


_TRANSFORMS: dict[Shape, PulseTransform] = {
    "lens": PulseTransform(amplitude=transform_lens.amplitude, level=transform_lens.level, swing=transform_lens.swing),
    "triangle": PulseTransform(
        amplitude=transform_triangle.amplitude, level=transform_triangle.level, swing=transform_triangle.swing
    ),
}


def transform_of(pulse: Pulse) -> PulseTransform:
    """Return the transform of a pulse shape."""
    return _TRANSFORMS[pulse.shape]
