"""Exponential, normal and gamma deviates by inversion, in operations that round the same on every processor.

One uniform makes one deviate, so the n-th junction of a block is always made of the n-th numbers of its streams. Only
+, -, *, / and sqrt are used (with exact scaling by powers of two): a library's log or ndtri changes bits between
processors and versions, and with them the whole run.

For a gamma deviate a uniform goes through the normal quantile z, and y(z) = ln(x / shape) through the polynomial of the
piece that z lies in. The polynomials are Taylor series of the quantile, computed at 80 digits and rounded once.
"""

import sys
from collections.abc import Iterator
from functools import lru_cache
from math import factorial
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact import plain_deviates
from rubnoise.contact.plain_deviates import LN2_HIGH, LN2_LOW, polynomial
from rubnoise.streams import LARGEST_UNIFORM

_PER_LN2 = float.fromhex("0x1.71547652b82fep+0")
_EXP_SERIES = tuple(1.0 / factorial(n) for n in range(2, 15))


def _has_compiler() -> bool:
    """Whether the compiler is loaded, as it is in a run; if not, numpy gives the same bits sooner."""
    return "numba" in sys.modules


def logarithm(x: Doubles) -> Doubles:
    """Return ln x for positive normal numbers, within 2 ulp."""
    if not _has_compiler():
        return plain_deviates.logarithms(np.ravel(x)).reshape(x.shape)
    from rubnoise.contact.compiled_deviates import logarithms

    result = np.empty(x.shape)
    logarithms(np.ravel(x), result.reshape(-1))
    return result


def antilogarithm(x: Doubles) -> Doubles:
    """Return e^x, within 1 ulp for -708 <= x <= 709; smaller x are taken as -708.

    x = k ln 2 + r with |r| <= ln 2 / 2, e^r by its series, and 2^k by exact scaling.
    """
    x = np.maximum(x, -708.0)
    power = np.rint(x * _PER_LN2)
    r = (x - power * LN2_HIGH) - power * LN2_LOW
    grown = 1.0 + (r + r * r * polynomial(_EXP_SERIES, r))
    return np.ldexp(grown, power.astype(np.int32))


def exponential(uniform: Doubles) -> Doubles:
    """Return deviates of unit mean, -ln(1 - u), from uniforms on [0, 1)."""
    deviates = logarithm(1.0 - uniform)
    return np.negative(deviates, out=deviates)


def normal_quantile(probability: Doubles) -> Doubles:
    """Return z with Phi(z) = p for p in (0, 1), relative error about 1e-15 (Wichura 1988, AS 241)."""
    if not _has_compiler():
        return plain_deviates.normal_quantiles(np.ravel(probability)).reshape(probability.shape)
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


_DIGITS = 80
_PIECES_PER_UNIT = 8  # the pieces are centred on multiples of 1/8
_REACH = 68  # centres to either side of 0: |z| <= 8.5, beyond the 8.21 that a 53-bit uniform reaches
_TERMS_KEPT = 13  # more of them, or pieces half as wide, change a deviate by its rounding alone
_TERMS_STEPPED = 30  # an error near the middle has grown by 1e16 in the tails; so have these, still without effect
_FAR = (0, 3, 6, 12, 24, 60, 200, 1000, 6000)  # panels, in standard deviations above the mean


def gamma_deviates(uniform: Doubles, shape: Any) -> Doubles:
    """Return gamma deviates of unit mean and a shape (an mpmath number), one for each uniform on [0, 1).

    x / shape = exp y(z), relative error below 1e-15 (1 + |y|), for 0.1 <= shape <= 1e24. Increasing in the uniform.
    """
    z = normal_above(uniform, 1.0)
    centre = np.rint(z * _PIECES_PER_UNIT)
    offset = z - centre / _PIECES_PER_UNIT
    coefficients = _table(shape)[centre.astype(np.int64) + _REACH].T
    y = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        y = y * offset + coefficient
    return antilogarithm(y)


def density_at_the_mean(shape: Any) -> Any:
    """Return the density of ln x at x = shape, shape^shape exp(-shape) / Gamma(shape), at the working precision."""
    import mpmath

    return mpmath.exp(shape * mpmath.log(shape) - shape - mpmath.loggamma(shape))


@lru_cache(maxsize=64)
def likely_range(shape: Any) -> tuple[float, float]:
    """Return x / shape below and above which less than 5e-17 of the law lies each.

    Chernoff's bound on either tail, P <= exp(-shape (r - 1 - ln r)), solved for r by Lambert's W on its two branches.
    """
    import mpmath

    with mpmath.workdps(_DIGITS):
        argument = -mpmath.exp(-1 - mpmath.log(2e16) / shape)
        low, high = (-mpmath.lambertw(argument, branch).real for branch in (0, -1))
        return float(low), float(high)


@lru_cache(maxsize=16)
def _table(shape: Any) -> Doubles:
    """Return the Taylor coefficients of y(z) about each centre, one row a centre, from low to high."""
    import mpmath

    with mpmath.workdps(_DIGITS):
        begin = _at_the_mean(shape)
        nearest = int(mpmath.nint(begin[0] * _PIECES_PER_UNIT))
        above = list(_rows(begin, range(nearest, _REACH + 1), shape))
        below = list(_rows(begin, range(nearest, -_REACH - 1, -1), shape))
    return np.array([*reversed(below[1:]), *above])


def _rows(point: tuple[Any, Any], centres: range, shape: Any) -> Iterator[list[float]]:
    """Step along the quantile from a point (z, y), centre by centre, and yield the coefficients about each."""
    import mpmath

    z, y = point
    series = _series(z, y, shape)
    for number in centres:
        centre = mpmath.mpf(number) / _PIECES_PER_UNIT
        y = mpmath.fdot(series, [(centre - z) ** n for n in range(len(series))])
        z, series = centre, _series(centre, y, shape)
        yield [float(c) for c in series[:_TERMS_KEPT]]


def _series(z: Any, y: Any, shape: Any) -> list[Any]:
    """Return the Taylor coefficients about z of the quantile that goes through (z, y).

    With e = exp y and p = y' = phi(z) / h(y), h the density of y, (ln p)' = -z - shape (1 - e) p and e' = e p.
    """
    import mpmath

    e = [mpmath.exp(y)]
    p = [mpmath.npdf(z) / _density(y, shape)]
    rate = []
    for n in range(_TERMS_STEPPED - 1):
        bend = shape * (p[n] - mpmath.fdot(e, p[::-1]))
        rate.append(-bend - (z if n == 0 else int(n == 1)))
        following = mpmath.fdot(p, rate[::-1]) / (n + 1)
        e.append(mpmath.fdot(e, p[::-1]) / (n + 1))
        p.append(following)
    return [y, *(c / (n + 1) for n, c in enumerate(p))]


def _density(y: Any, shape: Any) -> Any:
    """Return the density of y = ln(x / shape) for a gamma deviate x."""
    import mpmath

    return density_at_the_mean(shape) * mpmath.exp(shape * (y - mpmath.expm1(y)))


def _at_the_mean(shape: Any) -> tuple[Any, Any]:
    """Return z and y = 0 where x = shape, by quadrature of the density above it, which serves every shape alike."""
    import mpmath

    root = mpmath.sqrt(shape)

    def above(t: Any) -> Any:
        grown = t / root
        return mpmath.exp(-shape * (grown - mpmath.log(1 + grown))) / (1 + grown)

    mass_above = density_at_the_mean(shape) * mpmath.quad(above, _FAR) / root
    return mpmath.sqrt(2) * mpmath.erfinv(1 - 2 * mass_above), mpmath.mpf(0)
