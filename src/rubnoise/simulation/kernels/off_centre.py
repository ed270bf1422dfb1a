"""Lenses off the centre line: two circles that pass at a lateral offset b, position by position and by quadrature.

A life of 2h, h = sqrt(d^2 - b^2), has the area d^2 L(r) with r = sqrt(x^2 + b^2)/d and x = s - h. With u = 1 - r it is
u^1.5 times the polynomial of the centred lens, and costs one root more. Its integrals over a cell have no closed form.

The moments come from Gauss-Legendre nodes. Far from the ends of a life, and from the turn of its area at x = 0, which
is the sharper the smaller b, three nodes in a cell are enough. What all lives have there is summed at the nodes, and
its moments are worked out once. Near the ends there are five nodes in w = sqrt(s), s from the nearer end, in which the
area is smooth. Cells close to the turn, and those of short lives, are cut up one by one towards x = 0.
"""

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_bare, inlined
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
from rubnoise.simulation.kernels.lens import AREA_COEFFICIENTS, horner

# Gauss-Legendre on [0, 1]: for cells far from everything, near an end, and cut up.
_FAR_NODES = (0.1127016653792583, 0.5, 0.8872983346207417)
_ODD = 0.21516574145596762  # 5/18 of the root of 3/5
_NODES = (0.04691007703066802, 0.23076534494715845, 0.5, 0.7692346550528415, 0.9530899229693319)
_WEIGHTS = (0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324, 0.11846344252809454)
_FINE_NODES = (
    0.019855071751231884, 0.10166676129318664, 0.2372337950418355, 0.4082826787521751,
    0.5917173212478249, 0.7627662049581645, 0.8983332387068134, 0.9801449282487681,
)  # fmt: skip
_FINE_WEIGHTS = (
    0.05061426814518813, 0.11119051722668724, 0.15685332293894363, 0.18134189168918100,
    0.18134189168918100, 0.15685332293894363, 0.11119051722668724, 0.05061426814518813,
)  # fmt: skip

SHORT = 12.0
"""Cells in half of a life below which every cell of it is cut up."""

FAR = 16.0
"""Cells from the ends of a life, and from a turn that is sharper than this, beyond which a cell is far."""

NEAR = 3.5
"""Cells between the middle of a cell and the turn at x = 0, y = b below which the cell is cut up."""

_SHARPEST = 2.0**-24
"""Of half a life: how far from mid-life cells are cut at most."""


@compiled
def peak_areas(diameter: Doubles, offset: Doubles) -> Doubles:
    """Return the areas at mid-life in um^2, d^2 L(|b|/d), of diameters and offsets in um."""
    peak = np.empty_like(diameter)
    for row in range(len(diameter)):
        u = 1.0 - abs(offset[row]) / diameter[row]
        peak[row] = diameter[row] * diameter[row] * (u * np.sqrt(u) * horner(AREA_COEFFICIENTS, u))
    return peak


@compiled_bare
def deposit_areas(
    position: Doubles,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    offset: Doubles,
    half_life: Doubles,
    departure: Doubles,
    weight: Doubles,
    total: Doubles,
) -> None:
    """Add the weighted area fractions of lives at the positions from the index ``begin`` to ``end``.

    position (um), increasing and evenly spaced, eight more at least on either side. birth, diameter, offset, half_life,
    departure (um) and weight: one a junction, in order of birth; a life counts while birth <= s < departure.
    """
    places = position[begin:end]
    per_um = per_um_of(places)
    one, nothing = spread(1.0), spread(0.0)
    for row in range(len(birth)):
        born, half, left, inverse_size = birth[row], half_life[row], departure[row], 1.0 / diameter[row]
        first = begin + first_near(places, per_um, born)
        last = begin + first_near(places, per_um, min(left, born + 2.0 * half))
        across = offset[row] * inverse_size
        birth_at, rise, inverse, aside = spread(born), spread(half), spread(inverse_size), spread(across * across)
        share, ending = spread(weight[row]), spread(left)
        for at in range(first, last, WIDTH):
            place = load(position, at)
            x = ((place - birth_at) - rise) * inverse
            u = larger(one - root(fused(x, x, aside)), nothing)
            there = where_above(place, ending, share, nothing)
            store(total, at, fused(there * (u * root(u)), polynomial(AREA_COEFFICIENTS, u), load(total, at)))


