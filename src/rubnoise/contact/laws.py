"""The laws of positive quantities: how large junctions are, in um, and how strong, in MPa.

Each law is one class and one entry of `LAWS`, from which scenario keys, calibration, schema and docs read. A value is
drawn from one uniform by inversion, in operations that round the same on every processor.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import factorial
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import antilogarithm, exponential, logarithm, normal_above
from rubnoise.contact.gamma_deviates import density_at_the_mean, gamma_deviates, likely_range
from rubnoise.streams import LARGEST_UNIFORM

Doubles = NDArray[np.float64]

WIDEST: Final = 3.0
"""Standard deviation over mean up to which laws with a long tail are drawn: gamma deviates lose digits beyond it."""

# Values below this part of the mean, which a uniform of 0 or a steep law can make, become it: a junction needs an
# extent to divide by, and its square and fifth power may not vanish. No moment notices.
_LEAST = 2.0**-100


class Law(Protocol):
    """A law of a positive quantity x, in whatever unit its parameters have."""

    @property
    def mean(self) -> float:
        """E[x]."""
        ...

    def moment(self, power: int) -> float:
        """Return E[x^n], exact for the law as it is drawn."""
        ...

    def density(self, value: Doubles) -> Doubles:
        """Return the probability density of the continuous part, in one over the unit of x."""
        ...

    @property
    def support(self) -> tuple[float, float]:
        """Values outside which less than 1e-16 of the law lies; equal ends mean a single value."""
        ...

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        ...

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): diameters of junctions alive at a random place."""
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
        """Return E[x^n], rounded once: a library's pow changes bits between processors."""
        return float(Fraction(self.value) ** power)

    def density(self, value: Doubles) -> Doubles:
        """Return zeros: a single value has no continuous part."""
        return np.zeros_like(value)

    @property
    def support(self) -> tuple[float, float]:
        """The value, twice."""
        return self.value, self.value

    def draw(self, uniform: Doubles) -> Doubles:
        """Return the value for each uniform."""
        return np.full(uniform.shape, self.value)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return the value ``count`` times: one size is not biased by its length."""
        del generator
        return np.full(count, self.value)


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
        return _rounded(normal_moment, self.centre, self.std, power)

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
        return _rounded(lognormal_moment, self.mean, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 where x is not positive."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Exponential:
    """A law of density exp(-x / mean) / mean, whose standard deviation is its mean: E[x^n] = n! mean^n."""

    mean: float

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return float(factorial(power) * Fraction(self.mean) ** power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 where x is not positive."""
        return np.where(value > 0.0, np.exp(-np.maximum(value, 0.0) / self.mean) / self.mean, 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with 5e-17 of the law below and above them. Averages of x^n have weight beyond it."""
        return 5e-17 * self.mean, 37.54 * self.mean

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        return self.mean * np.maximum(exponential(uniform), _LEAST)

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
        return _rounded(gamma_moment, self.mean, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 where x is not positive."""
        height, shape = _height_and_shape(self.mean, self.std)
        ratio = np.where(value > 0.0, value / self.mean, 1.0)
        below_peak = shape * (np.log(ratio) - (ratio - 1.0))
        return np.where(value > 0.0, height * np.exp(below_peak) / (ratio * self.mean), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with less than 5e-17 of the law below and above them. Averages of x^n have weight beyond."""
        low, high = likely_range(_gamma_shape(self.mean, self.std))
        return self.mean * max(low, _LEAST), self.mean * high

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        return self.mean * np.maximum(gamma_deviates(uniform, _gamma_shape(self.mean, self.std)), _LEAST)

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Weibull:
    """A Weibull law with its mean and standard deviation given.

    P(X > x) = exp(-(x / scale)^shape); the shape solves Gamma(1 + 2/shape) / Gamma(1 + 1/shape)^2 = 1 + (std/mean)^2.
    Moments: E[x^n] = scale^n Gamma(1 + n/shape), scale = mean / Gamma(1 + 1/shape).
    """

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once."""
        return _rounded(weibull_moment, self.mean, self.std, power)

    def density(self, value: Doubles) -> Doubles:
        """Return the density; 0 where x is not positive."""
        scale, exponent = self._scale_and_exponent
        x = np.where(value > 0.0, value / scale, 1.0)
        grown = x ** (1.0 / exponent)
        return np.where(value > 0.0, grown * np.exp(-grown) / (exponent * scale * x), 0.0)

    @property
    def support(self) -> tuple[float, float]:
        """Values with 5e-17 of the law below and above them. Averages of x^n have weight beyond it."""
        scale, exponent = self._scale_and_exponent
        return scale * 5e-17**exponent, scale * 37.54**exponent

    @property
    def _scale_and_exponent(self) -> tuple[float, float]:
        return _scale_and_exponent(self.mean, self.std)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1): scale times an exponential deviate^(1/shape)."""
        scale, exponent = self._scale_and_exponent
        # A uniform of 0 is a value of 0, which has no logarithm: it stands for the lower half of its interval.
        deviate = np.maximum(exponential(uniform), 2.0**-54)
        return scale * antilogarithm(exponent * logarithm(deviate))

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): (x / scale)^shape is then gamma of shape 1 + 1/shape."""
        scale, exponent = self._scale_and_exponent
        shape = 1 + _weibull_exponent(self.mean, self.std)
        return scale * antilogarithm(
            exponent * logarithm(float(shape) * gamma_deviates(generator.random(count), shape))
        )


def weibull_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[x^n] of the Weibull law, mpmath numbers in and out, at the working precision up to 60 digits."""
    import mpmath

    exponent = _weibull_exponent(mean, std)
    return (mean / mpmath.gamma(1 + exponent)) ** power * mpmath.gamma(1 + power * exponent)


@lru_cache(maxsize=256)
def _weibull_exponent(mean: Any, std: Any) -> Any:
    """Return 1/shape of the Weibull law, an mpmath number good to 50 digits."""
    import mpmath

    def excess(exponent: Any) -> Any:
        growth = mpmath.loggamma(1 + 2 * exponent) - 2 * mpmath.loggamma(1 + exponent)
        return mpmath.sqrt(mpmath.expm1(growth)) / variation - 1

    with mpmath.workdps(120):
        variation = mpmath.mpf(std) / mean
        return mpmath.findroot(excess, (variation / 3, 2 * variation), solver="anderson")


@lru_cache(maxsize=64)
def _scale_and_exponent(mean: float, std: float) -> tuple[float, float]:
    import mpmath

    with mpmath.workdps(60):
        exponent = _weibull_exponent(mean, std)
        return float(mean / mpmath.gamma(1 + exponent)), float(exponent)


@dataclass(frozen=True, slots=True, kw_only=True)
class Power:
    """A law of density proportional to x^-exponent between two values, as contact spots of fractal surfaces have it.

    With q = 1 - exponent and L = ln(largest / smallest), x = smallest exp(L y) with y = ln(1 + u (exp(q L) - 1))/(q L)
    for a uniform u, and y = u where q = 0. Moments: E[x^n] = smallest^n g((q + n) L) / g(q L), g(z) = (exp z - 1)/z.
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
        """The smallest and the largest value; there is nothing outside."""
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
    """Return E[x^n] of the bounded power law, mpmath numbers in and out, at the working precision."""
    import mpmath

    log_ratio = mpmath.log(largest / smallest)

    def mean_growth(rate: Any) -> Any:
        return mpmath.expm1(rate * log_ratio) / (rate * log_ratio) if rate else mpmath.mpf(1)

    return smallest**power * mean_growth(1 - exponent + power) / mean_growth(1 - exponent)


@lru_cache(maxsize=256)
def _rounded_power_moment(exponent: float, smallest: float, largest: float, power: int) -> float:
    import mpmath

    with mpmath.workdps(60):
        return float(power_moment(*map(mpmath.mpf, (exponent, smallest, largest)), power))


@lru_cache(maxsize=64)
def _power_constants(exponent: float, smallest: float, largest: float) -> tuple[float, float, float]:
    """Return L = ln(largest / smallest), exp(q L) - 1 and the density at the smallest value, rounded once."""
    import mpmath

    with mpmath.workdps(60):
        low, rate = mpmath.mpf(smallest), 1 - mpmath.mpf(exponent)
        log_ratio = mpmath.log(mpmath.mpf(largest) / low)
        growth = mpmath.expm1(rate * log_ratio)
        return float(log_ratio), float(growth), float(1 / (low * (growth / rate if rate else log_ratio)))


@lru_cache(maxsize=256)
def _rounded(moment: Callable[[Any, Any, int], Any], mean: float, std: float, power: int) -> float:
    """Return a moment of a law with a mean and a standard deviation, at 60 digits rounded once."""
    import mpmath

    with mpmath.workdps(60):
        return float(moment(mpmath.mpf(mean), mpmath.mpf(std), power))


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A number of its own that a law takes, under a key of its own beside `law`: its bounds and an ordinary value."""

    name: str
    about: str
    low: float
    high: float
    sample: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Which law a quantity follows about a centre, and how widely: what a scenario says apart from the centre itself.

    The standard deviation is absolute, in the unit of the centre, or ``relative``, a part of it; neither is one value.
    Of the normal law it is that before drawing again. ``parameters`` are the law's own, by name.
    """

    absolute: float | None = None
    relative: float | None = None
    law: str = "normal"
    parameters: tuple[tuple[str, float], ...] = ()

    @property
    def entry(self) -> "Entry":
        """The law's entry in the registry; that of one value where there is no spread."""
        entry = LAWS[self.law]
        return entry if self.absolute or self.relative or not entry.takes_spread else LAWS["fixed"]

    def std(self, centre: float) -> float:
        """Return the standard deviation about a centre as given; 0 where the law takes none."""
        return self.relative * centre if self.relative is not None else self.absolute or 0.0

    def moment(self, centre: Any, power: int) -> Any:
        """Return E[x^n] about a centre, mpmath numbers in and out, at the working precision."""
        import mpmath

        std = mpmath.mpf(self.absolute) if self.absolute else mpmath.mpf(self.relative or 0) * centre
        return self.entry.moment(centre, std, dict(self.parameters), power)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A law of the registry: its name in scenarios, what a page says of it, the keys it takes, and how it is made.

    ``make`` takes centre, standard deviation and the law's own parameters and returns the law; ``moment`` returns
    E[x^n] of the same with mpmath numbers. Parameters named in ``ascending`` have to grow in this order.
    ``with_spread`` names the law to advise where this one is given a spread.
    """

    name: str
    about: str
    make: Callable[[float, float, dict[str, float]], Law]
    moment: Callable[[Any, Any, dict[str, float], int], Any]
    parameters: tuple[Parameter, ...] = ()
    ascending: tuple[str, ...] = ()
    takes_spread: bool = True
    widest: float = WIDEST
    with_spread: str = ""


def law_for(centre: float, spread: Spread) -> Law:
    """Return the law of a quantity about a centre: a diameter's about d_m in um, a strength's about psi in MPa."""
    return spread.entry.make(centre, spread.std(centre), dict(spread.parameters))


def _scaled_power(centre: float, exponent: float, smallest: float, largest: float) -> Power:
    return Power(exponent=exponent, smallest=smallest * centre, largest=largest * centre)


def _unit_power_moment(power: int, exponent: float, smallest: float, largest: float) -> Any:
    import mpmath

    return power_moment(mpmath.mpf(exponent), mpmath.mpf(smallest), mpmath.mpf(largest), power)


LAWS: Final[dict[str, Entry]] = {
    entry.name: entry
    for entry in (
        Entry(
            name="fixed",
            about="one value",
            make=lambda centre, _std, _own: Fixed(value=centre),
            moment=lambda centre, _std, _own, n: centre**n,
            takes_spread=False,
            with_spread="normal",
        ),
        Entry(
            name="normal",
            about="redrawn while not positive",
            make=lambda centre, std, _own: Normal(centre=centre, std=std),
            moment=lambda centre, std, _own, n: normal_moment(centre, std, n),
            widest=float("inf"),
        ),
        Entry(
            name="lognormal",
            about="a normal logarithm",
            make=lambda centre, std, _own: Lognormal(mean=centre, std=std),
            moment=lambda centre, std, _own, n: lognormal_moment(centre, std, n),
        ),
        Entry(
            name="exponential",
            about="a standard deviation equal to the mean",
            make=lambda centre, _std, _own: Exponential(mean=centre),
            moment=lambda centre, _std, _own, n: factorial(n) * centre**n,
            takes_spread=False,
            with_spread="gamma",
        ),
        Entry(
            name="gamma",
            about="an exponential tail",
            make=lambda centre, std, _own: Gamma(mean=centre, std=std),
            moment=lambda centre, std, _own, n: gamma_moment(centre, std, n),
        ),
        Entry(
            name="weibull",
            about="as the weakest of many has it",
            make=lambda centre, std, _own: Weibull(mean=centre, std=std),
            moment=lambda centre, std, _own, n: weibull_moment(centre, std, n),
        ),
        Entry(
            name="power",
            about="density ~ x^-exponent between smallest and largest",
            make=lambda centre, _std, own: _scaled_power(centre, **own),
            moment=lambda centre, _std, own, n: centre**n * _unit_power_moment(n, **own),
            parameters=(
                Parameter(name="exponent", about="Fall of the density ~ x^-exponent", low=-10.0, high=10.0, sample=2.5),
                Parameter(name="smallest", about="Smallest value over {centre}", low=1e-3, high=1e3, sample=0.5),
                Parameter(name="largest", about="Largest value over {centre}", low=1e-3, high=1e3, sample=4.0),
            ),
            ascending=("smallest", "largest"),
            takes_spread=False,
            with_spread="lognormal",
        ),
    )
}
"""Every law by its name in a scenario."""
