"""The laws of positive quantities: how large junctions are, in um, and how strong, in MPa.

A law has its moments, its density and its quantile function, which makes one value of one uniform on (0, 1). To add a
law, write its class here and its entry in `contact.laws`.
"""

from collections.abc import Hashable
from dataclasses import dataclass
from functools import lru_cache
from math import erfc, exp, expm1, fsum, gamma, lgamma, log, log1p, pi, prod, sqrt
from typing import Any, Final, Protocol

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.streams import LARGEST_UNIFORM

LEAST: Final = 2.0**-100  # of the mean: smaller values become it, for a fifth power may not vanish
_BEYOND: Final = 5e-17  # chance of a value below or above the support of a law without bounds


def special() -> Any:
    """Return the special functions of scipy, which take long to load: who reads a result needs none."""
    import scipy.special

    return scipy.special


class Law(Hashable, Protocol):
    """A law of a positive quantity x, in whatever unit its parameters have; equal laws hash alike."""

    @property
    def mean(self) -> float:
        """E[x]."""
        ...

    def moment(self, power: int) -> float:
        """Return E[x^n] of the law as it is drawn, right to 1e-14."""
        ...

    def density(self, value: Doubles) -> Doubles:
        """Return the probability density of the continuous part, in one over the unit of x."""
        ...

    @property
    def support(self) -> tuple[float, float]:
        """Values outside which less than 1e-16 of the law lies; equal ends mean a single value."""
        ...

    def quantile(self, probability: Doubles) -> Doubles:
        """Return the values with these probabilities below them, which lie in (0, 1)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixed:
    """One value for every junction; E[x^n] = x^n."""

    value: float

    @property
    def mean(self) -> float:
        """The value."""
        return self.value

    def moment(self, power: int) -> float:
        """Return x^n."""
        return float(self.value**power)

    def density(self, value: Doubles) -> Doubles:
        """Return zeros: a single value has no continuous part."""
        return np.zeros_like(value)

    @property
    def support(self) -> tuple[float, float]:
        """The value, twice."""
        return self.value, self.value

    def quantile(self, probability: Doubles) -> Doubles:
        """Return the value."""
        return np.full(probability.shape, self.value)


@dataclass(frozen=True, slots=True, kw_only=True)
class Normal:
    """Normal(centre, std), drawn again while not positive (paper, below Eq. 13).

    Drawing again is the normal law conditioned on x > 0. Moments: m_0 = 1, m_1 = centre + std h, m_n = centre m_(n-1) +
    (n-1) std^2 m_(n-2), with h the normal density over the normal distribution function at centre/std.
    """

    centre: float
    std: float

    @property
    def mean(self) -> float:
        """E[x] after drawing again, which exceeds the centre."""
        return self.moment(1)

    @property
    def _mass_above_0(self) -> float:
        return 0.5 * erfc(-self.centre / (sqrt(2.0) * self.std))

    def moment(self, power: int) -> float:
        """Return E[x^n] of the conditioned law."""
        height = exp(-0.5 * (self.centre / self.std) ** 2) / (sqrt(2.0 * pi) * self._mass_above_0)
        before, moment = 1.0, self.centre + self.std * height
        for n in range(2, power + 1):
            before, moment = moment, self.centre * moment + (n - 1) * self.std**2 * before
        return moment if power else 1.0

    def density(self, value: Doubles) -> Doubles:
        """Return the density of the conditioned law."""
        z = (value - self.centre) / self.std
        height = 1.0 / (sqrt(2.0 * pi) * self.std * self._mass_above_0)
        return np.where(value > 0.0, height * np.exp(-0.5 * z * z), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Positive values within 8.3 standard deviations of the centre."""
        return max(0.0, self.centre - 8.3 * self.std), self.centre + 8.3 * self.std

    def quantile(self, probability: Doubles) -> Doubles:
        """Return centre - std z, z leaving 1 - p of the mass above 0 below it."""
        below = (1.0 - probability) * self._mass_above_0
        # Rounding may land on the excluded bound itself; a diameter of no extent has no life to divide by.
        return np.maximum(self.centre - self.std * special().ndtri(below), self.std * 2.0**-52)


