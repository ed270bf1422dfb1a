"""Exponential and normal deviates by inversion, in operations that round the same on every processor.

One uniform makes one deviate, so the n-th junction of a block is always made of the n-th numbers of its streams. Only
+, -, *, / and sqrt are used (with exact scaling by powers of two): a library's log or ndtri changes bits between
processors and versions, and with them the whole run.
"""

from math import factorial

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.streams import LARGEST_UNIFORM

_PER_LN2 = float.fromhex("0x1.71547652b82fep+0")
_EXP_SERIES = tuple(1.0 / factorial(n) for n in range(2, 15))


def _polynomial(coefficients: tuple[float, ...], x: Doubles) -> Doubles:
    """Evaluate c_0 + c_1 x + ... by Horner's rule."""
    value = coefficients[-1] * x
    value += coefficients[-2]
    for c in coefficients[-3::-1]:
        value *= x
        value += c
    return value


def logarithm(x: Doubles) -> Doubles:
    """Return ln x for positive normal numbers, within 2 ulp."""
    # Only who draws waits for the compiler to be loaded, and no one who asks theory.
    from rubnoise.contact.compiled_deviates import logarithms

    result = np.empty(x.shape)
    logarithms(np.ravel(x), result.reshape(-1))
    return result


def antilogarithm(x: Doubles) -> Doubles:
    """Return e^x, within 1 ulp where -708 <= x <= 709; smaller x are taken as -708.

    x = k ln 2 + r with |r| <= ln 2 / 2, e^r by its series, and 2^k by exact scaling.
    """
    from rubnoise.contact.compiled_deviates import LN2_HIGH, LN2_LOW

    x = np.maximum(x, -708.0)
    power = np.rint(x * _PER_LN2)
    r = (x - power * LN2_HIGH) - power * LN2_LOW
    grown = 1.0 + (r + r * r * _polynomial(_EXP_SERIES, r))
    return np.ldexp(grown, power.astype(np.int32))


def exponential(uniform: Doubles) -> Doubles:
    """Return deviates of unit mean, -ln(1 - u), from uniforms on [0, 1)."""
    deviates = logarithm(1.0 - uniform)
    return np.negative(deviates, out=deviates)


def normal_quantile(probability: Doubles) -> Doubles:
    """Return z with Phi(z) = p for p in (0, 1), relative error about 1e-15 (Wichura 1988, AS 241)."""
    from rubnoise.contact.compiled_deviates import normal_quantiles

    result = np.empty(probability.shape)
    normal_quantiles(np.ravel(probability), result.reshape(-1))
    return result


def normal_above(uniform: Doubles, mass_above: float) -> Doubles:
    """Return standard normal deviates conditioned on exceeding the point that leaves ``mass_above`` above it.

    z = -Phi^-1((1 - u) * mass_above): the law of drawing again until the bound is passed, from one uniform each.
    """
    above = 1.0 - uniform
    above *= mass_above
    deviates = normal_quantile(np.minimum(above, LARGEST_UNIFORM, out=above))
    return np.negative(deviates, out=deviates)
