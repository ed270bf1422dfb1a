"""The laws of sizes and strengths again, from their textbook densities and distribution functions, for the tests.

A `Textbook` shares no code with the law that it stands beside: `textbook(law)` reads nothing but its parameters.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import log, sqrt
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray
from scipy.special import gammainc, ndtr

from rubnoise.contact.laws import Exponential, Gamma, Lognormal, Normal, Power, Weibull

Doubles = NDArray[np.float64]
Distribution = Callable[[Doubles], Doubles]

KS_BOUND = 2.28
"""D sqrt(n) of Kolmogorov and Smirnov is larger with the probability of 4 standard deviations."""


def ks(values: Doubles, distribution: Distribution) -> float:
    """Return D sqrt(n) of a sample against a continuous distribution function."""
    n = values.size
    heights = distribution(np.sort(values))
    steps = np.arange(n + 1) / n
    return float(max(np.max(steps[1:] - heights), np.max(heights - steps[:-1])) * np.sqrt(n))


@dataclass(frozen=True)
class Textbook:
    """A law as books have it.

    density and tails take mpmath numbers: f(x), and P(X < x) with P(X > y). distribution and biased are those of f(x)
    and of x f(x) / E[x], for arrays. weight(n) are places in ln x between which all of x^n f(x) lies.
    """

    density: Callable[[Any], Any]
    tails: Callable[[Any, Any], tuple[Any, Any]]
    distribution: Distribution
    biased: Distribution
    weight: Callable[[int], tuple[Any, Any]]

    def moment(self, power: int) -> Any:
        """Return E[x^n] as the integral of x^n f(x), in ln x."""
        steps = mpmath.linspace(*self.weight(power), 12)
        return mpmath.quad(lambda t: mpmath.exp((power + 1) * t) * self.density(mpmath.exp(t)), steps)


def textbook(law: Any) -> Textbook:
    """Return the textbook's form of a law that has a density."""
    return _BOOKS[type(law)](law)


def _normal(law: Normal) -> Textbook:
    centre, std = law.centre, law.std
    start, mass = -centre / std, float(ndtr(centre / std))
    exact = mpmath.mpf(centre), mpmath.mpf(std), mpmath.ncdf(mpmath.mpf(centre) / std)

    def height(z: Doubles) -> Doubles:
        return np.exp(-0.5 * z * z) / sqrt(2.0 * np.pi)

    def first_moment(x: Doubles) -> Doubles:
        z = (x - centre) / std
        return centre * (ndtr(z) - ndtr(start)) - std * (height(z) - height(np.float64(start)))

    return Textbook(
        density=lambda x: mpmath.npdf((x - exact[0]) / exact[1]) / exact[1] / exact[2],
        tails=lambda x, y: (
            (mpmath.ncdf((x - exact[0]) / exact[1]) - mpmath.ncdf(-exact[0] / exact[1])) / exact[2],
            mpmath.ncdf((exact[0] - y) / exact[1]) / exact[2],
        ),
        distribution=lambda x: (ndtr((x - centre) / std) - ndtr(start)) / mass,
        biased=lambda x: first_moment(x) / first_moment(np.float64(centre + 40.0 * std)),
        weight=lambda n: (
            mpmath.log(max(centre - 14 * std, std * mpmath.mpf(10) ** (-40 / (n + 1)))),
            mpmath.log(centre + 16 * std),
        ),
    )


def _lognormal(law: Lognormal) -> Textbook:
    variance = log(1.0 + (law.std / law.mean) ** 2)
    centre = log(law.mean) - 0.5 * variance
    exact = mpmath.log(1 + (mpmath.mpf(law.std) / law.mean) ** 2)
    middle, width = mpmath.log(law.mean) - exact / 2, mpmath.sqrt(exact)
    return Textbook(
        density=lambda x: mpmath.npdf((mpmath.log(x) - middle) / width) / (x * width),
        tails=lambda x, y: (
            mpmath.ncdf((mpmath.log(x) - middle) / width),
            mpmath.ncdf((middle - mpmath.log(y)) / width),
        ),
        distribution=lambda x: ndtr((np.log(x) - centre) / sqrt(variance)),
        biased=lambda x: ndtr((np.log(x) - centre - variance) / sqrt(variance)),
        weight=lambda n: (middle + n * exact - 14 * width, middle + n * exact + 14 * width),
    )


