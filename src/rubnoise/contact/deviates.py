"""Exponential and normal deviates by inversion, in operations that round the same on every processor.

One uniform makes one deviate, so the n-th junction of a block is always made of the n-th numbers of its streams. Only
+, -, *, / and sqrt are used (with exact scaling by powers of two): a library's log or ndtri changes bits between
processors and versions, and with them the whole run.
"""

from math import factorial

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

# ln 2 in two parts; the first has 32 trailing zero bits, so that exponent * HIGH is exact.
_LN2_HIGH = float.fromhex("0x1.62e42feep-1")
_LN2_LOW = float.fromhex("0x1.a39ef35793c76p-33")
_SQRT_HALF = float.fromhex("0x1.6a09e667f3bcdp-1")
_ATANH_SERIES = tuple(1.0 / (2 * n + 1) for n in range(12))
_PER_LN2 = float.fromhex("0x1.71547652b82fep+0")
_EXP_SERIES = tuple(1.0 / factorial(n) for n in range(2, 15))

_LARGEST_BELOW_ONE = 1.0 - 2.0**-53


def _polynomial(coefficients: tuple[float, ...], x: Doubles) -> Doubles:
    """Evaluate c_0 + c_1 x + ... by Horner's rule."""
    value = coefficients[-1] * x
    value += coefficients[-2]
    for c in coefficients[-3::-1]:
        value *= x
        value += c
    return value


def logarithm(x: Doubles) -> Doubles:
    """Return ln x for positive normal numbers, within 2 ulp.

    x = m 2^e with m in [sqrt(1/2), sqrt 2), ln m = 2 atanh f with f = (m - 1)/(m + 1), as a series in f^2 <= 0.0295.
    """
    mantissa, exponent = np.frexp(x)
    low = mantissa < _SQRT_HALF
    mantissa = np.where(low, 2.0 * mantissa, mantissa)
    power = (exponent - low).astype(np.float64)
    f = (mantissa - 1.0) / (mantissa + 1.0)
    series = 2.0 * f * _polynomial(_ATANH_SERIES, f * f)
    return power * _LN2_HIGH + (series + power * _LN2_LOW)


def antilogarithm(x: Doubles) -> Doubles:
    """Return e^x, within 1 ulp where -708 <= x <= 709; smaller x are taken as -708.

    x = k ln 2 + r with |r| <= ln 2 / 2, e^r by its series, and 2^k by exact scaling.
    """
    x = np.maximum(x, -708.0)
    power = np.rint(x * _PER_LN2)
    r = (x - power * _LN2_HIGH) - power * _LN2_LOW
    grown = 1.0 + (r + r * r * _polynomial(_EXP_SERIES, r))
    return np.ldexp(grown, power.astype(np.int32))


def exponential(uniform: Doubles) -> Doubles:
    """Return deviates of unit mean, -ln(1 - u), from uniforms on [0, 1)."""
    return -logarithm(1.0 - uniform)


# Wichura (1988), Algorithm AS 241 (PPND16), doi:10.2307/2347330: numerator and denominator by region.
_CENTRE = (
    (
        3.3871328727963666080e0,
        1.3314166789178437745e2,
        1.9715909503065514427e3,
        1.3731693765509461125e4,
        4.5921953931549871457e4,
        6.7265770927008700853e4,
        3.3430575583588128105e4,
        2.5090809287301226727e3,
    ),
    (
        1.0,
        4.2313330701600911252e1,
        6.8718700749205790830e2,
        5.3941960214247511077e3,
        2.1213794301586595867e4,
        3.9307895800092710610e4,
        2.8729085735721942674e4,
        5.2264952788528545610e3,
    ),
)
_SHOULDER = (
    (
        1.42343711074968357734e0,
        4.63033784615654529590e0,
        5.76949722146069140550e0,
        3.64784832476320460504e0,
        1.27045825245236838258e0,
        2.41780725177450611770e-1,
        2.27238449892691845833e-2,
        7.74545014278341407640e-4,
    ),
    (
        1.0,
        2.05319162663775882187e0,
        1.67638483018380384940e0,
        6.89767334985100004550e-1,
        1.48103976427480074590e-1,
        1.51986665636164571966e-2,
        5.47593808499534494600e-4,
        1.05075007164441684324e-9,
    ),
)
_TAIL = (
    (
        6.65790464350110377720e0,
        5.46378491116411436990e0,
        1.78482653991729133580e0,
        2.96560571828504891230e-1,
        2.65321895265761230930e-2,
        1.24266094738807843860e-3,
        2.71155556874348757815e-5,
        2.01033439929228813265e-7,
    ),
    (
        1.0,
        5.99832206555887937690e-1,
        1.36929880922735805310e-1,
        1.48753612908506148525e-2,
        7.86869131145613259100e-4,
        1.84631831751005468180e-5,
        1.42151175831644588870e-7,
        2.04426310338993978564e-15,
    ),
)


def _ratio(region: tuple[tuple[float, ...], tuple[float, ...]], x: Doubles) -> Doubles:
    return _polynomial(region[0], x) / _polynomial(region[1], x)


def normal_quantile(probability: Doubles) -> Doubles:
    """Return z with Phi(z) = p for p in (0, 1), relative error about 1e-15 (Wichura 1988, AS 241)."""
    q = probability - 0.5
    z = q * _ratio(_CENTRE, 0.180625 - q * q)
    outer = np.flatnonzero(np.abs(q) > 0.425)
    if outer.size:
        smaller = np.minimum(probability[outer], 1.0 - probability[outer])
        r = np.sqrt(-logarithm(smaller))
        size = np.where(r <= 5.0, _ratio(_SHOULDER, r - 1.6), _ratio(_TAIL, r - 5.0))
        z[outer] = np.where(q[outer] < 0.0, -size, size)
    return z


def normal_above(uniform: Doubles, mass_above: float) -> Doubles:
    """Return standard normal deviates conditioned on exceeding the point that leaves ``mass_above`` above it.

    z = -Phi^-1((1 - u) * mass_above): the law of drawing again until the bound is passed, from one uniform each.
    """
    return -normal_quantile(np.minimum((1.0 - uniform) * mass_above, _LARGEST_BELOW_ONE))
