"""Exponential and gamma diameters: many small junctions beside few large ones."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import exponential
from rubnoise.contact.gamma_deviates import density_at_the_mean, gamma_deviates, likely_range

Doubles = NDArray[np.float64]

# Diameters below this part of the mean, which a uniform of 0 or a steep law can make, become it: a junction needs an
# extent to divide by, and its square and fifth power may not vanish. No moment notices.
_LEAST = 2.0**-100


@dataclass(frozen=True, slots=True, kw_only=True)
class ExponentialSizes:
    """Diameters of density exp(-d / mean) / mean, in um; their standard deviation is their mean: E[d^n] = n! mean^n."""

    mean: float

    def moment(self, power: int) -> float:
        """Return E[d^n] in um^n, rounded once."""
        return float(factorial(power) * Fraction(self.mean) ** power)

    def density(self, diameter: Doubles) -> Doubles:
        """Return the density in 1/um; 0 where d is not positive."""
        return np.where(diameter > 0.0, np.exp(-np.maximum(diameter, 0.0) / self.mean) / self.mean, 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Diameters in um with 5e-17 of the law below and above them. Averages of d^n have weight beyond it."""
        return 5e-17 * self.mean, 37.54 * self.mean

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one diameter in um for each uniform on [0, 1)."""
        return self.mean * np.maximum(exponential(uniform), _LEAST)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return diameters in um with density proportional to d f(d): each the sum of two independent ones."""
        return self.draw(generator.random(count)) + self.draw(generator.random(count))


@dataclass(frozen=True, slots=True, kw_only=True)
class GammaSizes:
    """Diameters of a gamma law with their mean and standard deviation given, in um; its shape is (mean/std)^2.

    Density proportional to d^(shape - 1) exp(-shape d / mean). Moments: m_n = m_(n-1) (mean + (n - 1) std^2 / mean).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[d^n] in um^n, at 40 digits rounded once."""
        return _rounded_moment(self.mean, self.std, power)

    def density(self, diameter: Doubles) -> Doubles:
        """Return the density in 1/um; 0 where d is not positive."""
        height, shape = _height_and_shape(self.mean, self.std)
        ratio = np.where(diameter > 0.0, diameter / self.mean, 1.0)
        below_peak = shape * (np.log(ratio) - (ratio - 1.0))
        return np.where(diameter > 0.0, height * np.exp(below_peak) / (ratio * self.mean), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Diameters in um with less than 5e-17 of the law below and above them. Averages of d^n have weight beyond."""
        low, high = likely_range(_shape(self.mean, self.std))
        return self.mean * max(low, _LEAST), self.mean * high

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one diameter in um for each uniform on [0, 1)."""
        return self.mean * np.maximum(gamma_deviates(uniform, _shape(self.mean, self.std)), _LEAST)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return diameters in um with density proportional to d f(d): gamma of a shape greater by 1."""
        mean = self.mean + self.std * (self.std / self.mean)
        return mean * gamma_deviates(generator.random(count), _shape(self.mean, self.std, 1))


def gamma_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[d^n] of the gamma law, mpmath numbers in and out, at the working precision."""
    moment = mean**0
    for n in range(power):
        moment *= mean + n * std**2 / mean
    return moment


@lru_cache(maxsize=256)
def _rounded_moment(mean: float, std: float, power: int) -> float:
    import mpmath

    with mpmath.workdps(40):
        return float(gamma_moment(mpmath.mpf(mean), mpmath.mpf(std), power))


@lru_cache(maxsize=64)
def _shape(mean: float, std: float, more: int = 0) -> Any:
    import mpmath

    with mpmath.workdps(80):
        return (mpmath.mpf(mean) / std) ** 2 + more


@lru_cache(maxsize=64)
def _height_and_shape(mean: float, std: float) -> tuple[float, float]:
    """Return the density of ln d at the mean, and the shape, rounded once."""
    import mpmath

    shape = _shape(mean, std)
    with mpmath.workdps(80):
        return float(density_at_the_mean(shape)), float(shape)