@compiled_bare
def deposit_moments(
    position: Doubles,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    offset: Doubles,
    half_life: Doubles,
    departure: Doubles,
    weight: Doubles,
    at_nodes: Doubles,
    moments: Doubles,
) -> None:
    """Add the Legendre moments of weighted area fractions over the cells that end at some positions.

    Rows as in `deposit_areas`; index 0 is a multiple of eight spacings from the start of the run. moments and at_nodes
    (3 x positions, flat), both zero: moments receives int sum w a P_i(2y - 1) ds over the spacing for the cells that
    end at the positions from the index ``begin`` to ``end``. at_nodes is for sums at the nodes of far cells, and zero
    again afterwards.
    """
    places = position[begin - 1 : end]
    per_um = per_um_of(places)
    size = len(moments) // 3
    far, near = FAR * spacing, NEAR * spacing
    for row in range(len(birth)):
        born, half, width = birth[row], half_life[row], diameter[row]
        age = min(departure[row] - born, 2.0 * half)
        # A cell ends behind the birth, and begins before the end.
        first = max(begin - 1 + first_near(places, per_um, born), begin)
        last = min(begin + first_near(places, per_um, born + age), end)
        short, aside = half < SHORT * spacing, offset[row] * offset[row]
        if not short:
            # By eights that lie where they do however a run is cut.
            for at in range(first // WIDTH * WIDTH, last, WIDTH):
                low, high = position[at - 1] - born, position[at + WIDTH - 1] - born
                smooth = aside >= far * far or low - half >= far or half - high >= far
                if smooth and low >= far and 2.0 * half - high >= far and high <= age:
                    _add_at_nodes(position, at, born, half, width, offset[row], weight[row], size, at_nodes)
                else:
                    _add_eight(
                        position, spacing, at, born, half, width, aside, near * near, age, weight[row], size, moments
                    )
        if short or aside < near * near:
            for cell in range(first, last):
                low, high = position[cell - 1] - born, position[cell] - born
                x = 0.5 * (low + high) - half
                if short or x * x + aside < near * near:
                    _add_cut_up(cell, low, high, spacing, half, width, aside, age, weight[row], size, moments)
    _add_from_nodes(position, spacing, begin, end, size, at_nodes, moments)
    at_nodes[:] = 0.0


@inlined
def _add_at_nodes(
    position: Doubles,
    at: int,
    born: float,
    half: float,
    diameter: float,
    offset: float,
    weight: float,
    size: int,
    at_nodes: Doubles,
) -> None:
    """Add the area of a life at the nodes of eight cells."""
    inverse_size = 1.0 / diameter
    across = offset * inverse_size
    one, inverse, aside, share = spread(1.0), spread(inverse_size), spread(across * across), spread(weight)
    low, high = load(position, at - 1) - spread(born), load(position, at) - spread(born)
    step, begin = high - low, low - spread(half)
    for node in range(len(_FAR_NODES)):
        x = fused(step, spread(_FAR_NODES[node]), begin) * inverse
        u = one - root(fused(x, x, aside))
        place = node * size + at
        area = (share * (u * root(u))) * polynomial(AREA_COEFFICIENTS, u)
        store(at_nodes, place, load(at_nodes, place) + area)


@inlined
def _add_from_nodes(
    position: Doubles, spacing: float, begin: int, end: int, size: int, at_nodes: Doubles, moments: Doubles
) -> None:
    """Add the moments of what has been summed at the nodes of cells."""
    for at in range(begin, end, WIDTH):
        low, middle, high = load(at_nodes, at), load(at_nodes, size + at), load(at_nodes, 2 * size + at)
        part = (load(position, at) - load(position, at - 1)) / spread(spacing)
        both = low + high
        mean = fused(both, spread(5.0 / 18.0), middle * spread(4.0 / 9.0))
        bend = (both - spread(2.0) * middle) * spread(1.0 / 9.0)
        store(moments, at, fused(part, mean, load(moments, at)))
        store(moments, size + at, fused(part, (high - low) * spread(_ODD), load(moments, size + at)))
        store(moments, 2 * size + at, fused(part, bend, load(moments, 2 * size + at)))


@inlined
def _add_eight(
    position: Doubles,
    spacing: float,
    at: int,
    born: float,
    half: float,
    diameter: float,
    squared_offset: float,
    squared_reach: float,
    age: float,
    weight: float,
    size: int,
    moments: Doubles,
) -> None:
    """Add a life to eight cells, but for those that are close to the turn.

    A cell behind mid-life is seen in a mirror: ages count backwards from the death, and the odd moment changes sign.
    """
    inverse_size = 1.0 / diameter
    one, nothing, two, middle = spread(1.0), spread(0.0), spread(2.0), spread(0.5)
    birth, rise, life, ending = spread(born), spread(half), spread(2.0 * half), spread(age)
    inverse, aside, beside = spread(inverse_size), spread(squared_offset), spread(squared_reach)
    turn = spread(squared_offset * inverse_size * inverse_size)
    share = spread(2.0 * weight / spacing)
    low, high = load(position, at - 1) - birth, load(position, at) - birth
    x = middle * (low + high) - rise
    # Either half of a life from its own end: from the cell's edge that is nearer to it.
    edge = where_above(nothing, x, life - high, low)
    begin = larger(where_above(nothing, x, life - smaller(high, ending), low), nothing)
    end = larger(where_above(nothing, x, life - low, smaller(high, ending)), begin)
    root_of_begin = root(begin)
    step = root(end) - root_of_begin
    per_width = two / (high - low)
    mean, slope, bend = nothing, nothing, nothing
    for node in range(len(_NODES)):
        w = fused(step, spread(_NODES[node]), root_of_begin)
        s = w * w
        along = (s - rise) * inverse
        u = larger(one - root(fused(along, along, turn)), nothing)
        part = (spread(_WEIGHTS[node]) * w) * ((u * root(u)) * polynomial(AREA_COEFFICIENTS, u))
        y = (s - edge) * per_width - one
        mean = mean + part
        slope = fused(part, y, slope)
        bend = fused(part, y * y, bend)
    factor = where_above(x * x + aside, beside, nothing, share * step)
    mirror = where_above(nothing, x, spread(-1.0), one)
    mean_at, slope_at, bend_at = at, size + at, 2 * size + at
    store(moments, mean_at, fused(factor, mean, load(moments, mean_at)))
    store(moments, slope_at, fused(factor * mirror, slope, load(moments, slope_at)))
    store(moments, bend_at, fused(factor, spread(1.5) * bend - middle * mean, load(moments, bend_at)))


@compiled_bare
def _add_cut_up(
    cell: int,
    low: float,
    high: float,
    spacing: float,
    half: float,
    diameter: float,
    squared_offset: float,
    age: float,
    weight: float,
    size: int,
    moments: Doubles,
) -> None:
    """Add a life to the cell between two ages (um): either half from far to near mid-life, in ever shorter pieces."""
    begin, end = max(low, 0.0), min(high, age)
    offset = np.sqrt(squared_offset)
    least = max(offset, _SHARPEST * half)
    for falling in range(2):
        if falling:
            near, far, edge = max(begin - half, 0.0), end - half, 2.0 * half - high
        else:
            near, far, edge = max(half - end, 0.0), half - begin, low
        while far > near:
            piece = max(near, 0.5 * far) if far > least else near
            mean, slope, bend = 0.0, 0.0, 0.0
            root_of_begin = np.sqrt(max(half - far, 0.0))
            step = np.sqrt(half - piece) - root_of_begin
            for node in range(len(_FINE_NODES)):
                w = root_of_begin + step * _FINE_NODES[node]
                along = (w * w - half) / diameter
                u = max(1.0 - np.sqrt(along * along + squared_offset / (diameter * diameter)), 0.0)
                part = _FINE_WEIGHTS[node] * w * (u * np.sqrt(u) * horner(AREA_COEFFICIENTS, u))
                y = 2.0 * (w * w - edge) / (high - low) - 1.0
                mean += part
                slope += part * y
                bend += part * (1.5 * (y * y) - 0.5)
            factor = 2.0 * weight / spacing * step
            moments[cell] += factor * mean
            moments[size + cell] += (-factor if falling else factor) * slope
            moments[2 * size + cell] += factor * bend
            far = piece
