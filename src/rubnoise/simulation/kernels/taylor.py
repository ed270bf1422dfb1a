"""The Taylor series of fine lives in panels of eight positions: their sums, and areas and moments from these.

The coefficients come from those of sqrt(2u - u^2), the slope of the lens, by a recurrence. Other kernels compile this
code into theirs.
"""

from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import inlined
from rubnoise.simulation.kernels.grid import BLOCK
from rubnoise.simulation.kernels.lanes import (
    WIDTH,
    fused,
    larger,
    load,
    polynomial,
    root,
    smaller,
    spread,
    store,
    where_above,
)
from rubnoise.simulation.kernels.lens import AREA_COEFFICIENTS

PANEL = 8

TERMS = 15
"""Terms of a panel's series: a panel reaches to a fifth of the way to the end of a life, and (1/5)^15 / 15^2.5 with the
factors before it is 3e-16 of the squared diameter."""

_SOME, _FEW = 10, 8
"""Numbers of terms that are enough 6 and 14 panels further from both ends, where terms fall by 1/17 and 1/33."""

CHUNK = 64 * BLOCK
"""Positions whose series are kept at a time."""

MARGIN = WIDTH
"""Extra panels on either side of a chunk or grid: those of a life are processed in eights from its first one on."""

ROW = MARGIN + CHUNK // PANEL + MARGIN

SERIES = TERMS * ROW
"""Numbers in the series of a chunk: one row per term."""

# If g has the series sum g_n t^n, then g_(n+1) = (1/2 - n)/(n + 1) a g_n + (2 - n)/(n + 1) b g_(n-1). In units s_n that
# remove the first factor, G_(n+1) = a G_n + c_n b G_(n-1).
UNITS = [1.0]
for _n in range(TERMS - 1):
    UNITS.append(UNITS[-1] * (0.5 - _n) / (_n + 1))
_FACTORS = tuple((2.0 - n) / (n + 1) * UNITS[n - 1] / UNITS[n + 1] for n in range(1, TERMS - 2))
_SCALES = tuple(UNITS[n] / (n + 1) for n in range(TERMS - 1))
_SOME_FACTORS, _FEW_FACTORS = _FACTORS[: _SOME - 3], _FACTORS[: _FEW - 3]


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
    rise: int,
    fall: int,
    bottom: int,
    born: float,
    inverse_size: float,
    spacing: float,
    weight: float,
    series: Doubles,
) -> None:
    """Add a life's series to those of its panels, from ``rise`` to ``fall``, that lie from ``low`` to ``high``.

    Panels are processed in eights from ``rise`` on, with weight 0 outside ``low`` and ``high``, because the number of
    terms of a panel must not depend on where a run is cut. series: row by row the terms of the panels from ``bottom``
    on.
    """
    one, two, nothing = spread(1.0), spread(2.0), spread(0.0)
    birth, inverse = spread(born), spread(inverse_size)
    reach = 0.5 * PANEL * spacing * inverse_size
    nearest, forward, backward, square = spread(5.0 * reach), spread(reach), spread(-reach), spread(-reach * reach)
    lowest, highest = spread(centre[MARGIN + low] - spacing), spread(centre[MARGIN + high - 1] + spacing)
    for panel in range(rise + (low - rise) // WIDTH * WIDTH, high, WIDTH):
        place = load(centre, MARGIN + panel)
        share = where_above(lowest, place, where_above(place, highest, spread(weight), nothing), nothing)
        s = (place - birth) * inverse
        u = larger(smaller(s, two - s), nearest)
        step = where_above(one, s, backward, forward)
        q = u * (two - u)
        per_q = one / q
        across = (step * (two * (one - u))) * per_q
        back = square * per_q
        at = MARGIN + panel - bottom
        area = (u * root(u)) * polynomial(AREA_COEFFICIENTS, u)
        store(series, at, fused(share, area, load(series, at)))
        slope = (share * step) * root(q)
        from_end = min(panel - rise, fall - WIDTH - panel)
        if from_end < 6:
            add_terms(_FACTORS, slope, across, back, at, series)
        elif from_end < 14:
            add_terms(_SOME_FACTORS, slope, across, back, at, series)
        else:
            add_terms(_FEW_FACTORS, slope, across, back, at, series)


@inlined
def add_terms(factors: tuple[float, ...], slope: Any, across: Any, back: Any, at: int, series: Doubles) -> None:
    """Add the terms of eight panels after the area, by the recurrence: there are two more than ``factors``."""
    before, term = slope, across * slope
    store(series, at + ROW, load(series, at + ROW) + before)
    store(series, at + 2 * ROW, load(series, at + 2 * ROW) + term)
    for n in range(len(factors)):
        before, term = term, fused(across, term, (spread(factors[n]) * back) * before)
        place = at + (n + 3) * ROW
        store(series, place, load(series, place) + term)


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
        first = MARGIN + panel
        if panel % WIDTH == 0:
            for n in range(TERMS - 1):
                place = first + (n + 1) * ROW
                store(series, place, spread(_SCALES[n]) * load(series, place))
        at = bottom + PANEL * panel + 1
        if len(total) > 0:
            t = (load(position, at) - spread(position[at + PANEL // 2 - 1])) * per_half
            value = spread(series[first + (TERMS - 1) * ROW])
            for n in range(TERMS - 2, -1, -1):
                value = fused(value, t, spread(series[first + n * ROW]))
            store(total, at, load(total, at) + value)
        if len(moments) > 0:
            mean, slope, bend = load(moments, at), load(moments, size + at), load(moments, 2 * size + at)
            for n in range(TERMS):
                coefficient = spread(series[first + n * ROW])
                mean = fused(coefficient, load(weights, n * PANEL), mean)
                slope = fused(coefficient, load(weights, (TERMS + n) * PANEL), slope)
                bend = fused(coefficient, load(weights, (2 * TERMS + n) * PANEL), bend)
            store(moments, at, mean)
            store(moments, size + at, slope)
            store(moments, 2 * size + at, bend)
