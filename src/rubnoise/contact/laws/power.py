"""A power law between two values, as found on measured surfaces."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.deviates import antilogarithm, logarithm
from rubnoise.contact.laws.law import LawEntry, Parameter


@dataclass(frozen=True, slots=True, kw_only=True)
class Power:
    """A law of density proportional to x^-exponent between two values, as contact spots of fractal surfaces have it.

    With q = 1 - exponent and L = ln(largest / smallest), x = smallest exp(L y) with y = ln(1 + u (exp(q L) - 1))/(q L)
    for a uniform u, and y = u if q = 0. Moments: E[x^n] = smallest^n g((q + n) L) / g(q L), g(z) = (exp z - 1)/z.
    Source: Majumdar and Bhushan (1991), doi:10.1115/1.2920588, whose number of spots falls as a power of their size.
    """

    exponent: float
    smallest: float
    largest: float

    @property
    def mean(self) -> float:
        """E[x]."""
        return self.moment(1)

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return _rounded_power_moment(self.exponent, self.smallest, self.largest, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 outside [smallest, largest]."""
        _, _, height = _power_constants(self.exponent, self.smallest, self.largest)
        inside = (value >= self.smallest) & (value <= self.largest)
        ratio = np.where(inside, value / self.smallest, 1.0)
        return np.where(inside, height * ratio**-self.exponent, 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """The smallest and the largest value."""
        return self.smallest, self.largest

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        log_ratio, growth, _ = _power_constants(self.exponent, self.smallest, self.largest)
        if growth == 0.0:
            logs = log_ratio * uniform
        else:
            added = growth * uniform
            grown = 1.0 + added
            # ln(1 + z) as z ln(w) / (w - 1) with w = 1 + z as rounded: the rounding of w cancels (Kahan).
            step = np.where(grown == 1.0, 1.0, grown - 1.0)
            slope = np.where(grown == 1.0, 1.0, logarithm(grown) / step)
            logs = added * slope / (1.0 - self.exponent)
        return np.clip(self.smallest * antilogarithm(logs), self.smallest, self.largest)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): a power law whose exponent is less by 1."""
        biased = Power(exponent=self.exponent - 1.0, smallest=self.smallest, largest=self.largest)
        return biased.draw(generator.random(count))


def power_moment(exponent: Any, smallest: Any, largest: Any, power: int) -> Any:
    """Return E[x^n] of the bounded power law as an mpmath number, at the working precision."""
    import mpmath

    exponent, smallest, largest = map(mpmath.mpf, (exponent, smallest, largest))
    log_ratio = mpmath.log(largest / smallest)

    def mean_growth(rate: Any) -> Any:
        return mpmath.expm1(rate * log_ratio) / (rate * log_ratio) if rate else mpmath.mpf(1)

    return smallest**power * mean_growth(1 - exponent + power) / mean_growth(1 - exponent)


@lru_cache(maxsize=256)
def _rounded_power_moment(exponent: float, smallest: float, largest: float, power: int) -> float:
    import mpmath

    with mpmath.workdps(60):
        return float(power_moment(exponent, smallest, largest, power))


@lru_cache(maxsize=64)
def _power_constants(exponent: float, smallest: float, largest: float) -> tuple[float, float, float]:
    """Return L = ln(largest / smallest), exp(q L) - 1 and the density at the smallest value, rounded once."""
    import mpmath

    with mpmath.workdps(60):
        low, rate = mpmath.mpf(smallest), 1 - mpmath.mpf(exponent)
        log_ratio = mpmath.log(mpmath.mpf(largest) / low)
        growth = mpmath.expm1(rate * log_ratio)
        return float(log_ratio), float(growth), float(1 / (low * (growth / rate if rate else log_ratio)))


ENTRY = LawEntry(
    name="power",
    about="density ~ x^-exponent between smallest and largest",
    make=lambda centre, _std, own: Power(
        exponent=own["exponent"], smallest=own["smallest"] * centre, largest=own["largest"] * centre
    ),
    moment=lambda centre, _std, own, n: centre**n * power_moment(power=n, **own),
    parameters=(
        Parameter(name="exponent", about="Fall of the density ~ x^-exponent", low=-10.0, high=10.0, sample=2.5),
        Parameter(name="smallest", about="Smallest value over {centre}", low=1e-3, high=1e3, sample=0.5),
        Parameter(name="largest", about="Largest value over {centre}", low=1e-3, high=1e3, sample=4.0),
    ),
    ascending=("smallest", "largest"),
    takes_spread=False,
    with_spread="lognormal",
)
