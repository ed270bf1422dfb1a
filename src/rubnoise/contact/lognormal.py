"""The lognormal law of a positive quantity with a given mean and standard deviation, whatever its unit."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import antilogarithm, normal_above

Doubles = NDArray[np.float64]


def lognormal_moment(mean: Any, std: Any, power: int) -> Any:
    """Return E[x^n] = mean^n (1 + (std/mean)^2)^(n(n-1)/2), mpmath numbers in and out, at the working precision."""
    return mean**power * (1 + (std / mean) ** 2) ** (power * (power - 1) // 2)


@lru_cache(maxsize=256)
def rounded_lognormal_moment(mean: float, std: float, power: int) -> float:
    """Return E[x^n], rounded once."""
    import mpmath

    with mpmath.workdps(40):
        return float(lognormal_moment(mpmath.mpf(mean), mpmath.mpf(std), power))


@lru_cache(maxsize=64)
def median_and_log_std(mean: float, std: float) -> tuple[float, float]:
    """Return the median, mean / sqrt(1 + cv^2), and the standard deviation of ln x, sqrt(ln(1 + cv^2)); cv = std/mean.

    At 40 digits and rounded once.
    """
    import mpmath

    with mpmath.workdps(40):
        variation = (mpmath.mpf(std) / mean) ** 2
        return float(mean / mpmath.sqrt(1 + variation)), float(mpmath.sqrt(mpmath.log1p(variation)))


def lognormal_deviates(uniform: Doubles, mean: float, std: float) -> Doubles:
    """Return one deviate for each uniform on [0, 1): the median times e^(z times the standard deviation of ln x)."""
    median, log_std = median_and_log_std(mean, std)
    return median * antilogarithm(log_std * normal_above(uniform, 1.0))
