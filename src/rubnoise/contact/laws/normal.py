"""The normal law, drawn again while not positive."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.deviates import normal_above
from rubnoise.contact.laws.law import LawEntry, rounded_moment
from rubnoise.streams import LARGEST_UNIFORM


@dataclass(frozen=True, slots=True, kw_only=True)
class Normal:
    """Normal(centre, std), drawn again while not positive (paper, below Eq. 13).

    Drawing again is the normal law conditioned on x > 0; it is drawn here by inversion, one uniform a value. Moments:
    m_0 = 1, m_1 = centre + std h, m_n = centre m_(n-1) + (n-1) std^2 m_(n-2), with h the normal density over the
    normal distribution function at centre/std.
    """

    centre: float
    std: float

    @property
    def mean(self) -> float:
        """E[x] after drawing again, which exceeds the centre."""
        return self.moment(1)

    def moment(self, power: int) -> float:
        """Return E[x^n] of the conditioned law, at 60 digits rounded once."""
        return rounded_moment(normal_moment, self.centre, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density of the conditioned law."""
        z = (value - self.centre) / self.std
        height = 1.0 / (np.sqrt(2.0 * np.pi) * self.std * self._positive_mass)
        return np.where(value > 0.0, height * np.exp(-0.5 * z * z), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Positive values within 8.3 standard deviations of the centre."""
        return max(0.0, self.centre - 8.3 * self.std), self.centre + 8.3 * self.std

    @property
    def _positive_mass(self) -> float:
        return _positive_mass(self.centre, self.std)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        values = normal_above(uniform, self._positive_mass)
        values *= self.std
        values += self.centre
        # Rounding may land on the excluded bound itself; a diameter of no extent has no life to divide by.
        return np.maximum(values, self.std * 2.0**-52, out=values)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x).

        Rejection from the law itself with acceptance x / x_largest; exact, since a 53-bit uniform bounds x.
        """
        largest = float(self.draw(np.array([LARGEST_UNIFORM]))[0])
        kept = np.empty(0)
        while kept.size < count:
            values = self.draw(generator.random(max(64, count)))
            keep = generator.random(values.size) * largest < values
            kept = np.concatenate([kept, values[keep]])
        return kept[:count]


def normal_moment(centre: Any, std: Any, power: int) -> Any:
    """Return E[x^n | x > 0] for x ~ Normal(centre, std), mpmath numbers in and out, at the working precision.

    Integration by parts of z phi(z) = -phi'(z); the boundary term at x = 0 is there for n = 1 alone.
    """
    import mpmath

    ratio = centre / std
    previous, current = mpmath.mpf(1), centre + std * mpmath.npdf(ratio) / mpmath.ncdf(ratio)
    if power == 0:
        return previous
    for n in range(2, power + 1):
        previous, current = current, centre * current + (n - 1) * std**2 * previous
    return current


@lru_cache(maxsize=64)
def _positive_mass(centre: float, std: float) -> float:
    """Return P(Normal(centre, std) > 0)."""
    import mpmath

    with mpmath.workdps(40):
        return float(mpmath.ncdf(mpmath.mpf(centre) / std))


ENTRY = LawEntry(
    name="normal",
    about="redrawn while not positive",
    make=lambda centre, std, _own: Normal(centre=centre, std=std),
    moment=lambda centre, std, _own, n: normal_moment(centre, std, n),
    widest=float("inf"),
)
