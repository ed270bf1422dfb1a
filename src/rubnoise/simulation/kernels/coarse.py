"""Lenses position by position, eight positions together: for lives of few positions, and for those ended early.

The area and its running integrals J1, J2, J3 are computed at each position of a life from the polynomials of
`rubnoise.simulation.kernels.lens`; the moments over a cell are differences of the integrals. Lives come in order of
birth, so the cells before a birth are complete, and their moments are computed while the integrals are in the cache.
"""

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, inlined
from rubnoise.simulation.kernels.grid import first_near, per_um_of
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
from rubnoise.simulation.kernels.lens import (
    AREA_COEFFICIENTS,
    FIRST_INTEGRAL_COEFFICIENTS,
    SECOND_INTEGRAL_COEFFICIENTS,
    THIRD_INTEGRAL_COEFFICIENTS,
    THIRD_INTEGRAL_PEAK,
    horner,
)

AT_ONCE = 1024
"""Cells whose moments are computed at a time: few enough for the integrals to stay in the processor's cache."""


@compiled_bare
def deposit_coarse_lives(
    position: Doubles,
    unit: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    departure: Doubles,
    weight: Doubles,
    gathered: Doubles,
    total: Doubles,
    moments: Doubles,
    added: int,
) -> None:
    """Add the weighted area fractions of lives at positions, and their moments over the cells that end there.

    position (um), increasing and evenly spaced: lives are added at the indices from ``begin`` to ``end``, and at least
    eight more positions follow. birth, diameter, departure (um) and weight: one per junction, in order of birth; a life
    counts while birth <= s < departure, and departure is infinite unless it was ended early. total receives sum w a;
    moments (3 x positions, flat) the Legendre moments of it over the cell that ends at a position, divided by ``unit``
    (um); either may be empty. added: 1 to add to the moments, 0 to overwrite them. gathered: six times as long as
    position if moments are wanted; it must be zero, and is zero again afterwards.
    """
    edge = begin - 1 if len(moments) > 0 else begin
    edges = position[edge:end]
    per_um = per_um_of(edges)
    # Of the cells from the index ``base`` on, those up to ``high`` have integrals in them.
    base, high = edge, edge
    for row in range(len(birth)):
        born, width, left = birth[row], diameter[row], departure[row]
        first = edge + first_near(edges, per_um, born)
        last = edge + first_near(edges, per_um, min(left, born + 2.0 * width))
        inverse = 1.0 / width
        if len(total) > 0:
            _add_areas(position, first, last, born, inverse, left, weight[row], total)
        if len(moments) > 0:
            if first - base > AT_ONCE:
                done = _work_out(position, unit, base, first, gathered, moments, added)
                base, high = _keep(base, done - 1, high, gathered)
            high = max(high, last + WIDTH)
            scale = weight[row] / (width * width) * width * width * width
            _add_integrals(position, first, last, base, born, width, inverse, left, scale, gathered)
            middle = max(first, edge + first_near(edges, per_um, born + width) - 1)
            _pass_mid_life(position, edge, end, middle, base, born, width, inverse, left, scale, gathered)
            if left < born + 2.0 * width:
                _end_early(position, edge, end, last, base, born, width, inverse, left, scale, gathered)
    if len(moments) > 0:
        done = _work_out(position, unit, base, end, gathered, moments, added)
        for cell in range(done, end):
            _work_out_cell(position, unit, cell, base, gathered, moments, added)
        _keep(base, high, high, gathered)


@inlined
def _keep(base: int, new_base: int, high: int, gathered: Doubles) -> tuple[int, int]:
    """Move the gathered integrals from the cell ``new_base`` on to the beginning, and set the rest to zero."""
    size = len(gathered) // 6
    shift, kept = new_base - base, max(high - new_base, 0)
    for n in range(6):
        row = gathered[n * size : (n + 1) * size]
        for at in range(kept):
            row[at] = row[at + shift]
        row[kept : max(high - base, kept)] = 0.0
    return new_base, max(high, new_base)


