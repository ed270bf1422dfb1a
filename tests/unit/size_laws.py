"""Wide size laws for the tests of the theory, each written from its density and its moments alone."""

from dataclasses import dataclass
from math import exp, lgamma, log

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class WideLaw:
    """What the theory asks of a law, without draws."""

    mean: float
    relative_spread: float

    def draw(self, uniform: Doubles) -> Doubles:
        raise NotImplementedError

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        raise NotImplementedError


@dataclass(frozen=True)
class LogNormal(WideLaw):
    """log d is normal."""

    @property
    def log_variance(self) -> float:
        return log(1.0 + self.relative_spread**2)

    def moment(self, power: int) -> float:
        return self.mean**power * exp(0.5 * power * (power - 1) * self.log_variance)

    def density(self, diameter: Doubles) -> Doubles:
        z = (np.log(diameter / self.mean) + 0.5 * self.log_variance) / self.log_variance**0.5
        return np.exp(-0.5 * z * z) / (diameter * np.sqrt(2.0 * np.pi * self.log_variance))

    @property
    def support(self) -> tuple[float, float]:
        low, high = (np.exp(-0.5 * self.log_variance + z * self.log_variance**0.5) for z in (-8.3, 8.3))
        return self.mean * float(low), self.mean * float(high)


@dataclass(frozen=True)
class Gamma(WideLaw):
    """A gamma law; with a relative spread of 1 it is exponential, with more its density is singular at 0."""

    @property
    def order(self) -> float:
        return self.relative_spread**-2

    def moment(self, power: int) -> float:
        return (self.mean / self.order) ** power * exp(lgamma(self.order + power) - lgamma(self.order))

    def density(self, diameter: Doubles) -> Doubles:
        x = diameter * (self.order / self.mean)
        return np.exp((self.order - 1.0) * np.log(x) - x - lgamma(self.order)) * (self.order / self.mean)

    @property
    def support(self) -> tuple[float, float]:
        return 0.0, self.mean * (1.0 + 37.0 * self.relative_spread * max(1.0, self.relative_spread))
