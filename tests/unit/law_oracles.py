"""The laws of sizes and strengths again, from their textbook distribution functions and densities, for the tests.

Each is of a mean and a standard deviation; densities are for mpmath, distribution functions for arrays.
"""

from collections.abc import Callable
from math import log, sqrt
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray
from scipy.special import gammainc, ndtr

Doubles = NDArray[np.float64]

KS_BOUND = 2.28
"""D sqrt(n) of Kolmogorov and Smirnov is larger with the probability of 4 standard deviations."""


def ks(values: Doubles, distribution: Callable[[Doubles], Doubles]) -> float:
    """Return D sqrt(n) of a sample against a continuous distribution function."""
    n = values.size
    heights = distribution(np.sort(values))
    steps = np.arange(n + 1) / n
    return float(max(np.max(steps[1:] - heights), np.max(heights - steps[:-1])) * np.sqrt(n))


def normal(mean: float, std: float) -> Callable[[Doubles], Doubles]:
    below = ndtr(-mean / std)
    return lambda x: (ndtr((x - mean) / std) - below) / (1.0 - below)


def lognormal(mean: float, std: float, biased: int = 0) -> Callable[[Doubles], Doubles]:
    """Return the distribution function of the law weighed by x^biased."""
    variance = log(1.0 + (std / mean) ** 2)
    centre = log(mean) - 0.5 * variance + biased * variance
    return lambda x: ndtr((np.log(x) - centre) / sqrt(variance))


def gamma(mean: float, std: float, biased: int = 0) -> Callable[[Doubles], Doubles]:
    """Return the distribution function of the law weighed by x^biased."""
    shape = (mean / std) ** 2
    return lambda x: gammainc(shape + biased, shape * x / mean)


def weibull(mean: float, std: float) -> Callable[[Doubles], Doubles]:
    shape, scale = map(float, _weibull_shape_and_scale(mean, std))
    return lambda x: -np.expm1(-((x / scale) ** shape))


def _weibull_shape_and_scale(mean: float, std: float) -> tuple[Any, Any]:
    """Return the shape that gives the coefficient of variation, by bisection, and the scale."""
    variation = (mpmath.mpf(std) / mean) ** 2
    shape = mpmath.findroot(
        lambda k: mpmath.gamma(1 + 2 / k) / mpmath.gamma(1 + 1 / k) ** 2 - 1 - variation,
        (0.2, 500.0),
        solver="bisect",
        maxsteps=200,
    )
    return shape, mean / mpmath.gamma(1 + 1 / shape)


def lognormal_density(mean: float, std: float) -> Callable[[Any], Any]:
    variance = mpmath.log(1 + (mpmath.mpf(std) / mean) ** 2)
    centre = mpmath.log(mean) - variance / 2
    return lambda x: mpmath.npdf((mpmath.log(x) - centre) / mpmath.sqrt(variance)) / (x * mpmath.sqrt(variance))


def gamma_density(mean: float, std: float) -> Callable[[Any], Any]:
    shape = (mpmath.mpf(mean) / std) ** 2
    scale = mpmath.mpf(mean) / shape
    return lambda x: (x / scale) ** (shape - 1) * mpmath.exp(-x / scale) / (mpmath.gamma(shape) * scale)


def lognormal_moment(mean: float, std: float, power: int) -> Any:
    """Return E[x^n] by quadrature; weighing by x^n moves ln x by n times its variance."""
    variance = mpmath.log(1 + (mpmath.mpf(std) / mean) ** 2)
    centre, width = mpmath.log(mean) + (power - 0.5) * variance, 14 * mpmath.sqrt(variance)
    return _moment(lognormal_density(mean, std), power, centre - width, centre + width)


def gamma_moment(mean: float, std: float, power: int) -> Any:
    """Return E[x^n] by quadrature; below the mean the integrand falls like x^(shape + n), above it exponentially."""
    shape = (mpmath.mpf(mean) / std) ** 2
    low = mpmath.log(mean) - 40 / (shape + power) - 1
    high = mpmath.log(mean) + mpmath.log((100 + shape + 10 * mpmath.sqrt(shape)) / shape)
    return _moment(gamma_density(mean, std), power, low, high)


def _moment(density: Callable[[Any], Any], power: int, low: Any, high: Any) -> Any:
    """Return the integral of x^power times the density, in t = ln x."""
    steps = mpmath.linspace(low, high, 25)
    return mpmath.quad(lambda t: mpmath.exp((power + 1) * t) * density(mpmath.exp(t)), steps)


def weibull_moment(mean: float, std: float, power: int) -> Any:
    """Return E[x^n] by quadrature over y = (x/scale)^shape, of density exp(-y), in ln y."""
    shape, scale = _weibull_shape_and_scale(mean, std)
    rise = 1 + power / shape
    steps = mpmath.linspace(-60 / rise, mpmath.log(100 + 4 * rise), 25)
    return scale**power * mpmath.quad(lambda t: mpmath.exp(rise * t - mpmath.exp(t)), steps)


def normal_moment(mean: float, std: float, power: int) -> Any:
    """Return E[x^n | x > 0] by quadrature over z."""
    steps = mpmath.linspace(mpmath.mpf(-mean) / std, 14, 25)
    mass, moment = (mpmath.quad(lambda z, n=n: (mean + std * z) ** n * mpmath.npdf(z), steps) for n in (0, power))
    return moment / mass
