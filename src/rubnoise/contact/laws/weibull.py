"""The Weibull law, which describes the failure of the weakest of many parts."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.deviates import antilogarithm, exponential, gamma_deviates, logarithm
from rubnoise.contact.laws.law import LawEntry, rounded_moment


@dataclass(frozen=True, slots=True, kw_only=True)
class Weibull:
    """A Weibull law with its mean and standard deviation given.

    P(X > x) = exp(-(x / scale)^shape); the shape solves Gamma(1 + 2/shape) / Gamma(1 + 1/shape)^2 = 1 + (std/mean)^2.
    Moments: E[x^n] = scale^n Gamma(1 + n/shape), scale = mean / Gamma(1 + 1/shape).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return rounded_moment(weibull_moment, self.mean, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 if x is not positive."""
        scale, exponent = self._scale_and_exponent
        x = np.where(value > 0.0, value / scale, 1.0)
        grown = x ** (1.0 / exponent)
        return np.where(value > 0.0, grown * np.exp(-grown) / (exponent * scale * x), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with 5e-17 of the law below and above them. Averages of x^n have weight beyond it."""
        scale, exponent = self._scale_and_exponent
        return scale * 5e-17**exponent, scale * 37.54**exponent

    @property
    def _scale_and_exponent(self) -> tuple[float, float]:
        return _scale_and_exponent(self.mean, self.std)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1): scale times an exponential deviate^(1/shape)."""
        scale, exponent = self._scale_and_exponent
        # A uniform of 0 is a value of 0, which has no logarithm: it stands for the lower half of its interval.
        deviate = np.maximum(exponential(uniform), 2.0**-54)
        return scale * antilogarithm(exponent * logarithm(deviate))

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): (x / scale)^shape is then gamma of shape 1 + 1/shape."""
        scale, exponent = self._scale_and_exponent
        shape = 1 + _weibull_exponent(self.mean, self.std)
        return scale * antilogarithm(
            exponent * logarithm(float(shape) * gamma_deviates(generator.random(count), shape))
        )


def weibull_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[x^n] of the Weibull law, mpmath numbers in and out, at the working precision up to 60 digits."""
    import mpmath

    exponent = _weibull_exponent(mean, std)
    return (mean / mpmath.gamma(1 + exponent)) ** power * mpmath.gamma(1 + power * exponent)


@lru_cache(maxsize=256)
def _weibull_exponent(mean: Any, std: Any) -> Any:
    """Return 1/shape of the Weibull law, an mpmath number good to 50 digits."""
    import mpmath

    def excess(exponent: Any) -> Any:
        growth = mpmath.loggamma(1 + 2 * exponent) - 2 * mpmath.loggamma(1 + exponent)
        return mpmath.sqrt(mpmath.expm1(growth)) / variation - 1

    with mpmath.workdps(120):
        variation = mpmath.mpf(std) / mean
        return mpmath.findroot(excess, (variation / 3, 2 * variation), solver="anderson")


@lru_cache(maxsize=64)
def _scale_and_exponent(mean: float, std: float) -> tuple[float, float]:
    import mpmath

    with mpmath.workdps(60):
        exponent = _weibull_exponent(mean, std)
        return float(mean / mpmath.gamma(1 + exponent)), float(exponent)


ENTRY = LawEntry(
    name="weibull",
    about="the weakest of many parts",
    make=lambda centre, std, _own: Weibull(mean=centre, std=std),
    moment=lambda centre, std, _own, n: weibull_moment(centre, std, n),
)
