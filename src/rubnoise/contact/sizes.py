"""How large junctions are: the laws of the diameter, each with its exact moments."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import normal_above
from rubnoise.streams import LARGEST_UNIFORM

Doubles = NDArray[np.float64]


class SizeLaw(Protocol):
    """A law of junction diameters d > 0, in um."""

    def moment(self, power: int) -> float:
        """Return E[d^n] in um^n, exact for the law as it is drawn."""
        ...

    def density(self, diameter: Doubles) -> Doubles:
        """Return the probability density in 1/um (of the continuous part)."""
        ...

    @property
    def support(self) -> tuple[float, float]:
        """Diameters in um outside which less than 1e-16 of the law lies; equal ends mean a single size."""
        ...

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one diameter in um for each uniform on [0, 1)."""
        ...

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return diameters with density proportional to d f(d): what is found alive at a random place."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedSizes:
    """Every junction has the same diameter, in um; E[d^n] = d^n."""

    diameter: float

    def moment(self, power: int) -> float:
        """Return E[d^n] in um^n, rounded once: a library's pow changes bits between processors."""
        return float(Fraction(self.diameter) ** power)

    def density(self, diameter: Doubles) -> Doubles:
        """Return zeros: a single size has no continuous part."""
        return np.zeros_like(diameter)

    @property
    def support(self) -> tuple[float, float]:
        """The one diameter, twice, in um."""
        return self.diameter, self.diameter

    def draw(self, uniform: Doubles) -> Doubles:
        """Return the diameter in um for each uniform."""
        return np.full(uniform.shape, self.diameter)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return the diameter in um ``count`` times: one size is not biased by its length."""
        del generator
        return np.full(count, self.diameter)


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalSizes:
    """Diameters Normal(mean, std) in um, drawn again while they are <= 0 (paper, below Eq. 13).

    Drawing again is the normal law conditioned on d > 0; it is drawn here by inversion, one uniform a diameter.
    Moments: m_0 = 1, m_1 = mean + std h, m_n = mean m_(n-1) + (n-1) std^2 m_(n-2), with h the normal density over
    the normal distribution function at mean/std.
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[d^n] in um^n of the conditioned law, at 40 digits rounded once."""
        return _positive_normal_moment(self.mean, self.std, power)

    def density(self, diameter: Doubles) -> Doubles:
        """Return the density in 1/um of the conditioned law."""
        z = (diameter - self.mean) / self.std
        height = 1.0 / (np.sqrt(2.0 * np.pi) * self.std * self._positive_mass)
        return np.where(diameter > 0.0, height * np.exp(-0.5 * z * z), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Diameters within 8.3 standard deviations of the mean, and positive, in um."""
        return max(0.0, self.mean - 8.3 * self.std), self.mean + 8.3 * self.std

    @property
    def _positive_mass(self) -> float:
        return _normal_distribution(self.mean, self.std)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one diameter in um for each uniform on [0, 1)."""
        diameters = normal_above(uniform, self._positive_mass)
        diameters *= self.std
        diameters += self.mean
        # Rounding may land on the excluded bound itself; a diameter of no extent has no life to divide by.
        return np.maximum(diameters, self.std * 2.0**-52, out=diameters)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return diameters in um with density proportional to d f(d).

        Rejection from the law itself with acceptance d / d_largest; exact, since a 53-bit uniform bounds d.
        """
        largest = float(self.draw(np.array([LARGEST_UNIFORM]))[0])
        return _accepted(lambda n: self.draw(generator.random(n)), generator, largest, count)


def _accepted(propose: Callable[[int], Doubles], generator: np.random.Generator, largest: float, count: int) -> Doubles:
    """Keep proposals with probability d / largest until there are ``count`` of them."""
    kept = np.empty(0)
    while kept.size < count:
        diameters = propose(max(64, count))
        keep = generator.random(diameters.size) * largest < diameters
        kept = np.concatenate([kept, diameters[keep]])
    return kept[:count]


@lru_cache(maxsize=64)
def _normal_distribution(mean: float, std: float) -> float:
    """Return P(Normal(mean, std) > 0)."""
    import mpmath

    with mpmath.workdps(40):
        return float(mpmath.ncdf(mpmath.mpf(mean) / std))


@lru_cache(maxsize=256)
def _positive_normal_moment(mean: float, std: float, power: int) -> float:
    import mpmath

    with mpmath.workdps(60):
        return float(positive_normal_moment(mpmath.mpf(mean), mpmath.mpf(std), power))


def positive_normal_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[d^n | d > 0] for d ~ Normal(mean, std), mpmath numbers in and out, at the working precision.

    Integration by parts of z phi(z) = -phi'(z); the boundary term at d = 0 is there for n = 1 alone.
    """
    import mpmath

    ratio = mean / std
    previous, current = mpmath.mpf(1), mean + std * mpmath.npdf(ratio) / mpmath.ncdf(ratio)
    if power == 0:
        return previous
    for n in range(2, power + 1):
        previous, current = current, mean * current + (n - 1) * std**2 * previous
    return current
