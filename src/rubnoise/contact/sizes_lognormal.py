"""Lognormal diameters: a long tail of large junctions, none of no size."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import antilogarithm, normal_above
from rubnoise.contact.lognormal import lognormal_deviates, median_and_log_std, rounded_lognormal_moment

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class LognormalSizes:
    """Diameters whose logarithm is normal, with their own mean and standard deviation given, in um.

    With cv = std/mean, ln d is normal with variance ln(1 + cv^2) about the logarithm of mean / sqrt(1 + cv^2).
    Moments: m_n = mean^n (1 + cv^2)^(n(n-1)/2).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[d^n] in um^n, rounded once."""
        return rounded_lognormal_moment(self.mean, self.std, power)

    def density(self, diameter: Doubles) -> Doubles:
        """Return the density in 1/um; 0 where d is not positive."""
        median, log_std = median_and_log_std(self.mean, self.std)
        d = np.where(diameter > 0.0, diameter, median)
        z = np.log(d / median) / log_std
        return np.where(diameter > 0.0, np.exp(-0.5 * z * z) / (np.sqrt(2.0 * np.pi) * log_std * d), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Diameters in um within 8.31 standard deviations of ln d. Averages of d^n have weight beyond it."""
        median, log_std = median_and_log_std(self.mean, self.std)
        low, high = antilogarithm(np.array([-8.31, 8.31]) * log_std).tolist()
        return median * low, median * high

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one diameter in um for each uniform on [0, 1)."""
        return lognormal_deviates(uniform, self.mean, self.std)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return diameters in um with density proportional to d f(d).

        Exactly: weighing by d moves the median by the factor 1 + cv^2 and leaves the spread of ln d.
        """
        median, log_std = median_and_log_std(self.mean, self.std)
        moved = median * (1.0 + (self.std / self.mean) * (self.std / self.mean))
        return moved * antilogarithm(log_std * normal_above(generator.random(count), 1.0))