@inlined
def _add_areas(
    position: Doubles,
    first: int,
    last: int,
    born: float,
    inverse_size: float,
    departure: float,
    weight: float,
    total: Doubles,
) -> None:
    birth, inverse, two, nothing = spread(born), spread(inverse_size), spread(2.0), spread(0.0)
    share, end = spread(weight), spread(departure)
    for at in range(first, last, WIDTH):
        place = load(position, at)
        s = (place - birth) * inverse
        u = larger(smaller(s, two - s), nothing)
        alive = where_above(place, end, share, nothing)
        store(total, at, fused(alive * (u * root(u)), polynomial(AREA_COEFFICIENTS, u), load(total, at)))


@inlined
def _add_integrals(
    position: Doubles,
    first: int,
    last: int,
    base: int,
    born: float,
    size: float,
    inverse_size: float,
    departure: float,
    scale: float,
    gathered: Doubles,
) -> None:
    """Add the running integrals; those of the falling half lack a part, which `_pass_mid_life` adds."""
    birth, inverse, one, two, nothing = spread(born), spread(inverse_size), spread(1.0), spread(2.0), spread(0.0)
    rising, falling, length, end = spread(scale), spread(-scale), spread(size), spread(departure)
    count = len(gathered) // 6
    for at in range(first - base, last - base, WIDTH):
        place = load(position, base + at)
        s = (place - birth) * inverse
        u = larger(smaller(s, two - s), nothing)
        reach = length * u
        power = where_above(place, end, u * u * root(u), nothing)
        weight = where_above(one, s, falling, rising) * power
        second = (rising * power) * reach
        third = weight * reach * reach
        store(gathered, at, fused(weight, polynomial(FIRST_INTEGRAL_COEFFICIENTS, u), load(gathered, at)))
        at2, at3 = count + at, 2 * count + at
        store(gathered, at2, fused(second, polynomial(SECOND_INTEGRAL_COEFFICIENTS, u), load(gathered, at2)))
        store(gathered, at3, fused(third, polynomial(THIRD_INTEGRAL_COEFFICIENTS, u), load(gathered, at3)))


@compiled_bare
def _pass_mid_life(
    position: Doubles,
    begin: int,
    end: int,
    cell: int,
    base: int,
    born: float,
    size: float,
    inverse: float,
    departure: float,
    scale: float,
    gathered: Doubles,
) -> None:
    """Add the part that the integrals of the falling half lack, in the first cell from ``cell`` on that ends in it.

    The integrals are I1 = 2/3 - J1 and, with t = s - 1, I2 = 2/3 t + J2 and I3 = 2 J3(1) + t^2/3 - J3.
    """
    while cell < end and (position[cell] - born) * inverse <= 1.0:
        cell += 1
    # The same expression decides everywhere in which half a place lies, or rounding could put mid-life into both.
    if cell <= begin or cell >= end or (departure - born) * inverse <= 1.0:
        return
    if (position[cell - 1] - born) * inverse > 1.0:
        return
    after = position[cell] - born - size
    third = 2.0 * THIRD_INTEGRAL_PEAK * size * size + after * after / 3.0
    _add_to_cell(position, cell, base, scale * 2.0 / 3.0, scale * 2.0 / 3.0 * after, scale * third, gathered)


@compiled_bare
def _end_early(
    position: Doubles,
    begin: int,
    end: int,
    cell: int,
    base: int,
    born: float,
    size: float,
    inverse: float,
    departure: float,
    scale: float,
    gathered: Doubles,
) -> None:
    """Continue the integrals of a life that was ended early from its departure to the end of that cell."""
    if cell <= begin or cell >= end or departure <= born:
        return
    s = (departure - born) * inverse
    u = max(min(s, 2.0 - s), 0.0)
    weight = scale * (u * u * np.sqrt(u))
    sign = 1.0 if s <= 1.0 else -1.0
    first = sign * (weight * horner(FIRST_INTEGRAL_COEFFICIENTS, u))
    second = size * (weight * (u * horner(SECOND_INTEGRAL_COEFFICIENTS, u)))
    third = sign * (size * size * (weight * (u * u * horner(THIRD_INTEGRAL_COEFFICIENTS, u))))
    rest = position[cell] - departure
    i2 = second + first * rest
    i3 = third + second * rest + 0.5 * first * rest * rest
    _add_to_cell(position, cell, base, first, i2, i3, gathered)


