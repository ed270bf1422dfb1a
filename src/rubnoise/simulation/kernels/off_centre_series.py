"""The inner parts of passes off the centre line: Taylor series in panels of eight positions, as in `fine`.

The area d^2 L(r), r = sqrt(x^2 + b^2)/d, has the slope -x g in units of d, where g = sqrt(q/p), p = x^2 + b^2 and
q = 1 - p. As g' = -p' g / (2 p q), each term of g follows from the four before it, by polynomials of x. How fast the
terms grow depends on the distance to the nearest end of the life, x = +-sqrt(1 - b^2), or turn, x = +-ib.
"""

from math import floor, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, inlined
from rubnoise.simulation.kernels.grid import BLOCK
from rubnoise.simulation.kernels.lanes import WIDTH, fused, larger, load, polynomial, root, spread, store, where_above
from rubnoise.simulation.kernels.lens import AREA_COEFFICIENTS
from rubnoise.simulation.kernels.taylor import CHUNK, MARGIN, PANEL, ROW, SERIES, TERMS, UNITS, add_series

FROM_END = 16.0
"""Positions between an end of a life and the nearest panel with a series, as in `fine`: its series reaches to a fifth
of the way to the end."""

FROM_TURN = 28.0
"""Smallest number of positions between the middle of a panel and x = +-ib: terms fall more slowly there than near an
end, because the root is steeper."""

FINEST = 192.0
"""Positions in a diameter from which on areas also come from series; below, series would not be faster."""

_FEWEST = 2
"""Smallest number of adjacent panels that are worth a series."""

_SOME, _FEW = 11, 9
"""Numbers of terms that are enough if the nearest end is 45 and 100 positions away, and the turn 75 and 167."""

CONSTANTS = np.array([*(1.0 / (n + 1.0) for n in range(TERMS)), *(1.0 / unit for unit in UNITS[:TERMS])])
"""1/(n + 1) of the recurrence, and the factors that convert terms to the units of `taylor`."""


@inlined
def panels_of(place: float, half: float, offset: float) -> tuple[int, int, int, int]:
    """Return panels rise, low, high and fall of a life: those from rise to low and from high to fall have series.

    place, half and offset: the begin of the life, half of its length and |b|, in positions. The life is in panels
    rise - 3 to fall + 2, where panel p holds the positions 8 p + 1 ... 8 p + 8 of the run. In panels without a series
    it is summed position by position.
    """
    rise = floor((place + FROM_END) * 0.125) + 1
    fall = floor((place + 2.0 * half - FROM_END) * 0.125)
    low, high = fall, fall
    if offset < FROM_TURN:
        away = sqrt(FROM_TURN * FROM_TURN - offset * offset)
        low = floor((place + half - away + 0.5 * PANEL) * 0.125)
        high = floor((place + half + away + 0.5 * PANEL) * 0.125)
    if low - rise < _FEWEST:
        low = rise
    if fall - high < _FEWEST:
        high = fall
    return rise, low, high, fall


@inlined
def is_alone(panels: tuple[int, int, int, int]) -> bool:
    """Return whether no panel of a life has a series."""
    rise, low, high, fall = panels
    return low == rise and high == fall


@inlined
def panels_alone(n: int, panels: tuple[int, int, int, int]) -> tuple[int, int]:
    """Return first and end of the n-th of three stretches of panels without series, for a life that has series."""
    rise, low, high, fall = panels
    if n == 0:
        return rise - 3, rise
    return (low, high) if n == 1 else (fall, fall + 3)


