"""The free slider: how a displacement and a velocity die away, at every damping."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Slider

Doubles = NDArray[np.float64]

_SMALL = 1e-2


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeMotion:
    """m x'' + c x' + k x = 0 with a = c/(2m) and r^2 = a^2 - k/m: ``rate`` a and ``square_root`` r^2 in s^-1, s^-2."""

    rate: float
    square_root: float
    natural: float

    @property
    def fastest(self) -> float:
        """The modulus of the faster exponent in 1/s: the natural frequency when it rings, up to 2a when it creeps."""
        return self.natural if self.square_root <= 0.0 else self.rate + float(np.sqrt(self.square_root))

    @property
    def slowest(self) -> float:
        """The rate of the slower decay in 1/s, a or k/m / (a + r)."""
        return self.rate if self.square_root <= 0.0 else self.natural**2 / self.fastest

    def __call__(self, time: Doubles) -> tuple[Doubles, Doubles]:
        """Return exp(-a t) cosh(r t) and exp(-a t) sinh(r t)/r at times in s of either sign, by exponentials or series.

        x(t) = (even + a odd) x(0) + odd x'(0); the impulse response is odd / m.
        """
        root = np.emath.sqrt(self.square_root)
        slow, fast = np.exp(-(self.natural**2) / (self.rate + root) * time), np.exp(-(self.rate + root) * time)
        turned = self.square_root * np.square(time)
        few = np.abs(turned) < _SMALL**2
        series = time * np.exp(-self.rate * time) * (1.0 + turned / 6.0 * (1.0 + turned / 20.0))
        divided = 0.5 * (slow - fast) / (root or 1.0)
        return np.real(0.5 * (slow + fast)), np.where(few, series, np.real(divided))


def free_motion(slider: Slider) -> FreeMotion:
    """Return the free motion of a slider; its square root is taken as a product, which keeps its digits near 0."""
    rate, natural = slider.damping / (2.0 * slider.mass), slider.natural_angular_frequency
    return FreeMotion(rate=rate, square_root=(rate - natural) * (rate + natural), natural=natural)
