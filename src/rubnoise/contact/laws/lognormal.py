"""The lognormal law: positive values with a long tail."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.deviates import antilogarithm, normal_above
from rubnoise.contact.laws.law import LawEntry, rounded_moment


@dataclass(frozen=True, slots=True, kw_only=True)
class Lognormal:
    """A law whose logarithm is normal, with its own mean and standard deviation given.

    With cv = std/mean, ln x is normal with variance ln(1 + cv^2) about the logarithm of mean / sqrt(1 + cv^2).
    Moments: E[x^n] = mean^n (1 + cv^2)^(n(n-1)/2).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return rounded_moment(lognormal_moment, self.mean, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 if x is not positive."""
        median, log_std = self._median_and_log_std
        x = np.where(value > 0.0, value, median)
        z = np.log(x / median) / log_std
        return np.where(value > 0.0, np.exp(-0.5 * z * z) / (np.sqrt(2.0 * np.pi) * log_std * x), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values within 8.31 standard deviations of ln x. Averages of x^n have weight beyond it."""
        median, log_std = self._median_and_log_std
        low, high = antilogarithm(np.array([-8.31, 8.31]) * log_std).tolist()
        return median * low, median * high

    @property
    def _median_and_log_std(self) -> tuple[float, float]:
        return _median_and_log_std(self.mean, self.std)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1): the median times e^(z times the standard deviation of ln x)."""
        median, log_std = self._median_and_log_std
        return median * antilogarithm(log_std * normal_above(uniform, 1.0))

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x).

        Exactly: weighing by x moves the median by the factor 1 + cv^2 and leaves the spread of ln x.
        """
        median, log_std = self._median_and_log_std
        moved = median * (1.0 + (self.std / self.mean) * (self.std / self.mean))
        return moved * antilogarithm(log_std * normal_above(generator.random(count), 1.0))


def lognormal_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[x^n] = mean^n (1 + (std/mean)^2)^(n(n-1)/2), mpmath numbers in and out, at the working precision."""
    return mean**power * (1 + (std / mean) ** 2) ** (power * (power - 1) // 2)


@lru_cache(maxsize=64)
def _median_and_log_std(mean: float, std: float) -> tuple[float, float]:
    """Return the median, mean / sqrt(1 + cv^2), and the standard deviation of ln x, sqrt(ln(1 + cv^2)); cv = std/mean.

    At 40 digits and rounded once.
    """
    import mpmath

    with mpmath.workdps(40):
        variation = (mpmath.mpf(std) / mean) ** 2
        return float(mean / mpmath.sqrt(1 + variation)), float(mpmath.sqrt(mpmath.log1p(variation)))


ENTRY = LawEntry(
    name="lognormal",
    about="a normal logarithm",
    make=lambda centre, std, _own: Lognormal(mean=centre, std=std),
    moment=lambda centre, std, _own, n: lognormal_moment(centre, std, n),
)
