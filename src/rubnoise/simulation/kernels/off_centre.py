"""Lenses off the centre line: two circles that pass at a lateral offset b, position by position and by quadrature.

A life of 2h, h = sqrt(d^2 - b^2), has the area d^2 L(r) with r = sqrt(x^2 + b^2)/d and x = s - h. With u = 1 - r it is
u^1.5 times the polynomial of the centred lens, and costs one root more. Its integrals over a cell have no closed form.

Far from the ends of a life and from the turn of its area at x = 0, the series of `off_centre_series` are used. The turn
is the sharper the smaller b is. Everywhere else the moments come from Gauss-Legendre nodes: five or six in each cell,
in w = sqrt(s), with s from the nearer end, because the area is smooth in w. Cells close to the turn, and cells of short
lives, are cut into ever shorter pieces towards x = 0, with eight nodes in each piece.
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
    summed,
    where_above,
)
from rubnoise.simulation.kernels.lens import AREA_COEFFICIENTS, horner
from rubnoise.simulation.kernels.off_centre_series import is_alone, panels_alone, panels_of
from rubnoise.simulation.kernels.taylor import PANEL

# Gauss-Legendre on [0, 1], nodes and weights: for a cell, for one in a life of few cells, for the pieces of a cut cell.
_FIVE = (
    (0.04691007703066802, 0.23076534494715845, 0.5, 0.7692346550528415, 0.9530899229693319),
    (0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324, 0.11846344252809454),
)
_SIX = (
    (0.033765242898423975, 0.16939530676686776, 0.38069040695840156, 0.6193095930415985, 0.8306046932331322,
     0.966234757101576),
    (0.08566224618958525, 0.18038078652406928, 0.23395696728634546, 0.23395696728634546, 0.18038078652406928,
     0.08566224618958525),
)  # fmt: skip
FINE_NODES = np.array((
    0.019855071751231884, 0.10166676129318664, 0.2372337950418355, 0.4082826787521751,
    0.5917173212478249, 0.7627662049581645, 0.8983332387068134, 0.9801449282487681,
    0.05061426814518813, 0.11119051722668724, 0.15685332293894363, 0.18134189168918100,
    0.18134189168918100, 0.15685332293894363, 0.11119051722668724, 0.05061426814518813,
))  # fmt: skip
"""Eight nodes and their weights: each lane has a node, so that a piece goes through every operation at once."""

SHORT, FEW = 6.0, 24.0
"""Numbers of cells in half a life: below SHORT every cell is cut up, below FEW a cell takes six nodes, not five.

