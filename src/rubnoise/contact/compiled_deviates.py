"""The compiled heart of deviates by inversion: logarithms and normal quantiles of whole arrays.

Every step rounds as written here, so that the bits are equal on every processor.
"""

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, inlined
from rubnoise.contact.plain_deviates import (
    ATANH_SERIES,
    CENTRE,
    FRACTION,
    HALF,
    LN2_HIGH,
    LN2_LOW,
    SHOULDER,
    SQRT_HALF,
    TAIL,
)


@inlined
def _polynomial(coefficients: tuple[float, ...], x: float) -> float:
    """Evaluate c_0 + c_1 x + ... by Horner's rule."""
    value = coefficients[-1]
    for n in range(len(coefficients) - 2, -1, -1):
        value = value * x + coefficients[n]
    return value


@inlined
def _ratio(region: tuple[tuple[float, ...], tuple[float, ...]], x: float) -> float:
    return _polynomial(region[0], x) / _polynomial(region[1], x)


@compiled
def logarithms(x: Doubles, result: Doubles) -> None:
    """Fill in ln x for positive normal numbers, within 2 ulp; both arrays are of one dimension.

    x = m 2^e with m in [sqrt(1/2), sqrt 2), ln m = 2 atanh f with f = (m - 1)/(m + 1), as a series in f^2 <= 0.0295.
    """
    bits = x.view(np.int64)
    fraction = np.empty(len(x), np.int64)
    power = np.empty(len(x))
    for n in range(len(x)):
        within = bits[n] & FRACTION | HALF
        low = np.int64(within < SQRT_HALF)
        fraction[n] = within + (low << 52)
        power[n] = float((bits[n] >> 52) - 1022 - low)
    mantissa = fraction.view(np.float64)
    for n in range(len(x)):
        f = (mantissa[n] - 1.0) / (mantissa[n] + 1.0)
        series = 2.0 * f * _polynomial(ATANH_SERIES, f * f)
        result[n] = power[n] * LN2_HIGH + (series + power[n] * LN2_LOW)


@compiled
def normal_quantiles(probability: Doubles, result: Doubles) -> None:
    """Fill in z with Phi(z) = p for p in (0, 1); both arrays are of one dimension."""
    for n in range(len(probability)):
        q = probability[n] - 0.5
        result[n] = q * _ratio(CENTRE, 0.180625 - q * q)
    outer = np.empty(len(probability), np.int64)
    count = 0
    for n in range(len(probability)):
        outer[count] = n
        count += abs(probability[n] - 0.5) > 0.425
    size = np.empty(count)
    for k in range(count):
        p = probability[outer[k]]
        size[k] = min(p, 1.0 - p)
    r = np.empty(count)
    logarithms(size, r)
    for k in range(count):
        r[k] = np.sqrt(-r[k])
        size[k] = _ratio(SHOULDER, r[k] - 1.6)
    for k in range(count):
        if r[k] > 5.0:
            size[k] = _ratio(TAIL, r[k] - 5.0)
        result[outer[k]] = -size[k] if probability[outer[k]] < 0.5 else size[k]
