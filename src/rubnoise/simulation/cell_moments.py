"""The moments of a cell from values at its edges and near it, and what these miss where something begins.

Values at eight edges, as of one polynomial, give the first three Legendre moments of the cell in the middle of them.
Where x^p begins within a cell, they miss something there and in the cells about it. That depends on p and on the place
in the cell alone. So it is fitted once, as polynomials in that place, when this module is loaded.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_within

BEFORE: Final = 3
AFTER: Final = 4
"""Edges before the first edge of a cell, and after it, whose values give the moments of the cell."""

WHOLE, ROOT = 1, 2  # kinds of powers: of x, and of its root

ROOT_CELLS: Final = 12
WHOLE_CELLS: Final = 8
"""Cells, from BEFORE the one where x begins, in which values miss something of x^1.5 and of x; beyond, too little."""

Series = tuple[float, float, float]  # c_0, c_1, c_2 of x^p (c_0 + c_1 x + c_2 x^2), x in cells; p is 3/2 or 1

_PLACES, _WEIGHTS = leggauss(5)
GAUSS: Final = tuple(zip((0.5 + 0.5 * _PLACES).tolist(), (0.5 * _WEIGHTS).tolist(), strict=True))
"""Gauss-Legendre nodes on [0, 1] and their weights."""


def _rule() -> Doubles:
    """Return what the value at each edge adds to each moment of a cell, (3, edges), by Lagrange's polynomials."""
    edges = np.arange(-BEFORE, AFTER + 1.0)
    y, weights = np.array(GAUSS).T
    shares = [np.prod([(y - other) / (edge - other) for other in edges if other != edge], axis=0) for edge in edges]
    return np.ascontiguousarray((legvander(2.0 * y - 1.0, 2).T * weights) @ np.transpose(shares))


RULE: Final = _rule()


@compiled
def moments_of(values: Doubles) -> Doubles:
    """Return the moments (3, cells) from the values at the edges of the cells and at those before and after them."""
    moments = np.empty((3, len(values) - BEFORE - AFTER))
    means, slopes, bends = moments
    for k in range(len(means)):
        a, b = values[k + 3] + values[k + 4], values[k + 2] + values[k + 5]
        c, d = values[k + 1] + values[k + 6], values[k] + values[k + 7]
        means[k] = RULE[0, 4] * a + RULE[0, 5] * b + RULE[0, 6] * c + RULE[0, 7] * d
        bends[k] = RULE[2, 4] * a + RULE[2, 5] * b + RULE[2, 6] * c + RULE[2, 7] * d
        a, b = values[k + 4] - values[k + 3], values[k + 5] - values[k + 2]
        c, d = values[k + 6] - values[k + 1], values[k + 7] - values[k]
        slopes[k] = RULE[1, 4] * a + RULE[1, 5] * b + RULE[1, 6] * c + RULE[1, 7] * d
    return moments


def _missed(power: float, kind: int, cells: int, degree: int) -> Doubles:
    """Return what values miss of the moments of x^power, (degree + 1, 3, cells).

    As coefficients of powers of 2 y^(1/kind) - 1, where y is the part of the cell that lies behind x = 0.
    """
    phase = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    edges = (0.5 + 0.5 * phase) ** kind + np.arange(-2.0 * BEFORE - 1.0, cells - BEFORE + AFTER - 1.0)[:, None]
    x, found = np.maximum(edges, 0.0), np.empty((degree + 1, 3, cells))
    for cell in range(cells):
        at = cell + BEFORE
        whole, once, twice = (np.diff(x[at : at + 2] ** n, axis=0)[0] / n for n in power + np.arange(1.0, 4.0))
        once -= edges[at] * whole  # int x^p s, s being the distance from the first edge
        twice -= edges[at] * (2.0 * once + edges[at] * whole)
        true = np.array([whole, 2.0 * once - whole, 6.0 * (twice - once) + whole])
        found[:, :, cell] = (true - RULE @ x[at - BEFORE : at + AFTER + 1] ** power).T
    return np.linalg.solve(np.vander(phase, increasing=True), found.reshape(degree + 1, -1)).reshape(found.shape)


def _filler(missed: Sequence[Doubles], kind: int, way: int) -> Any:
    """Return a compiled function that fills in what values miss of a series, (3, cells) as one row.

    missed: of its powers; way: 1 if x goes up, -1 if it goes down. The cells go up.
    """
    ways = [each if way > 0 else each[..., ::-1] * np.array([[1.0], [-1.0], [1.0]]) for each in missed]
    first, second, third = (np.ascontiguousarray(each.reshape(len(each), -1)) for each in ways)
    degrees, count = tuple(len(each) - 1 for each in missed), first.shape[1]  # which the compiler knows

    @compiled_within
    def fill(y: float, series: Series, found: Doubles) -> None:
        z = 2.0 * (np.sqrt(y) if kind == ROOT else y) - 1.0
        for k in range(count):
            a, b, c = first[degrees[0], k], second[degrees[1], k], third[degrees[2], k]
            for n in range(degrees[0] - 1, -1, -1):
                a = a * z + first[n, k]
            for n in range(degrees[1] - 1, -1, -1):
                b = b * z + second[n, k]
            for n in range(degrees[2] - 1, -1, -1):
                c = c * z + third[n, k]
            found[k] = series[0] * a + series[1] * b + series[2] * c

    return fill


_OF_ROOTS: Final = [_missed(power, ROOT, ROOT_CELLS, degree) for power, degree in ((1.5, 8), (2.5, 6), (3.5, 4))]
_OF_WHOLES: Final = [_missed(power, WHOLE, WHOLE_CELLS, degree) for power, degree in ((1.0, 4), (2.0, 5), (3.0, 6))]
_rising_root, _falling_root = _filler(_OF_ROOTS, ROOT, 1), _filler(_OF_ROOTS, ROOT, -1)
_rising, _falling = _filler(_OF_WHOLES, WHOLE, 1), _filler(_OF_WHOLES, WHOLE, -1)


@compiled_within
def missed_of(kind: int, way: int, y: float, series: Series, found: Doubles) -> int:
    """Fill in what values miss of a series, moment by moment, in all cells from the lowest on; return their number.

    kind: ROOT if p is 3/2, else WHOLE; y: the part of the cell that lies behind x = 0, up (way 1) or down (-1).
    """
    if kind == ROOT and way > 0:
        _rising_root(y, series, found)
    elif kind == ROOT:
        _falling_root(y, series, found)
    elif way > 0:
        _rising(y, series, found)
    else:
        _falling(y, series, found)
    return ROOT_CELLS if kind == ROOT else WHOLE_CELLS