A life below FEW has no series, because a series with the panels at its ends takes at least 24 cells."""

NEAR = 3.5
"""Distance in cells between the middle of a cell and the turn at x = 0, y = b; below it the cell is cut up."""

_ABOUT = 6
"""Cells on either side of mid-life that may be close to the turn."""

_SHARPEST = 2.0**-24
"""Distance from mid-life, relative to half a life, at which cutting stops at the latest."""


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
    origin: int,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    offset: Doubles,
    half_life: Doubles,
    departure: Doubles,
    weight: Doubles,
    finest: float,
    total: Doubles,
) -> None:
    """Add the weighted area fractions of lives at the positions from the index ``begin`` to ``end``.

    position (um): from ``origin`` spacings on, with at least eight more on either side. birth, diameter, offset,
    half_life, departure (um) and weight: one per junction, in order of birth; a life counts while
    birth <= s < departure. finest: the diameter (um) from which on a whole life's panels with series are left out.
    """
    places = position[begin:end]
    per_um, per_spacing = per_um_of(places), 1.0 / spacing
    for row in range(len(birth)):
        born, half, left = birth[row], half_life[row], departure[row]
        inverse, share = 1.0 / diameter[row], weight[row]
        across = offset[row] * inverse
        death = born + 2.0 * half
        panels = panels_of(born * per_spacing, half * per_spacing, abs(offset[row]) * per_spacing)
        if diameter[row] < finest or left < death or is_alone(panels):
            first = begin + first_near(places, per_um, born)
            last = begin + first_near(places, per_um, min(left, death))
            _add_areas(position, first, last, born, half, inverse, across, left, share, total)
        else:
            for n in range(3):
                low, high = panels_alone(n, panels)
                first = PANEL * low + 1 - origin
                first += max(begin - first, 0) // WIDTH * WIDTH
                last = min(PANEL * high + 1 - origin, end)
                _add_areas(position, first, last, born, half, inverse, across, left, share, total)


@inlined
def _add_areas(
    position: Doubles,
    first: int,
    last: int,
    born: float,
    half: float,
    inverse_size: float,
    across: float,
    departure: float,
    weight: float,
    total: Doubles,
) -> None:
    one, nothing = spread(1.0), spread(0.0)
    birth, rise, inverse, aside = spread(born), spread(half), spread(inverse_size), spread(across * across)
    share, ending = spread(weight), spread(departure)
    for at in range(first, last, WIDTH):
        place = load(position, at)
        x = ((place - birth) - rise) * inverse
        u = larger(one - root(fused(x, x, aside)), nothing)
        there = where_above(place, ending, share, nothing)
        store(total, at, fused(there * (u * root(u)), polynomial(AREA_COEFFICIENTS, u), load(total, at)))


@compiled_bare
def deposit_moments(
    position: Doubles,
    origin: int,
    spacing: float,
    begin: int,
    end: int,
    birth: Doubles,
    diameter: Doubles,
    offset: Doubles,
    half_life: Doubles,
    departure: Doubles,
    weight: Doubles,
    nodes: Doubles,
    moments: Doubles,
) -> None:
    """Add the Legendre moments of weighted area fractions over cells, except in panels with series.

    Rows as in `deposit_areas`; index 0 is a multiple of eight spacings from the start of the run. moments (3 x
    positions, flat) receives int sum w a P_i(2y - 1) ds over the spacing for the cells that end at the positions from
    the index ``begin`` to ``end``. nodes: `FINE_NODES`.
    """
    places = position[begin - 1 : end]
    per_um, near = per_um_of(places), NEAR * spacing
    for row in range(len(birth)):
        born, half, width, share = birth[row], half_life[row], diameter[row], weight[row]
        aside = offset[row] * offset[row]
        age = min(departure[row] - born, 2.0 * half)
        # A cell ends behind the birth, and begins before the end.
        first = max(begin - 1 + first_near(places, per_um, born), begin)
        last = min(begin + first_near(places, per_um, born + age), end)
        short = half < SHORT * spacing
        if not short:
            _add_cells(
                position, origin, spacing, first, last, born, half, width, offset[row], departure[row], share, moments
            )
            if aside >= near * near:
                continue
            middle = begin - 1 + first_near(places, per_um, born + half)
            first, last = max(first, middle - _ABOUT), min(last, middle + _ABOUT)
        for cell in range(first, last):
            low, high = position[cell - 1] - born, position[cell] - born
            x = 0.5 * (low + high) - half
            if short or x * x + aside < near * near:
                _add_cut_up(cell, low, high, spacing, half, width, aside, age, share, nodes, moments)


@inlined
def _add_cells(
    position: Doubles,
    origin: int,
    spacing: float,
    first: int,
    last: int,
    born: float,
    half: float,
    diameter: float,
    offset: float,
    departure: float,
    weight: float,
    moments: Doubles,
) -> None:
    """Add a life to its cells from the first to the last, except those that are close to the turn or have series."""
    per_spacing, death = 1.0 / spacing, born + 2.0 * half
    panels = panels_of(born * per_spacing, half * per_spacing, abs(offset) * per_spacing)
    age = min(departure - born, 2.0 * half)
    if half < FEW * spacing:
        for at in range(first, last, WIDTH):
            _add_eight(_SIX, position, spacing, at, born, half, diameter, offset, age, weight, moments)
    elif departure < death or is_alone(panels):
        for at in range(first, last, WIDTH):
            _add_eight(_FIVE, position, spacing, at, born, half, diameter, offset, age, weight, moments)
    else:
        for n in range(3):
            bottom, top = panels_alone(n, panels)
            start = PANEL * bottom + 1 - origin
            start += max(first - start, 0) // WIDTH * WIDTH
            for at in range(start, min(PANEL * top + 1 - origin, last), WIDTH):
                _add_eight(_FIVE, position, spacing, at, born, half, diameter, offset, age, weight, moments)


@inlined
def _add_eight(
    rule: tuple[tuple[float, ...], tuple[float, ...]],
    position: Doubles,
    spacing: float,
    at: int,
    born: float,
    half: float,
    diameter: float,
    offset: float,
    age: float,
    weight: float,
    moments: Doubles,
) -> None:
    """Add a life to eight cells, except those that are close to the turn.

    A cell behind mid-life is mirrored: ages count backwards from the death, and the odd moment changes its sign.
    """
    inverse_size, squared_offset = 1.0 / diameter, offset * offset
    one, nothing, two, middle = spread(1.0), spread(0.0), spread(2.0), spread(0.5)
    birth, rise, life, ending = spread(born), spread(half), spread(2.0 * half), spread(age)
    inverse, aside, beside = spread(inverse_size), spread(squared_offset), spread(NEAR * spacing * (NEAR * spacing))
    turn = spread(squared_offset * inverse_size * inverse_size)
    share = spread(2.0 * weight / spacing)
    low, high = load(position, at - 1) - birth, load(position, at) - birth
    x = middle * (low + high) - rise
    # Each half of a life is measured from its own end, and a place in the cell from the edge nearer to that end.
    edge = where_above(nothing, x, life - high, low)
    begin = larger(where_above(nothing, x, life - smaller(high, ending), low), nothing)
    end = larger(where_above(nothing, x, life - low, smaller(high, ending)), begin)
    root_of_begin = root(begin)
    step = root(end) - root_of_begin
    per_width = two / (high - low)
    mean, slope, bend = nothing, nothing, nothing
    nodes, weights = rule
    for node in range(len(nodes)):
        w = fused(step, spread(nodes[node]), root_of_begin)
        s = w * w
        along = (s - rise) * inverse
        u = larger(one - root(fused(along, along, turn)), nothing)
        part = (spread(weights[node]) * w) * ((u * root(u)) * polynomial(AREA_COEFFICIENTS, u))
        y = (s - edge) * per_width - one
        mean = mean + part
        slope = fused(part, y, slope)
        bend = fused(part, y * y, bend)
    factor = where_above(x * x + aside, beside, nothing, share * step)
    mirror = where_above(nothing, x, spread(-1.0), one)
    size = len(moments) // 3
    mean_at, slope_at, bend_at = at, size + at, 2 * size + at
    store(moments, mean_at, fused(factor, mean, load(moments, mean_at)))
    store(moments, slope_at, fused(factor * mirror, slope, load(moments, slope_at)))
    store(moments, bend_at, fused(factor, spread(1.5) * bend - middle * mean, load(moments, bend_at)))


@inlined
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
    nodes: Doubles,
    moments: Doubles,
) -> None:
    """Add a life to the cell between two ages (um): each half from far to near mid-life, in ever shorter pieces."""
    one, nothing, rise, inverse = spread(1.0), spread(0.0), spread(half), spread(1.0 / diameter)
    turn, per_width = spread(squared_offset / (diameter * diameter)), spread(2.0 / (high - low))
    node, node_weight = load(nodes, 0), load(nodes, WIDTH)
    begin, end = max(low, 0.0), min(high, age)
    least = max(np.sqrt(squared_offset), _SHARPEST * half)
    means, slopes, bends = nothing, nothing, nothing
    for falling in range(2):
        if falling:
            near, far, edge, odd = max(begin - half, 0.0), end - half, 2.0 * half - high, spread(-1.0)
        else:
            near, far, edge, odd = max(half - end, 0.0), half - begin, low, one
        while far > near:
            piece = max(near, 0.5 * far) if far > least else near
            root_of_begin = np.sqrt(max(half - far, 0.0))
            step = np.sqrt(half - piece) - root_of_begin
            w = fused(spread(step), node, spread(root_of_begin))
            s = w * w
            along = (s - rise) * inverse
            u = larger(one - root(fused(along, along, turn)), nothing)
            part = ((spread(step) * node_weight) * w) * ((u * root(u)) * polynomial(AREA_COEFFICIENTS, u))
            y = (s - spread(edge)) * per_width - one
            means = means + part
            slopes = fused(odd * part, y, slopes)
            bends = fused(part, y * y, bends)
            far = piece
    size, factor, mean = len(moments) // 3, 2.0 * weight / spacing, summed(means)
    moments[cell] += factor * mean
    moments[size + cell] += factor * summed(slopes)
    moments[2 * size + cell] += factor * (1.5 * summed(bends) - 0.5 * mean)