@dataclass(frozen=True, slots=True, kw_only=True)
class Lognormal:
    """A law whose logarithm is normal, with its own mean and standard deviation given.

    With cv = std/mean, ln x is normal with variance ln(1 + cv^2) about the logarithm of mean / sqrt(1 + cv^2).
    Moments: E[x^n] = mean^n (1 + cv^2)^(n(n-1)/2).
    """

    mean: float
    std: float

    @property
    def _median_and_log_std(self) -> tuple[float, float]:
        square = (self.std / self.mean) ** 2
        return self.mean / sqrt(1.0 + square), sqrt(log1p(square))

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        return float(self.mean**power * (1.0 + (self.std / self.mean) ** 2) ** (power * (power - 1) // 2))

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 if x is not positive."""
        median, log_std = self._median_and_log_std
        x = np.where(value > 0.0, value, median)
        z = np.log(x / median) / log_std
        return np.where(value > 0.0, np.exp(-0.5 * z * z) / (sqrt(2.0 * pi) * log_std * x), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values within 8.31 standard deviations of ln x. Averages of x^n have weight beyond it."""
        median, log_std = self._median_and_log_std
        return median * exp(-8.31 * log_std), median * exp(8.31 * log_std)

    def quantile(self, probability: Doubles) -> Doubles:
        """Return the median times e^(z times the standard deviation of ln x)."""
        median, log_std = self._median_and_log_std
        return median * np.exp(log_std * special().ndtri(probability))


@dataclass(frozen=True, slots=True, kw_only=True)
class Gamma:
    """A gamma law with its mean and standard deviation given; its shape is (mean/std)^2.

    Density proportional to x^(shape - 1) exp(-shape x / mean). Moments: m_n = m_(n-1) (mean + (n - 1) std^2 / mean).
    """

    mean: float
    std: float

    @property
    def _shape(self) -> float:
        return (self.mean / self.std) ** 2

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        return prod(self.mean + n * self.std * (self.std / self.mean) for n in range(power))

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 if x is not positive."""
        shape = self._shape
        ratio = np.where(value > 0.0, value / self.mean, 1.0)
        # Where the shape is large, the logarithms of power and factorial cancel.
        at_the_mean = exp(shape * log(shape) - shape - lgamma(shape)) if shape < 1e6 else sqrt(shape / (2.0 * pi))
        below_peak = shape * (np.log(ratio) - (ratio - 1.0))
        return np.where(value > 0.0, at_the_mean * np.exp(below_peak) / (ratio * self.mean), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with 5e-17 of the law below and above them. Averages of x^n have weight beyond."""
        unit, shape = self.mean / self._shape, self._shape
        low, high = unit * special().gammaincinv(shape, _BEYOND), unit * special().gammainccinv(shape, _BEYOND)
        return max(float(low), self.mean * LEAST), float(high)

    def quantile(self, probability: Doubles) -> Doubles:
        """Return the inverse of the regularised incomplete gamma function, which takes 0.5 us a value."""
        values = self.mean / self._shape * special().gammaincinv(self._shape, probability)
        return np.maximum(values, self.mean * LEAST)


@lru_cache(maxsize=64)
def _weibull_exponent(variation: float) -> float:
    """Return 1/shape of the Weibull law whose standard deviation over mean is given."""

    def excess(exponent: float) -> float:
        return lgamma(1.0 + 2.0 * exponent) - 2.0 * lgamma(1.0 + exponent) - wanted

    wanted, low, high = log1p(variation * variation), variation / 3.0, 2.0 * variation
    while low < (middle := 0.5 * (low + high)) < high:  # scipy's root finders take longer to load than a whole answer
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    return middle


@dataclass(frozen=True, slots=True, kw_only=True)
class Weibull:
    """A Weibull law with its mean and standard deviation given: the failure of the weakest of many parts.

    P(X > x) = exp(-(x / scale)^shape); the shape solves Gamma(1 + 2/shape) / Gamma(1 + 1/shape)^2 = 1 + (std/mean)^2.
    Moments: E[x^n] = scale^n Gamma(1 + n/shape), scale = mean / Gamma(1 + 1/shape). With std = mean it is exponential.
    """

    mean: float
    std: float

    @property
    def _scale_and_exponent(self) -> tuple[float, float]:
        exponent = _weibull_exponent(self.std / self.mean)
        return self.mean / gamma(1.0 + exponent), exponent

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        scale, exponent = self._scale_and_exponent
        return float(scale**power * gamma(1.0 + power * exponent))

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
        return scale * _BEYOND**exponent, scale * (-log(_BEYOND)) ** exponent

    def quantile(self, probability: Doubles) -> Doubles:
        """Return scale times the quantile of an exponential law^(1/shape)."""
        scale, exponent = self._scale_and_exponent
        return np.asarray(scale * (-np.log1p(-probability)) ** exponent, dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class Power:
    """A law of density proportional to x^-exponent between two values, as contact spots of fractal surfaces have it.

    With q = 1 - exponent and L = ln(largest / smallest), x = smallest exp(L y) with y = ln(1 + p (exp(q L) - 1))/(q L),
    and y = p if q = 0. Moments: E[x^n] = smallest^n g((q + n) L) / g(q L), g(z) = (exp z - 1)/z.
    Source: Majumdar and Bhushan (1991), doi:10.1115/1.2920588, whose number of spots falls as a power of their size.
    """

    exponent: float
    smallest: float
    largest: float

    @property
    def mean(self) -> float:
        """E[x]."""
        return self.moment(1)

    @property
    def _log_ratio(self) -> float:
        return log(self.largest / self.smallest)

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        rate, logs = 1.0 - self.exponent, self._log_ratio
        return float(self.smallest**power * _growth((rate + power) * logs) / _growth(rate * logs))

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 outside [smallest, largest]."""
        logs = self._log_ratio
        inside = (value >= self.smallest) & (value <= self.largest)
        ratio = np.where(inside, value / self.smallest, 1.0)
        height = 1.0 / (self.smallest * logs * _growth((1.0 - self.exponent) * logs))
        return np.where(inside, height * ratio**-self.exponent, 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """The smallest and the largest value."""
        return self.smallest, self.largest

    def quantile(self, probability: Doubles) -> Doubles:
        """Return smallest exp(L y); of a falling law from the largest value downward, where less is lost."""
        rate, logs = 1.0 - self.exponent, self._log_ratio
        if rate < 0.0:
            values = self.largest * np.exp(np.log1p((1.0 - probability) * expm1(-rate * logs)) / rate)
        else:
            part = logs * probability if rate == 0.0 else np.log1p(probability * expm1(rate * logs)) / rate
            values = self.smallest * np.exp(part)
        return np.clip(values, self.smallest, self.largest)


def _growth(rate: float) -> float:
    """Return (exp z - 1)/z, 1 at z = 0."""
    return expm1(rate) / rate if rate else 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Mixture:
    """One of several laws, each with its probability: E[x^n] = sum w_i E_i[x^n]. Measured values are fixed ones."""

    weights: tuple[float, ...]
    laws: tuple[Law, ...]

    @property
    def parts(self) -> tuple[tuple[float, Law], ...]:
        """Each law with its probability."""
        return tuple(zip(self.weights, self.laws, strict=True))

    @property
    def mean(self) -> float:
        """E[x]."""
        return self.moment(1)

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        return fsum(weight * law.moment(power) for weight, law in self.parts)

    def density(self, value: Doubles) -> Doubles:
        """Return the density of the continuous parts."""
        return sum((weight * law.density(value) for weight, law in self.parts), np.zeros_like(value))

    @property
    def support(self) -> tuple[float, float]:
        """The least and the largest value of any part."""
        ends = [law.support for law in self.laws]
        return min(low for low, _ in ends), max(high for _, high in ends)

    def quantile(self, probability: Doubles) -> Doubles:
        """Return values that are not in order: p chooses the part and, within its share of (0, 1), the value."""
        sums = np.cumsum(self.weights)
        which = np.minimum(np.searchsorted(sums, probability, side="right"), len(self.laws) - 1)
        if all(isinstance(law, Fixed) for law in self.laws):  # measured values
            return np.array([law.mean for law in self.laws])[which]
        values = np.empty(probability.shape)
        for number, (weight, law) in enumerate(self.parts):
            within = (probability[which == number] - (sums[number] - weight)) / weight
            values[which == number] = law.quantile(np.clip(within, 1.0 - LARGEST_UNIFORM, LARGEST_UNIFORM))
        return values


def leaves_of(law: Law) -> list[tuple[float, Law]]:
    """Return the laws without parts of which a law is made, with their probabilities."""
    if not isinstance(law, Mixture):
        return [(1.0, law)]
    return [(weight * share, leaf) for weight, part in law.parts for share, leaf in leaves_of(part)]


def has_single_values(law: Law) -> bool:
    """Whether a law has single values with a probability of their own, so that a density is not enough."""
    return any(isinstance(leaf, Fixed) for _, leaf in leaves_of(law))


def largest_of(law: Law) -> float:
    """Return the largest value that a law, or any part of it, can draw: from the largest uniform."""
    return max(float(leaf.quantile(np.array([LARGEST_UNIFORM]))[0]) for _, leaf in leaves_of(law))
