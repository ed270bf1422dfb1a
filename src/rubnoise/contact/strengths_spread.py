"""Strengths that differ from junction to junction: normal, lognormal and Weibull."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import antilogarithm, exponential, logarithm
from rubnoise.contact.lognormal import lognormal_deviates, rounded_lognormal_moment
from rubnoise.contact.sizes import NormalSizes
from rubnoise.contact.strengths import ConstantStrength, StrengthLaw

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalStrength:
    """Shear strengths Normal(centre, std) in MPa, drawn again while they are <= 0; so E[psi] exceeds the centre.

    The law is that of `rubnoise.contact.sizes.NormalSizes`, and so are its moments.
    """

    centre: float
    std: float

    @property
    def mean(self) -> float:
        """E[psi] in MPa, after drawing again."""
        return self.moment(1)

    def moment(self, power: int) -> float:
        """Return E[psi^n] in MPa^n, rounded once."""
        return self._law.moment(power)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one strength in MPa for each uniform on [0, 1)."""
        return self._law.draw(uniform)

    @property
    def _law(self) -> NormalSizes:
        return NormalSizes(mean=self.centre, std=self.std)


@dataclass(frozen=True, slots=True, kw_only=True)
class LognormalStrength:
    """Shear strengths whose logarithm is normal, with their own mean and standard deviation given, in MPa.

    Moments: E[psi^n] = mean^n (1 + (std/mean)^2)^(n(n-1)/2).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[psi^n] in MPa^n, rounded once."""
        return rounded_lognormal_moment(self.mean, self.std, power)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one strength in MPa for each uniform on [0, 1)."""
        return lognormal_deviates(uniform, self.mean, self.std)


@dataclass(frozen=True, slots=True, kw_only=True)
class WeibullStrength:
    """Shear strengths of a Weibull law with their mean and standard deviation given, in MPa.

    P(psi > x) = exp(-(x / scale)^shape); the shape solves Gamma(1 + 2/shape) / Gamma(1 + 1/shape)^2 = 1 + (std/mean)^2.
    Moments: E[psi^n] = scale^n Gamma(1 + n/shape), scale = mean / Gamma(1 + 1/shape).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[psi^n] in MPa^n, at 40 digits rounded once."""
        return _weibull_moment(self.mean, self.std, power)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one strength in MPa for each uniform on [0, 1): scale times an exponential deviate^(1/shape)."""
        scale, exponent = _scale_and_exponent(self.mean, self.std)
        # A uniform of 0 is a strength of 0, which has no logarithm: it stands for the lower half of its interval.
        deviate = np.maximum(exponential(uniform), 2.0**-54)
        return scale * antilogarithm(exponent * logarithm(deviate))


def strengths_for(law: str, mean: float, std: float) -> StrengthLaw:
    """Return the strength law of a name, a mean and a standard deviation in MPa; no spread is one strength."""
    if std == 0.0:
        return ConstantStrength(mean=mean)
    if law == "normal":
        return NormalStrength(centre=mean, std=std)
    return LognormalStrength(mean=mean, std=std) if law == "lognormal" else WeibullStrength(mean=mean, std=std)


@lru_cache(maxsize=64)
def _exponent(mean: float, std: float) -> Any:
    """Return 1/shape of the Weibull law, an mpmath number good to 50 digits."""
    import mpmath

    def excess(exponent: Any) -> Any:
        growth = mpmath.loggamma(1 + 2 * exponent) - 2 * mpmath.loggamma(1 + exponent)
        return mpmath.sqrt(mpmath.expm1(growth)) / variation - 1

    with mpmath.workdps(120):
        variation = mpmath.mpf(std) / mean
        return mpmath.findroot(excess, (variation / 3, 2 * variation), solver="anderson")


@lru_cache(maxsize=64)
def _weibull_moment(mean: float, std: float, power: int) -> float:
    import mpmath

    with mpmath.workdps(60):
        exponent = _exponent(mean, std)
        return float((mean / mpmath.gamma(1 + exponent)) ** power * mpmath.gamma(1 + power * exponent))


@lru_cache(maxsize=64)
def _scale_and_exponent(mean: float, std: float) -> tuple[float, float]:
    import mpmath

    with mpmath.workdps(60):
        exponent = _exponent(mean, std)
        return float(mean / mpmath.gamma(1 + exponent)), float(exponent)
