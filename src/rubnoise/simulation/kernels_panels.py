"""The Taylor series of fine lives in panels of eight positions: added up there, and turned into areas and moments.

The coefficients follow from those of sqrt(2u - u^2), the slope of the lens, by a recurrence; compiled into others.
"""

import numpy as np
from numpy.typing import NDArray

from rubnoise.compiling import inlined
from rubnoise.simulation.kernels import AREA_COEFFICIENTS
from rubnoise.simulation.lanes import fused, larger, load, polynomial, root, smaller, spread, store, where_above

Doubles = NDArray[np.float64]

PANEL = 8

TERMS = 15
"""Terms of a panel's series: a panel reaches to a fifth of the way to the end of a life, and (1/5)^15 / 15^2.5 with the
factors before it is 3e-16 of the squared diameter."""

BLOCK = 8 * PANEL
"""Positions whose panels go through the recurrence together."""

_ROW = PANEL * TERMS

# With g' s series sum g_n t^n, g_(n+1) = (1/2 - n)/(n + 1) a g_n + (2 - n)/(n + 1) b g_(n-1); in units s_n that take
# the first factor away, G_(n+1) = a G_n + c_n b G_(n-1).
_UNITS = [1.0]
for _n in range(TERMS - 1):
    _UNITS.append(_UNITS[-1] * (0.5 - _n) / (_n + 1))
_FACTORS = tuple((2.0 - n) / (n + 1) * _UNITS[n - 1] / _UNITS[n + 1] for n in range(1, TERMS - 1))
_SCALES = tuple(_UNITS[n] / (n + 1) for n in range(TERMS - 1))


def cell_weights() -> Doubles:
    """Return what each term of a panel's series adds to the moments of its cells, (3, TERMS, PANEL).

    int_0^1 t^n P_i(2y - 1) dy with t = (m + y)/4 for the cell from m/4 to (m + 1)/4 in halves of the panel, the moments
    over the width of the cell. Ratios of whole numbers, rounded once.
    """
    weights = np.empty((3, TERMS, PANEL))
    for n in range(TERMS):
        for cell, m in enumerate(range(-4, 4)):
            powers = [(m + 1) ** (k + 1) - m ** (k + 1) for k in range(n, n + 3)]
            flat = powers[0] * (n + 2) * (n + 3)
            slope = powers[1] * (n + 1) * (n + 3) - m * flat
            bend = powers[2] * (n + 1) * (n + 2) - 2 * m * powers[1] * (n + 1) * (n + 3) + m * m * flat
            whole = 4**n * (n + 1) * (n + 2) * (n + 3)
            weights[:, n, cell] = flat / whole, (2 * slope - flat) / whole, (6 * bend - 6 * slope + flat) / whole
    return weights


@inlined
def add_panels(
    centre: Doubles,
    low: int,
    high: int,
    first_block: int,
    born: float,
    size: float,
    spacing: float,
    weight: float,
    series: Doubles,
) -> None:
    """Add a life's series to the panels from ``low`` to ``high``, whole blocks at a time with no weight beside them."""
    one, two, nothing = spread(1.0), spread(2.0), spread(0.0)
    birth, inverse = spread(born), spread(1.0 / size)
    reach = 0.5 * PANEL * spacing / size
    nearest, forward, backward, square = spread(5.0 * reach), spread(reach), spread(-reach), spread(-reach * reach)
    lowest, highest = spread(centre[low] - spacing), spread(centre[high - 1] + spacing)
    for block in range(low // PANEL, (high + PANEL - 1) // PANEL):
        place = load(centre, PANEL * block)
        share = where_above(lowest, place, where_above(place, highest, spread(weight), nothing), nothing)
        s = (place - birth) * inverse
        u = larger(smaller(s, two - s), nearest)
        step = where_above(one, s, backward, forward)
        q = u * (two - u)
        per_q = one / q
        across = (step * (two * (one - u))) * per_q
        back = square * per_q
        at = (block - first_block) * _ROW
        area = (u * root(u)) * polynomial(AREA_COEFFICIENTS, u)
        store(series, at, fused(share, area, load(series, at)))
        before = (share * step) * root(q)
        store(series, at + PANEL, load(series, at + PANEL) + before)
        term = across * before
        store(series, at + 2 * PANEL, load(series, at + 2 * PANEL) + term)
        for n in range(TERMS - 3):
            following = fused(across, term, (spread(_FACTORS[n]) * back) * before)
            before, term = term, following
            entry = at + (n + 3) * PANEL
            store(series, entry, load(series, entry) + term)


@inlined
def add_series(
    position: Doubles,
    spacing: float,
    bottom: int,
    top: int,
    series: Doubles,
    weights: Doubles,
    total: Doubles,
    moments: Doubles,
) -> None:
    """Add the series of the panels between two indices to their positions, and their moments to the cells."""
    size = len(moments) // 3
    per_half = spread(2.0 / (PANEL * spacing))
    for panel in range((top - bottom) // PANEL):
        block = panel // PANEL * _ROW
        if panel % PANEL == 0:
            for n in range(TERMS - 1):
                place = block + (n + 1) * PANEL
                store(series, place, spread(_SCALES[n]) * load(series, place))
        term = block + panel % PANEL
        at = bottom + PANEL * panel + 1
        t = (load(position, at) - spread(position[at + PANEL // 2 - 1])) * per_half
        value = spread(series[term + (TERMS - 1) * PANEL])
        for n in range(TERMS - 2, -1, -1):
            value = fused(value, t, spread(series[term + n * PANEL]))
        store(total, at, load(total, at) + value)
        if len(moments) > 0:
            mean, slope, bend = load(moments, at), load(moments, size + at), load(moments, 2 * size + at)
            for n in range(TERMS):
                coefficient = spread(series[term + n * PANEL])
                mean = fused(coefficient, load(weights, n * PANEL), mean)
                slope = fused(coefficient, load(weights, (TERMS + n) * PANEL), slope)
                bend = fused(coefficient, load(weights, (2 * TERMS + n) * PANEL), bend)
            store(moments, at, mean)
            store(moments, size + at, slope)
            store(moments, 2 * size + at, bend)
