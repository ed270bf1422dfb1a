"""Logarithms and normal quantiles of arrays in numpy's own operations, with the bits of `compiled_deviates`.

They take some 40 ns for each number. To load the compiler takes as long as ten million of them, so what only counts the
births of a run, such as `rubnoise check`, does without it.
"""

import numpy as np

from rubnoise.arrays import Doubles

# ln 2 in two parts; the first has 32 trailing zero bits, so that exponent * HIGH is exact.
LN2_HIGH = float.fromhex("0x1.62e42feep-1")
LN2_LOW = float.fromhex("0x1.a39ef35793c76p-33")

ATANH_SERIES = tuple(1.0 / (2 * n + 1) for n in range(12))

# A double as whole number: its exponent stands above 52 bits of fraction, 1022 for those in [1/2, 1).
FRACTION = 2**52 - 1
HALF = 1022 << 52
SQRT_HALF = 0x3FE6A09E667F3BCD

# Wichura (1988), Algorithm AS 241 (PPND16), doi:10.2307/2347330: numerator and denominator by region.
CENTRE = (
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
SHOULDER = (
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
TAIL = (
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


def polynomial(coefficients: tuple[float, ...], x: Doubles) -> Doubles:
    """Evaluate c_0 + c_1 x + ... by Horner's rule."""
    value = coefficients[-1] * x
    value += coefficients[-2]
    for c in coefficients[-3::-1]:
        value *= x
        value += c
    return value


def _ratio(region: tuple[tuple[float, ...], tuple[float, ...]], x: Doubles) -> Doubles:
    return polynomial(region[0], x) / polynomial(region[1], x)


def logarithms(x: Doubles) -> Doubles:
    """Return ln x for a row of positive normal numbers, within 2 ulp.

    x = m 2^e with m in [sqrt(1/2), sqrt 2), ln m = 2 atanh f with f = (m - 1)/(m + 1), as a series in f^2 <= 0.0295.
    """
    bits = x.view(np.int64)
    within = bits & FRACTION | HALF
    low = (within < SQRT_HALF).astype(np.int64)
    power = ((bits >> 52) - 1022 - low).astype(np.float64)
    mantissa = (within + (low << 52)).view(np.float64)
    f = (mantissa - 1.0) / (mantissa + 1.0)
    series = 2.0 * f * polynomial(ATANH_SERIES, f * f)
    return power * LN2_HIGH + (series + power * LN2_LOW)


def normal_quantiles(probability: Doubles) -> Doubles:
    """Return z with Phi(z) = p for a row of p in (0, 1)."""
    q = probability - 0.5
    result = q * _ratio(CENTRE, 0.180625 - q * q)
    outer = np.flatnonzero(np.abs(q) > 0.425)
    p = probability[outer]
    r = np.sqrt(-logarithms(np.minimum(p, 1.0 - p)))
    size = _ratio(SHOULDER, r - 1.6)
    far = r > 5.0
    size[far] = _ratio(TAIL, r[far] - 5.0)
    result[outer] = np.where(p < 0.5, -size, size)
    return result
