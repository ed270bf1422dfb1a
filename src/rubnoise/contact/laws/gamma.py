"""The gamma law, and the exponential law, which is the gamma law whose standard deviation is its mean."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import factorial
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.deviates import density_at_the_mean, exponential, gamma_deviates, likely_range
from rubnoise.contact.laws.law import LEAST, LawEntry, rounded_moment


@dataclass(frozen=True, slots=True, kw_only=True)
class Exponential:
    """A law of density exp(-x / mean) / mean, whose standard deviation is its mean: E[x^n] = n! mean^n."""

    mean: float

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return float(factorial(power) * Fraction(self.mean) ** power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 if x is not positive."""
        return np.where(value > 0.0, np.exp(-np.maximum(value, 0.0) / self.mean) / self.mean, 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with 5e-17 of the law below and above them. Averages of x^n have weight beyond it."""
        return 5e-17 * self.mean, 37.54 * self.mean

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        return self.mean * np.maximum(exponential(uniform), LEAST)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): each the sum of two independent ones."""
        return self.draw(generator.random(count)) + self.draw(generator.random(count))


@dataclass(frozen=True, slots=True, kw_only=True)
class Gamma:
    """A gamma law with its mean and standard deviation given; its shape is (mean/std)^2.

    Density proportional to x^(shape - 1) exp(-shape x / mean). Moments: m_n = m_(n-1) (mean + (n - 1) std^2 / mean).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return rounded_moment(gamma_moment, self.mean, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 if x is not positive."""
        height, shape = _height_and_shape(self.mean, self.std)
        ratio = np.where(value > 0.0, value / self.mean, 1.0)
        below_peak = shape * (np.log(ratio) - (ratio - 1.0))
        return np.where(value > 0.0, height * np.exp(below_peak) / (ratio * self.mean), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with less than 5e-17 of the law below and above them. Averages of x^n have weight beyond."""
        low, high = likely_range(_gamma_shape(self.mean, self.std))
        return self.mean * max(low, LEAST), self.mean * high

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        return self.mean * np.maximum(gamma_deviates(uniform, _gamma_shape(self.mean, self.std)), LEAST)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): gamma of a shape greater by 1."""
        mean = self.mean + self.std * (self.std / self.mean)
        return mean * gamma_deviates(generator.random(count), _gamma_shape(self.mean, self.std, 1))


def gamma_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[x^n] of the gamma law, mpmath numbers in and out, at the working precision."""
    moment = mean**0
    for n in range(power):
        moment *= mean + n * std**2 / mean
    return moment


@lru_cache(maxsize=64)
def _gamma_shape(mean: float, std: float, more: int = 0) -> Any:
    import mpmath

    with mpmath.workdps(80):
        return (mpmath.mpf(mean) / std) ** 2 + more


@lru_cache(maxsize=64)
def _height_and_shape(mean: float, std: float) -> tuple[float, float]:
    """Return the density of ln x at the mean, and the shape, rounded once."""
    import mpmath

    shape = _gamma_shape(mean, std)
    with mpmath.workdps(80):
        return float(density_at_the_mean(shape)), float(shape)


EXPONENTIAL_ENTRY = LawEntry(
    name="exponential",
    about="a standard deviation equal to the mean",
    make=lambda centre, _std, _own: Exponential(mean=centre),
    moment=lambda centre, _std, _own, n: factorial(n) * centre**n,
    takes_spread=False,
    with_spread="gamma",
)

GAMMA_ENTRY = LawEntry(
    name="gamma",
    about="an exponential tail",
    make=lambda centre, std, _own: Gamma(mean=centre, std=std),
    moment=lambda centre, std, _own, n: gamma_moment(centre, std, n),
)