def deposit_series(
    position: Doubles,
    origin: int,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    offset: Doubles,
    half_life: Doubles,
    weight: Doubles,
    weights: Doubles,
    total: Doubles,
    moments: Doubles,
) -> None:
    """Add whole lives to total and moments (either may be empty), in the panels in which the lives have series.

    position (um): from ``origin`` spacings on, in whole blocks, with at least one before and after the indices from
    ``begin`` to ``end``. birth, diameter, offset, half_life (um) and weight: one per junction, in order of birth.
    weights: `cell_weights`, flat.
    """
    centre = np.zeros(MARGIN + position.size // PANEL + MARGIN)
    centre[MARGIN:-MARGIN] = position[PANEL // 2 :: PANEL]
    alive = np.empty(len(birth), dtype=np.int64)
    _deposit_by_chunks(
        position, centre, origin, spacing, begin, end, birth, diameter, offset, half_life, weight, weights,
        CONSTANTS, np.empty(SERIES), alive, total, moments,
    )  # fmt: skip


@compiled_bare
def _deposit_by_chunks(
    position: Doubles,
    centre: Doubles,
    origin: int,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    offset: Doubles,
    half_life: Doubles,
    weight: Doubles,
    weights: Doubles,
    constants: Doubles,
    series: Doubles,
    alive: NDArray[np.int64],
    total: Doubles,
    moments: Doubles,
) -> None:
    per_spacing = 1.0 / spacing
    count, row = 0, 0
    low = begin // BLOCK * BLOCK - BLOCK
    last = (end + BLOCK - 1) // BLOCK * BLOCK
    while low < last:
        top = min(low + CHUNK, last)
        series[:] = 0.0
        while row < len(birth) and birth[row] * per_spacing - origin < top:
            alive[count] = row
            count, row = count + 1, row + 1
        kept = 0
        for n in range(count):
            each = alive[n]
            still = _add_life(
                centre, origin // PANEL, spacing, low // PANEL, top // PANEL, birth[each], diameter[each],
                abs(offset[each]), half_life[each], weight[each], constants, series,
            )  # fmt: skip
            if still:
                alive[kept] = each
                kept += 1
        count = kept
        add_series(position, spacing, low, top, series, weights, total, moments)
        low = top


@inlined
def _add_life(
    centre: Doubles,
    origin: int,
    spacing: float,
    bottom: int,
    top: int,
    born: float,
    size: float,
    offset: float,
    half: float,
    weight: float,
    constants: Doubles,
    series: Doubles,
) -> bool:
    """Add a life's series to a chunk's panels, from ``bottom`` to ``top``; return whether the life reaches beyond."""
    per_spacing = 1.0 / spacing
    place, middle, aside = born * per_spacing, half * per_spacing, offset * per_spacing
    rise, low, high, fall = panels_of(place, middle, aside)
    for n in range(2):
        first, end = (rise, low) if n == 0 else (high, fall)
        begin, stop = max(first - origin, bottom), min(end - origin, top)
        if begin >= stop:
            continue
        inverse = 1.0 / size
        lowest, highest = centre[MARGIN + begin] - spacing, centre[MARGIN + stop - 1] + spacing
        # In eights from the first on, also if some have weight 0: terms must not depend on where a run is cut.
        skipped = (begin + origin - first) // WIDTH * WIDTH
        for panel in range(first + skipped, stop + origin, WIDTH):
            terms = _terms(panel, min(panel + WIDTH, end) - 1, place, middle, aside)
            at = panel - origin
            _add_panels(
                terms, centre, at, MARGIN + at - bottom, born, half, inverse, offset, spacing, weight, lowest, highest,
                constants, series,
            )  # fmt: skip
    return fall - origin > top


@inlined
def _terms(first: int, last: int, place: float, half: float, offset: float) -> int:
    """Return how many terms panels from the first to the last need."""
    low, high = PANEL * first + 0.5 * PANEL - place, PANEL * last + 0.5 * PANEL - place
    beside = max(low - half, half - high, 0.0)
    nearest = min(low, 2.0 * half - high, 0.6 * sqrt(beside * beside + offset * offset))
    if nearest < 45.0:
        return TERMS
    return _FEW if nearest > 100.0 else _SOME


@inlined
def _add_panels(
    terms: int,
    centre: Doubles,
    panel: int,
    at: int,
    born: float,
    half: float,
    inverse_size: float,
    offset: float,
    spacing: float,
    weight: float,
    lowest: float,
    highest: float,
    constants: Doubles,
    series: Doubles,
) -> None:
    """Add the series of eight panels; only those with centres between ``lowest`` and ``highest`` (um) count."""
    one, nothing = spread(1.0), spread(0.0)
    across = offset * inverse_size
    reach = 0.5 * PANEL * spacing * inverse_size
    place = load(centre, MARGIN + panel)
    share = where_above(spread(lowest), place, where_above(place, spread(highest), spread(weight), nothing), nothing)
    x = ((place - spread(born)) - spread(half)) * spread(inverse_size)
    # The values of panels that do not count only have to be finite.
    p = larger(fused(x, x, spread(across * across)), spread(reach * reach))
    q = larger(one - p, spread(reach * reach))
    u = larger(one - root(p), nothing)
    area = (u * root(u)) * polynomial(AREA_COEFFICIENTS, u)
    store(series, at, fused(share, area, load(series, at)))
    g = (share * spread(-reach)) * root(q / p)
    _add_terms(terms, x, p, q, g, reach, at, constants, series)


@inlined
def _add_terms(
    terms: int, x: Any, p: Any, q: Any, g: Any, reach: float, at: int, constants: Doubles, series: Doubles
) -> None:
    """Add the terms beyond the area: those of -x g, from the recurrence of g.

    With R = p q = R_0 + ... + R_4 t^4 and p = p_0 + p_1 t + p_2 t^2, R_0 (n + 1) g_(n+1) is minus the sum of
    (n R_1 + p_1/2) g_n, ((n - 1) R_2 + p_2) g_(n-1), (n - 2) R_3 g_(n-2) and (n - 3) R_4 g_(n-3). Divided by n + 1,
    each of the four factors is one number plus another times 1/(n + 1).
    """
    square, step, two = spread(reach * reach), spread(reach), spread(2.0)
    inverse = spread(-1.0) / (p * q)
    half_slope, bend = x * step, square * inverse
    slope, skew = half_slope + half_slope, q - p
    first = (slope * skew) * inverse
    second = fused(square, skew, spread(-1.0) * (slope * slope)) * inverse
    third, fourth = spread(-2.0) * (slope * bend), spread(-1.0) * (square * bend)
    first_less = half_slope * inverse - first
    second_less = bend - two * second
    third_less, fourth_less = spread(-3.0) * third, spread(-4.0) * fourth
    oldest, older, old, now = spread(0.0), spread(0.0), spread(0.0), g
    for n in range(terms - 1):
        row, share = at + (n + 1) * ROW, spread(constants[n])
        term = fused(x, now, step * old)
        store(series, row, fused(spread(constants[TERMS + n]), term, load(series, row)))
        rest = fused(fourth_less, share, fourth) * oldest
        rest = fused(fused(third_less, share, third), older, rest)
        rest = fused(fused(second_less, share, second), old, rest)
        oldest, older, old, now = older, old, now, fused(fused(first_less, share, first), now, rest)