@inlined
def _add_to_cell(position: Doubles, cell: int, base: int, i1: float, i2: float, i3: float, gathered: Doubles) -> None:
    """Add the Legendre moments of a cell at whose end the force integrals are larger than gathered by i1, i2, i3."""
    width = position[cell] - position[cell - 1]
    size, at = len(gathered) // 6, cell - base
    gathered[3 * size + at] += i1
    gathered[4 * size + at] += i1 - 2.0 * i2 / width
    gathered[5 * size + at] += i1 - 6.0 * i2 / width + 12.0 * i3 / (width * width)


@compiled_bare
def _work_out(
    position: Doubles, unit: float, base: int, end: int, gathered: Doubles, moments: Doubles, added: int
) -> int:
    """Compute the moments of complete cells, from after ``base`` to ``end``, eight at a time; return the first left.

    The moments are differences of the integrals at a cell's edges, plus the parts gathered for the cell itself.
    """
    size, count = len(position), len(gathered) // 6
    two, six, twelve, units = spread(2.0), spread(6.0), spread(12.0), spread(unit)
    cell = base + 1
    while cell + WIDTH <= end:
        width = load(position, cell) - load(position, cell - 1)
        at, at2, at3 = cell - base, count + cell - base, 2 * count + cell - base
        low1, low2, low3 = load(gathered, at - 1), load(gathered, at2 - 1), load(gathered, at3 - 1)
        top1, top2, top3 = load(gathered, at), load(gathered, at2), load(gathered, at3)
        mean = top1 - low1
        slope = (top1 + low1) - two * (top2 - low2) / width
        bend = (top1 - low1) - six * (top2 + low2) / width + twelve * (top3 - low3) / (width * width)
        mean = (load(gathered, 3 * count + at) + mean) / units
        slope = (load(gathered, 4 * count + at) + slope) / units
        bend = (load(gathered, 5 * count + at) + bend) / units
        if added:
            mean = load(moments, cell) + mean
            slope = load(moments, size + cell) + slope
            bend = load(moments, 2 * size + cell) + bend
        store(moments, cell, mean)
        store(moments, size + cell, slope)
        store(moments, 2 * size + cell, bend)
        cell += WIDTH
    return cell


@compiled_bare
def _work_out_cell(
    position: Doubles, unit: float, cell: int, base: int, gathered: Doubles, moments: Doubles, added: int
) -> None:
    """Compute the moments of one cell in the same way."""
    size, count = len(position), len(gathered) // 6
    width = position[cell] - position[cell - 1]
    at, at2, at3 = cell - base, count + cell - base, 2 * count + cell - base
    low1, low2, low3 = gathered[at - 1], gathered[at2 - 1], gathered[at3 - 1]
    top1, top2, top3 = gathered[at], gathered[at2], gathered[at3]
    mean = top1 - low1
    slope = (top1 + low1) - 2.0 * (top2 - low2) / width
    bend = (top1 - low1) - 6.0 * (top2 + low2) / width + 12.0 * (top3 - low3) / (width * width)
    mean = (gathered[3 * count + at] + mean) / unit
    slope = (gathered[4 * count + at] + slope) / unit
    bend = (gathered[5 * count + at] + bend) / unit
    if added:
        mean, slope, bend = moments[cell] + mean, moments[size + cell] + slope, moments[2 * size + cell] + bend
    moments[cell], moments[size + cell], moments[2 * size + cell] = mean, slope, bend
