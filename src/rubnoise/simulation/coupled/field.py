"""The force that the contact can bear as a function of distance, G(s) = sum psi_i A_i(s), over a range of cells.

Cell i reaches from i h to (i + 1) h. Over whole cells only three moments of G are needed; they come from the kernels.
When the slider hardly moves, G itself is needed at any place of one cell. There, all lives that do not begin, turn or
end in or near the cell are summed into one polynomial, and the few others are evaluated one by one.
"""

from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, inlined
from rubnoise.contact.pulses import Shape
from rubnoise.simulation.coupled.lanes import (
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
from rubnoise.simulation.coupled.quadrature import CLOCKS, NODES, POWERS
from rubnoise.simulation.kernel import (
    LENS,
    LENS_SHAPE,
    PARABOLA_SHAPE,
    SHAPES,
    area_over_square,
    sum_over_cells,
)
from rubnoise.simulation.state import LiveRows

Lives = tuple[Doubles, Doubles, Doubles, Doubles, Doubles]
"""Birth, diameter, 1/diameter, psi d^2, and the largest death of all rows up to each."""

Part = tuple[float, Doubles, Doubles, int, int]
"""A gathered cell: 2 over its width, `far`, `near`, the number of near lives, and the shape."""

GROUP: Final = 8
"""Largest number of cells that one step takes; ranges begin and end at multiples of it."""

REACH: Final = 3.0
"""Number of cells on either side: a life that is born or dies there is kept out of the polynomial. Of the others, it
misses about (5.8 + 8.2)^-8."""

_QUARTER_TURN: Final = 0.25 * np.pi
_FOUR_THIRDS: Final = 4.0 / 3.0
_LENS_INTEGRAL: Final = tuple(c / (n + 2.5) for n, c in enumerate(LENS))

AGE, SIZE, INVERSE, SHARE = range(4)
"""Columns of the lives that are evaluated one by one: age at the cell's origin, d, 1/d, psi d^2."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceField:
    """G over the cells ``first`` ... ``end`` - 1, ``spacing`` um each.

    moments (3, cells): int_0^1 G P_i(2y - 1) dy over each (uN); rows: all that live anywhere in these cells, in order
    of birth; lives: their values for compiled code, with eight more lives of weight 0.
    """

    first: int
    end: int
    spacing: float
    shape: int
    moments: Doubles
    rows: LiveRows
    lives: Lives

    @classmethod
    def over(cls, pulse: Shape, rows: LiveRows, first: int, end: int, spacing: float) -> Self:
        """Return the field of rows over a range of cells."""
        weight = rows.strength * (rows.diameter * rows.diameter)
        _, moments = sum_over_cells(pulse, rows, weight, first, end, spacing)
        reach = np.maximum.accumulate(rows.birth + 2.0 * rows.diameter)
        none = np.zeros(NODES)
        return cls(
            first=first,
            end=end,
            spacing=spacing,
            shape=SHAPES[pulse],
            moments=moments,
            rows=rows,
            lives=(
                np.concatenate([rows.birth, none + np.inf]),
                np.concatenate([rows.diameter, none]),
                np.concatenate([1.0 / rows.diameter, none]),
                np.concatenate([weight, none]),
                np.concatenate([reach, none + np.inf]),
            ),
        )


@compiled_bare
def first_beyond(ordered: Doubles, place: float) -> int:
    """Return the first index whose entry is greater than ``place``; the last entry is infinite."""
    low, high = 0, len(ordered) - 1
    while low < high:
        middle = (low + high) // 2
        if ordered[middle] > place:
            high = middle
        else:
            low = middle + 1
    return low


@inlined
def near_index(ordered: Doubles, place: float, guess: int) -> int:
    """Return the same as `first_beyond`, searched step by step from a guess."""
    index = min(max(guess, 0), len(ordered) - 1)
    while index > 0 and ordered[index - 1] > place:
        index -= 1
    while ordered[index] <= place:
        index += 1
    return index


@inlined
def _fraction(u: Any, shape: int) -> Any:
    """Return the area over d^2 in lanes; u in [0, 1] is the distance from the nearer end of the life, over d."""
    if shape == LENS_SHAPE:
        return (u * root(u)) * polynomial(LENS, u)
    if shape == PARABOLA_SHAPE:
        return (u * (spread(2.0) - u)) * spread(_QUARTER_TURN)
    return u * spread(_QUARTER_TURN)


@compiled_bare
def gather(
    lives: Lives, shape: int, origin: float, width: float, table: Doubles, near: Doubles, far: Doubles, work: Doubles
) -> int:
    """Split the lives of a cell: fill ``near``, (4, n) by rows, and the polynomial ``far``; return the near count.

    far: eight coefficients of (2y - 1)^n for the force of all other lives; y is the place in the cell over its width.
    """
    birth, diameter, inverse, weight, reach = lives
    begin = first_beyond(reach, origin)
    end = first_beyond(birth, origin + width)
    margin = REACH * width
    size = len(near) // 4
    places = spread(width) * load(table, CLOCKS)
    total, two = spread(0.0), spread(2.0)
    count = 0
    for row in range(begin, end):
        age, across = origin - birth[row], diameter[row]
        left = across + across - age
        if left <= 0.0:
            continue
        middle = across - age
        if age < margin or left < width + margin or (middle >= 0.0 and middle <= width):
            near[AGE * size + count] = age
            near[SIZE * size + count] = across
            near[INVERSE * size + count] = inverse[row]
            near[SHARE * size + count] = weight[row]
            count += 1
            continue
        s = (places + spread(age)) * spread(inverse[row])
        u = s if middle > 0.0 else two - s
        total = fused(spread(weight[row]), _fraction(u, shape), total)
    store(work, 0, total)
    powers = spread(0.0)
    for n in range(NODES):
        powers = fused(spread(work[n]), load(table, POWERS + NODES * n), powers)
    store(far, 0, powers)
    return count


@inlined
def force_in_lanes(offset: Any, part: Part) -> Any:
    """Return G in uN at eight offsets in a gathered cell."""
    per_half, far, near, count, shape = part
    z = fused(offset, spread(per_half), spread(-1.0))
    total = spread(far[NODES - 1])
    for n in range(NODES - 2, -1, -1):
        total = fused(total, z, spread(far[n]))
    size = len(near) // 4
    two, none = spread(2.0), spread(0.0)
    for n in range(count):
        s = (offset + spread(near[AGE * size + n])) * spread(near[INVERSE * size + n])
        u = larger(smaller(s, two - s), none)
        total = fused(spread(near[SHARE * size + n]), _fraction(u, shape), total)
    return total


@compiled_bare
def force_in_cell(offset: float, part: Part) -> float:
    """Return G in uN at one offset (um) in a gathered cell."""
    per_half, far, near, count, shape = part
    z = offset * per_half - 1.0
    total = far[NODES - 1]
    for n in range(NODES - 2, -1, -1):
        total = total * z + far[n]
    size = len(near) // 4
    for n in range(count):
        s = (offset + near[AGE * size + n]) * near[INVERSE * size + n]
        total += near[SHARE * size + n] * area_over_square(shape, 1.0 - s, 0.0)
    return total


@inlined
def _integral(s: Any, shape: int) -> Any:
    """Return int_0^s of the area over d^2 in lanes; s is the age over d."""
    one, two, none = spread(1.0), spread(2.0), spread(0.0)
    u = larger(smaller(s, two - s), none)
    if shape == LENS_SHAPE:
        rise = ((u * u) * root(u)) * polynomial(_LENS_INTEGRAL, u)
        return where_above(one, s, spread(2.0 / 3.0) - rise, rise)
    if shape == PARABOLA_SHAPE:
        rise = ((u * u) * (one - u * spread(1.0 / 3.0))) * spread(_QUARTER_TURN)
        return where_above(one, s, spread(_FOUR_THIRDS * _QUARTER_TURN) - rise, rise)
    rise = (u * u) * spread(0.5 * _QUARTER_TURN)
    return where_above(one, s, spread(_QUARTER_TURN) - rise, rise)


@compiled_bare
def force_and_integral(
    lives: Lives, shape: int, origin: float, begin: float, end: float, guess: int, work: Doubles
) -> tuple[float, float]:
    """Return G at origin + end (uN) and int G ds from origin + begin to there (uN um), also across births and deaths.

    guess: about how many lives are born before.
    """
    birth, diameter, inverse, weight, reach = lives
    high = near_index(birth, origin + max(begin, end), guess)
    low = near_index(reach, origin + min(begin, end), high)
    force, integral = 0.0, 0.0
    start, stop, place = spread(begin), spread(end), spread(origin)
    two, none = spread(2.0), spread(0.0)
    for row in range(low, high, NODES):
        age, per_size = place - load(birth, row), load(inverse, row)
        before, after = (age + start) * per_size, (age + stop) * per_size
        u = larger(smaller(after, two - after), none)
        share = load(weight, row)
        store(work, 0, share * _fraction(u, shape))
        store(work, NODES, share * load(diameter, row) * (_integral(after, shape) - _integral(before, shape)))
        for n in range(min(NODES, high - row)):
            force += work[n]
            integral += work[NODES + n]
    return force, integral


@inlined
def merged(moments: Doubles, first: int, cells: int) -> tuple[float, float, float]:
    """Return the three moments over ``cells`` cells as one; their number is a power of two."""
    mean, slope, bend = 0.0, 0.0, 0.0
    part = 1.0 / cells
    for n in range(cells):
        a, b, c = moments[0, first + n], moments[1, first + n], moments[2, first + n]
        o = float(2 * n + 1 - cells)
        mean += a
        slope += (b + o * a) * part
        bend += ((c + 3.0 * o * b + 0.5 * (3.0 * o * o + 1.0) * a) * part) * part - 0.5 * a
    return mean * part, slope * part, bend * part