def _gamma(law: Gamma | Exponential) -> Textbook:
    std = law.std if isinstance(law, Gamma) else law.mean
    order = (law.mean / std) ** 2
    shape = (mpmath.mpf(law.mean) / std) ** 2
    scale = mpmath.mpf(law.mean) / shape
    return Textbook(
        density=lambda x: (x / scale) ** (shape - 1) * mpmath.exp(-x / scale) / (mpmath.gamma(shape) * scale),
        tails=lambda x, y: (
            mpmath.gammainc(shape, 0, x / scale, regularized=True),
            mpmath.gammainc(shape, y / scale, mpmath.inf, regularized=True),
        ),
        distribution=lambda x: gammainc(order, order * x / law.mean),
        biased=lambda x: gammainc(order + 1.0, order * x / law.mean),
        weight=lambda n: (
            mpmath.log(law.mean) - 40 / (shape + n) - 1,
            mpmath.log(law.mean) + mpmath.log((100 + shape + 10 * mpmath.sqrt(shape)) / shape),
        ),
    )


def _weibull(law: Weibull) -> Textbook:
    variation = (mpmath.mpf(law.std) / law.mean) ** 2
    shape = mpmath.findroot(
        lambda k: mpmath.gamma(1 + 2 / k) / mpmath.gamma(1 + 1 / k) ** 2 - 1 - variation,
        (0.2, 500.0),
        solver="bisect",
        maxsteps=200,
    )
    scale = law.mean / mpmath.gamma(1 + 1 / shape)
    k, size = float(shape), float(scale)
    return Textbook(
        density=lambda x: shape / scale * (x / scale) ** (shape - 1) * mpmath.exp(-((x / scale) ** shape)),
        tails=lambda x, y: (-mpmath.expm1(-((x / scale) ** shape)), mpmath.exp(-((y / scale) ** shape))),
        distribution=lambda x: -np.expm1(-((x / size) ** k)),
        biased=lambda x: gammainc(1.0 + 1.0 / k, (x / size) ** k),
        weight=lambda n: (
            mpmath.log(scale) - 60 / (shape + n),
            mpmath.log(scale) + mpmath.log(100 + 4 * (1 + n / shape)) / shape,
        ),
    )


def _power(law: Power) -> Textbook:
    low, high = law.smallest, law.largest

    def partial(x: Any, power: float, logarithm: Callable[[Any], Any] = np.log) -> Any:
        """Return the integral of x^(power - exponent) from the smallest value to x, but for a factor."""
        rate = 1.0 + power - law.exponent
        return logarithm(x / low) if rate == 0.0 else ((x / low) ** rate - 1.0) / rate

    whole = partial(mpmath.mpf(high), 0.0, mpmath.log)
    return Textbook(
        density=lambda x: (x / low) ** (-mpmath.mpf(law.exponent)) / (low * whole),
        tails=lambda _x, _y: (mpmath.mpf(0), mpmath.mpf(0)),
        distribution=lambda x: partial(x, 0.0) / partial(high, 0.0),
        biased=lambda x: partial(x, 1.0) / partial(high, 1.0),
        weight=lambda _n: (mpmath.log(low), mpmath.log(high)),
    )


_BOOKS: dict[type, Callable[[Any], Textbook]] = {
    Normal: _normal,
    Lognormal: _lognormal,
    Exponential: _gamma,
    Gamma: _gamma,
    Weibull: _weibull,
    Power: _power,
}
