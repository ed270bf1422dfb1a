"""The compiled heart for lives of many ticks: their ends tick by tick, all between them by the Taylor series of panels.

Within a panel of eight ticks that is far enough from birth and death, the area of a junction is a short power series.
So a life leaves at most fifteen numbers in each panel instead of an area and three integrals at each tick; what the
series of all lives add up to is worked out once for each tick, and its moments over a cell follow from the same
numbers.

Positions are spaced evenly and come with those of whole blocks around them, so that nothing has to be cut: index 0 is a
multiple of 64, and panel p holds the positions 8p + 1 ... 8p + 8 and the cells that end there.
"""

from math import floor

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, inlined
from rubnoise.simulation.kernels.ends import END, add_fall, add_kink, add_rise
from rubnoise.simulation.kernels.taylor import BLOCK, CHUNK, MARGIN, PANEL, SERIES, add_panels, add_series

FINEST = 4 * END
"""Spacings in a diameter from which on a life is fine: its ends then lie within a quarter of the diameter."""


def deposit_fine_lives(
    position: Doubles,
    origin: int,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    departure: Doubles,
    weight: Doubles,
    weights: Doubles,
    total: Doubles,
    moments: Doubles,
) -> NDArray[np.int64]:
    """Sum the weighted area fractions of fine, whole lives at positions, and their moments over the cells.

    Returns the rows of those lives that are not fine or were ended early, and have been left out.

    position (um): ``origin`` spacings and on, whole blocks; only what belongs to the indices from ``begin`` to ``end``
    is complete, with at least a block before and after them. birth, diameter, departure (um) and weight: one a
    junction, in order of birth. weights: `cell_weights`, flat. total receives sum w a; moments, three times as long as
    position, the Legendre moments of it over the cell that ends at a position, in units of the spacing. Either may be
    empty; whatever was in them is overwritten.
    """
    centre = np.zeros(MARGIN + position.size // PANEL + MARGIN)
    centre[MARGIN:-MARGIN] = position[PANEL // 2 :: PANEL]
    series = np.empty(SERIES)
    alive, other = np.empty((2, len(birth)), dtype=np.int64)
    others = deposit_by_chunks(
        position, centre, origin, spacing, begin, end, birth, diameter, departure, weight, weights, series, alive,
        other, total, moments,
    )  # fmt: skip
    return other[:others]


@compiled_bare
def deposit_by_chunks(
    position: Doubles,
    centre: Doubles,
    origin: int,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    departure: Doubles,
    weight: Doubles,
    weights: Doubles,
    series: Doubles,
    alive: NDArray[np.int64],
    other: NDArray[np.int64],
    total: Doubles,
    moments: Doubles,
) -> int:
    """Do what `deposit_fine_lives` does, in room that is given, and return how many it has put into ``other``.

    centre (um): the place amid each panel; series: for a chunk; alive, other: for as many as there are lives.
    """
    count, others, row = 0, 0, 0
    per_spacing = 1.0 / spacing
    first = begin // BLOCK * BLOCK - BLOCK
    cleared = first
    # Borders of chunks lie at multiples from the run's start: sums keep their order however a run is cut.
    low = (origin + first) // CHUNK * CHUNK - origin
    while low < end:
        bottom, top = max(low, first), min(low + CHUNK, (end + BLOCK - 1) // BLOCK * BLOCK)
        series[:] = 0.0
        cleared = _clear(cleared, min(top + BLOCK, len(position)), total, moments)
        while row < len(birth) and floor(birth[row] * per_spacing) - END - PANEL - origin < top:
            if diameter[row] < FINEST * spacing or departure[row] < birth[row] + 2.0 * diameter[row]:
                other[others] = row
                others += 1
            else:
                alive[count] = row
                count += 1
            row += 1
        kept = 0
        for n in range(count):
            each = alive[n]
            still = _add_life(
                position, centre, origin, spacing, per_spacing, bottom, top,
                birth[each], diameter[each], weight[each], series, total, moments,
            )  # fmt: skip
            if still:
                alive[kept] = each
                kept += 1
        count = kept
        add_series(position, spacing, bottom, top, series, weights, total, moments)
        low += CHUNK
    return others


@inlined
def _clear(begin: int, end: int, total: Doubles, moments: Doubles) -> int:
    """Set sums and moments from ``begin`` to ``end`` to zero, and return where that ends: while they are at hand."""
    if len(total) > 0:
        total[begin:end] = 0.0
    if len(moments) > 0:
        size = len(moments) // 3
        for n in range(3):
            moments[n * size + begin : n * size + end] = 0.0
    return end


@inlined
def _add_life(
    position: Doubles,
    centre: Doubles,
    origin: int,
    spacing: float,
    per_spacing: float,
    bottom: int,
    top: int,
    born: float,
    size: float,
    weight: float,
    series: Doubles,
    total: Doubles,
    moments: Doubles,
) -> bool:
    """Add what a life leaves between two indices, and return whether it goes on beyond them."""
    place = born * per_spacing
    rise = floor((place + 16.0) * 0.125) + 1 - origin // PANEL
    inverse, in_spacings = 1.0 / size, size * per_spacing
    fall = floor((place + 2.0 * in_spacings - 16.0) * 0.125) - origin // PANEL
    low, high = max(rise, bottom // PANEL), min(fall, top // PANEL)
    if low < high:
        add_panels(centre, low, high, rise, fall, bottom // PANEL, born, inverse, spacing, weight, series)
        kink = floor((place + in_spacings) * 0.125) - origin // PANEL
        if low <= kink < high:
            add_kink(position, PANEL * kink + 1, born, inverse, in_spacings, weight, total, moments)
    start = PANEL * rise - END + 1
    if bottom < start <= top:
        add_rise(position, start, born, inverse, in_spacings, weight, total, moments)
    start = PANEL * fall + 1
    if bottom < start <= top:
        add_fall(position, start, born, inverse, in_spacings, weight, total, moments)
    return PANEL * fall + 1 > top
