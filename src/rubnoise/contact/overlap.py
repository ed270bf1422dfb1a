"""The overlap of two circles sliding over each other: the area of one junction through its life."""

from fractions import Fraction
from functools import cache
from math import comb

import numpy as np
from numpy.typing import ArrayLike, NDArray


def junction_area(distance_since_birth: ArrayLike, diameter: ArrayLike) -> NDArray[np.float64]:
    """Return the area of a junction at a sliding distance after its birth.

    A(s; d) = d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2), x = |d - s|, for 0 <= s <= 2d, and 0 outside (um^2; s, d in um; the
    arguments broadcast). Paper Eq. (2) with segments of height s/2; Eq. (3) as printed adds a length^2 to a length^3
    under its root and cannot be used.
    """
    d = np.asarray(diameter, dtype=np.float64)
    x = np.minimum(np.abs(d - np.asarray(distance_since_birth, dtype=np.float64)), d)
    return 0.5 * (d * d * np.arccos(x / d) - x * np.sqrt((d - x) * (d + x)))


def max_area(diameter: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return A_jmax = pi d^2 / 4, the area at full overlap, in um^2 (paper Eq. 4)."""
    return 0.25 * np.pi * diameter * diameter


@cache
def life_integral(power: int) -> float:
    """Return c_n, where the integral of A^n over a life is c_n d^(2n+1).

    c_n = 2 int_0^(pi/2) a^n sin theta d theta, a = (theta - sin theta cos theta)/2  (s = d (1 - cos theta)), is a
    polynomial in a(pi/2) = pi/4 with rational coefficients, here summed exactly and rounded once: c_1 = 2/3 and
    c_2 = pi/3 - 32/45.
    """
    import mpmath

    with mpmath.workdps(50):
        quarter = mpmath.pi / 4
        terms = enumerate(_sine_integral(power, 1))
        return float(2 * mpmath.fsum(mpmath.mpf(c.numerator) / c.denominator * quarter**n for n, c in terms))


@cache
def _sine_integral(power: int, sines: int) -> tuple[Fraction, ...]:
    """Return int_0^(pi/2) a^n sin^p theta d theta, p odd, as coefficients of the powers of a(pi/2).

    Twice by parts, with a' = sin^2: sin^p goes over into odd powers of cos, these times sin^2 into odd powers of sin,
    which leave a boundary term and the same integral with n - 2.
    """
    half, total = (sines - 1) // 2, [Fraction(0)] * (power + 1)
    for k in range(half + 1):
        outer = Fraction(_signed(half, k), 2 * k + 1)
        if power == 0:
            total[0] += outer
            continue
        for j in range(k + 1):
            share = outer * power * _signed(k, j) / (2 * j + 3)
            total[power - 1] += share
            if power > 1:
                for n, coefficient in enumerate(_sine_integral(power - 2, 2 * j + 5)):
                    total[n] -= share * (power - 1) * coefficient
    return tuple(total)


def _signed(n: int, k: int) -> int:
    """Return the coefficient of x^k in (1 - x)^n."""
    return -comb(n, k) if k % 2 else comb(n, k)
