"""Collocation at Gauss nodes: matrices that turn values at the nodes into integrals, series and polynomials.

All of them are exact ratios of the nodes' 36 digits, rounded once. Compiled code takes them as one flat `TABLE`, with
matrices by columns, so that eight sums are computed together.
"""

from fractions import Fraction
from typing import Final

import numpy as np
from numpy.typing import NDArray

NODES: Final = 8
"""Number of nodes of an event cell or a step in time."""

PLAIN, LEFT, RIGHT, BOTH = 0, 1, 2, 3
"""Clocks: y = q, q^2, 2q - q^2, 3q^2 - 2q^3. A function that goes as y^1.5 from an end is smooth in q if dy/dq is 0
there."""

INTEGRAL: Final = 0
"""TABLE: int_0^q_i of the polynomial through values at the nodes, (8, 8) by columns."""
LEGENDRE: Final = 64
"""TABLE: coefficients c_n of P_n(2q - 1) of this polynomial."""
POWERS: Final = 128
"""TABLE: coefficients of (2q - 1)^n of this polynomial."""
WEIGHTS: Final = 192
"""TABLE: weights of the integral to 1."""
CLOCKS: Final = 200
"""TABLE: y at the nodes, for each clock."""
RATES: Final = 232
"""TABLE: dy/dq at the nodes, for each clock."""

_HALF = tuple(
    Fraction(digits)
    for digits in (
        "0.960289856497536231683560868569472991",
        "0.796666477413626739591553936475830437",
        "0.525532409916328985817739049189246350",
        "0.183434642495649804939476142360183981",
    )
)
_THREE = Fraction("0.774596669241483377035853079956479922")

Polynomial = list[Fraction]
"""Coefficients of 1, q, q^2, ..."""


def _times(one: Polynomial, other: Polynomial) -> Polynomial:
    product = [Fraction(0)] * (len(one) + len(other) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(other):
            product[i + j] += a * b
    return product


def _through(nodes: list[Fraction], which: int) -> Polynomial:
    """Return the polynomial that is 1 at one of the nodes and 0 at the others."""
    product: Polynomial = [Fraction(1)]
    for j, other in enumerate(nodes):
        if j != which:
            product = _times(product, [-other / (nodes[which] - other), 1 / (nodes[which] - other)])
    return product


def _value(polynomial: Polynomial, q: Fraction) -> Fraction:
    value = Fraction(0)
    for coefficient in reversed(polynomial):
        value = value * q + coefficient
    return value


def _integrated(polynomial: Polynomial) -> Polynomial:
    return [Fraction(0)] + [coefficient / (n + 1) for n, coefficient in enumerate(polynomial)]


def _legendre(count: int) -> list[Polynomial]:
    """Return P_n(2q - 1) for n < count, by (n + 1) P_(n+1) = (2n + 1) z P_n - n P_(n-1)."""
    found: list[Polynomial] = [[Fraction(1)], [Fraction(-1), Fraction(2)]]
    for n in range(1, count - 1):
        first = _times([Fraction(-(2 * n + 1), n + 1), Fraction(2 * (2 * n + 1), n + 1)], found[n])
        found.append(
            [a - Fraction(n, n + 1) * b for a, b in zip(first, [*found[n - 1], Fraction(0), Fraction(0)], strict=True)]
        )
    return found


def _in_z(polynomial: Polynomial) -> Polynomial:
    """Return the coefficients in z = 2q - 1 of a polynomial in q."""
    found: Polynomial = [Fraction(0)]
    for coefficient in reversed(polynomial):
        found = _times(found, [Fraction(1, 2), Fraction(1, 2)])
        found[0] += coefficient
    return found[: len(polynomial)]


def _all_matrices() -> NDArray[np.float64]:
    nodes = [(1 - z) / 2 for z in _HALF] + [(1 + z) / 2 for z in reversed(_HALF)]  # roots of P_8(2q - 1), in order
    legendre = _legendre(NODES)
    basis = [_through(nodes, j) for j in range(NODES)]
    areas = [_integrated(polynomial) for polynomial in basis]
    weights = [_value(area, Fraction(1)) for area in areas]
    clocks: list[Polynomial] = [[Fraction(c) for c in y] for y in ((0, 1), (0, 0, 1), (0, 2, -1), (0, 0, 3, -2))]
    rates = [[Fraction(n) * c for n, c in enumerate(y)][1:] for y in clocks]
    numbers = [_value(area, q) for area in areas for q in nodes]
    numbers += [
        (2 * n + 1) * w * _value(p, q) for w, q in zip(weights, nodes, strict=True) for n, p in enumerate(legendre)
    ]
    numbers += [c for polynomial in basis for c in _in_z(polynomial)]
    numbers += weights
    numbers += [_value(y, q) for y in clocks for q in nodes]
    numbers += [_value(rate, q) for rate in rates for q in nodes]
    return np.array([float(number) for number in numbers])


TABLE: Final = _all_matrices()
"""All matrices, one after the other."""


def _three() -> tuple[tuple[tuple[float, ...], ...], ...]:
    """Return three nodes, their weights, the integrals to each, and the powers through 0, the nodes and 1."""
    nodes = [(1 - _THREE) / 2, Fraction(1, 2), (1 + _THREE) / 2]
    areas = [_integrated(_through(nodes, j)) for j in range(3)]
    five = [Fraction(0), *nodes, Fraction(1)]
    basis = [_through(five, j) for j in range(5)]
    matrices = (
        [nodes],
        [[_value(area, Fraction(1)) for area in areas]],
        [[_value(area, q) for area in areas] for q in nodes],
        [[polynomial[n] for polynomial in basis] for n in range(5)],
    )
    return tuple(tuple(tuple(float(number) for number in row) for row in matrix) for matrix in matrices)


(THREE_NODES,), (THREE_WEIGHTS,), THREE_INTEGRALS, FIVE_POWERS = _three()
"""For uniform cells: nodes; weights; int_0^y_i; and coefficients of y^n through values at 0, the nodes and 1."""
