"""The kernel: sums over lives, at evenly spaced places and over the cells between them, for every pulse.

A life adds w a(x), x = (s - b - h)/d, to every place s at which it lives; b is its birth, h half its life, d its
diameter and w its weight. With w = d^2 the sum is the real contact area, with w = psi d^2 the friction force. A life
counts while birth <= s < departure.

Over a cell the sum is needed as three Legendre moments, int_0^1 of it times P_i(2y - 1) dy. They come from its values
at the edges and at one or two places between them (Lobatto's points), as if it were a polynomial. That is wrong where
a life begins, turns or ends. There every life adds the difference between its true moments and those of its values:

- in the first and the last cells of a life: closed forms for u^1.5 (c_0 + c_1 u + c_2 u^2), or for a polynomial;
- in the cell of mid-life: a closed form for the kink;
- in the last cell of a life that was ended early, in all cells of a life of few cells, and where a pass off the
  centre line turns sharply: Gauss nodes in the square root of the distance from the nearer end.

The area of one life is right to 1e-13 d^2. The mean of one over a cell, with two places within, is right to 5e-10, 1e-8
and 2e-7 d^2 at 220, 50 and 20 cells a life, its slope to 5 times and its bend to 100 times this; with one place the
mean is right to 1e-7 at 220. Polynomials, the triangle and the parabola, are right to rounding.

Sums go in order of birth, and what a life adds to a place or cell depends on both alone. So stored values do not depend
on where a run is cut into ranges. Loops over places have one output and the pulse chosen outside, so that the compiler
takes several places at once; it may also fuse a product with a sum.
"""

from functools import cache
from typing import Final

import numpy as np
from numpy.polynomial.legendre import Legendre, legvander
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_within
from rubnoise.contact.pulses import LENS_SERIES, Shape
from rubnoise.simulation.state import LiveRows

LENS_SHAPE, TRIANGLE_SHAPE, PARABOLA_SHAPE, OFF_CENTRE_LENS = range(4)
SHAPES: Final[dict[Shape, int]] = {"lens": LENS_SHAPE, "triangle": TRIANGLE_SHAPE, "parabola": PARABOLA_SHAPE}
"""Number of each pulse shape in compiled code; passes of the lens off the centre line have their own."""

SHORT: Final = 4.0
"""Cells in half a life: below it no series is right in the cells of its birth and death."""

NEAR: Final = 4.0
"""Distance of a pass from the centre line, in cells, below which its turn is too sharp for values at a few places."""

QUARTER_TURN: Final = 0.25 * np.pi

Lives = tuple[Doubles, Doubles, Doubles, Doubles, Doubles, Doubles]
"""Birth, half life and end (um), 1/d, (b/d)^2 for a pass at a distance b from the centre line, and weight."""

Life = tuple[float, float, float, float, float, float]
"""The same of one life."""

Cells = tuple[int, float, Doubles, Doubles, Doubles]
"""Number and width (um) of the first cell, the places in one from 0 to 1, what a value there adds to each moment
(3, places), and the moments (3, cells)."""

Series = tuple[float, float, float]
"""c_0, c_1, c_2 of x^p (c_0 + c_1 x + c_2 x^2), x in cells; p is 3/2 or 1."""


def _gauss(count: int) -> tuple[tuple[float, float], ...]:
    """Return Gauss-Legendre nodes on [0, 1] and their weights."""
    places, weights = np.polynomial.legendre.leggauss(count)
    return tuple(zip((0.5 + 0.5 * places).tolist(), (0.5 * weights).tolist(), strict=True))


GAUSS: Final = _gauss(5)
_OVER_ROOTS: Final = tuple(1.0 / (2.5 + n) for n in range(5))
_OVER_WHOLE: Final = tuple(1.0 / (2.0 + n) for n in range(5))


@compiled_within
def lens_area(u: float) -> float:
    """Return the area over d^2 of a lens, at the distance u <= 1 from the nearer end of its life over d."""
    value = LENS_SERIES[-1]
    for n in range(len(LENS_SERIES) - 2, -1, -1):
        value = value * u + LENS_SERIES[n]
    return u * np.sqrt(u) * value


@compiled_within
def area_over_square(shape: int, x: float, aside: float) -> float:
    """Return the area over d^2 at a distance x d from mid-life; 0 outside the life. aside: (b/d)^2."""
    if shape == OFF_CENTRE_LENS:
        return lens_area(max(1.0 - np.sqrt(x * x + aside), 0.0))
    u = max(1.0 - abs(x), 0.0)
    if shape == TRIANGLE_SHAPE:
        return QUARTER_TURN * u
    if shape == PARABOLA_SHAPE:
        return QUARTER_TURN * u * (2.0 - u)
    return lens_area(u)


@compiled_within
def _add_places(
    shape: int,
    places: Doubles,
    birth: float,
    half: float,
    inverse: float,
    aside: float,
    share: float,
    total: Doubles,
) -> None:
    """Add one life to neighbouring places."""
    if shape == LENS_SHAPE:
        for k in range(len(places)):
            total[k] += share * area_over_square(LENS_SHAPE, (places[k] - birth - half) * inverse, aside)
    elif shape == TRIANGLE_SHAPE:
        for k in range(len(places)):
            total[k] += share * area_over_square(TRIANGLE_SHAPE, (places[k] - birth - half) * inverse, aside)
    elif shape == PARABOLA_SHAPE:
        for k in range(len(places)):
            total[k] += share * area_over_square(PARABOLA_SHAPE, (places[k] - birth - half) * inverse, aside)
    else:
        for k in range(len(places)):
            total[k] += share * area_over_square(OFF_CENTRE_LENS, (places[k] - birth - half) * inverse, aside)


@compiled_within
def first_at_or_after(place: float, spacing: float) -> int:
    """Return the smallest i with i * spacing >= place, as both are rounded."""
    index = int(np.ceil(place / spacing))
    if float(index - 1) * spacing >= place:
        return index - 1
    return index + 1 if float(index) * spacing < place else index


@compiled
def add_areas(shape: int, places: Doubles, origin: int, spacing: float, lives: Lives, total: Doubles) -> None:
    """Add all lives to the places (origin + k) * spacing."""
    birth, half, end, inverse, aside, weight = lives
    for row in range(len(birth)):
        low = min(max(first_at_or_after(birth[row], spacing) - origin, 0), len(places))
        high = min(max(first_at_or_after(end[row], spacing) - origin, low), len(places))
        here, found = places[low:high], total[low:high]
        _add_places(shape, here, birth[row], half[row], inverse[row], aside[row], weight[row], found)


@compiled
def add_cells(shape: int, places: Doubles, lives: Lives, values: Doubles, cells: Cells) -> None:
    """Add all lives to the values at the places within the cells, and what these miss of the moments."""
    origin, spacing, nodes, _, moments = cells
    birth, half, end, inverse, aside, weight = lives
    for row in range(len(birth)):
        begin = min(max(first_at_or_after(birth[row], spacing) - 1 - origin, 0), moments.shape[1])
        stop = min(max(first_at_or_after(end[row], spacing) - origin, begin), moments.shape[1])
        if begin == stop:
            continue
        for n in range(len(values)):
            shift = nodes[n + 1] * spacing
            high = stop if places[stop - 1] + shift < end[row] else stop - 1
            here, found = places[begin:high], values[n, begin:high]
            _add_places(shape, here, birth[row] - shift, half[row], inverse[row], aside[row], weight[row], found)
        life = birth[row], half[row], end[row], inverse[row], aside[row], weight[row]
        if half[row] < SHORT * spacing:
            _add_exactly(shape, origin + begin, origin + stop, life, cells)
        else:
            _add_landmarks(shape, life, cells)


@compiled_within
def _add_landmarks(shape: int, life: Life, cells: Cells) -> None:
    """Add what the values of a long life miss at its birth, its turn and its end."""
    birth, half, end, inverse, aside, weight = life
    spacing, width, middle, death = cells[1], cells[1] * inverse, birth + half, birth + 2.0 * half
    roots = 1 if shape in (LENS_SHAPE, OFF_CENTRE_LENS) else 0
    series, reach = _series_of(shape, width, half * inverse, aside, weight), 1 + roots
    first, turn = int(np.floor(birth / spacing)), int(np.floor(middle / spacing))
    last = int(np.floor(death / spacing)) + 1 - reach  # no cell from here on lacks anything else
    if end < death:
        stop = first_at_or_after(end, spacing)
        last = min(max(last, first + reach), stop - 1)
        _add_exactly(shape, last, stop, life, cells)
        reach = min(reach, last - first)
    else:
        _add_rise(death / spacing, -1, roots, series, reach, cells)
    _add_rise(birth / spacing, 1, roots, series, reach, cells)
    if shape == OFF_CENTRE_LENS:
        if aside < (NEAR * width) * (NEAR * width):
            _add_exactly(shape, max(turn - 3, first + reach), min(turn + 4, last), life, cells)
    elif shape != PARABOLA_SHAPE and turn < last:
        slope = QUARTER_TURN if shape == TRIANGLE_SHAPE else 1.0
        _add_rise(middle / spacing, 1, 0, (-2.0 * weight * width * slope, 0.0, 0.0), 1, cells)


@compiled_within
def _series_of(shape: int, width: float, rise: float, aside: float, weight: float) -> Series:
    """Return how a life begins; cells of ``width`` and ``rise``, half the life, are over the diameter.

    Off the centre line u is rise s (1 - q s - (b/d)^2 s^2/2 ...) at the distance s from an end.
    """
    if shape == TRIANGLE_SHAPE:
        return weight * width * QUARTER_TURN, 0.0, 0.0
    if shape == PARABOLA_SHAPE:
        return 2.0 * weight * width * QUARTER_TURN, -weight * width * width * QUARTER_TURN, 0.0
    q, scale = 0.5 * aside / rise, weight * (width * rise) * np.sqrt(width * rise)
    second = LENS_SERIES[1] * rise - 1.5 * q * LENS_SERIES[0]
    third = (
        LENS_SERIES[2] * rise * rise - 2.5 * LENS_SERIES[1] * rise * q + LENS_SERIES[0] * (0.375 * q * q - 0.75 * aside)
    )
    return scale * LENS_SERIES[0], scale * width * second, scale * width * width * third


@compiled_within
def _add_rise(place: float, way: int, roots: int, series: Series, reach: int, cells: Cells) -> None:
    """Add what the values of a series miss that begins at a place (in cells) and goes up (way 1) or down (-1).

    roots: 1 if p is 3/2, 0 if it is 1.
    """
    origin, _, nodes, _, moments = cells
    c0, c1, c2 = series
    over = _OVER_ROOTS if roots else _OVER_WHOLE
    cell = int(np.floor(place))
    x = cell + 1.0 - place if way > 0 else place - cell
    low0, low1, low2 = 0.0, 0.0, 0.0
    for n in range(reach):
        # int_0^x of f, x f and x^2 f
        power = x * x * (np.sqrt(x) if roots else 1.0)
        high0 = power * (c0 * over[0] + x * (c1 * over[1] + x * c2 * over[2]))
        high1 = power * x * (c0 * over[1] + x * (c1 * over[2] + x * c2 * over[3]))
        high2 = power * x * x * (c0 * over[2] + x * (c1 * over[3] + x * c2 * over[4]))
        at = cell + way * n - origin
        if 0 <= at < moments.shape[1]:
            y0, mean = 1.0 - x, high0 - low0  # y = x' + y0
            first = high1 - low1 + y0 * mean
            second = high2 - low2 + y0 * (high1 - low1 + first)
            slope, bend = 2.0 * first - mean, 6.0 * (second - first) + mean
            for k in range(len(nodes)):
                u = max(nodes[k] - y0, 0.0)
                value = u * (np.sqrt(u) if roots else 1.0) * (c0 + u * (c1 + u * c2))
                mean, slope, bend = _without(value, k, cells, mean, slope, bend)
            _add_moments(at, mean, way * slope, bend, moments)
        low0, low1, low2 = high0, high1, high2
        x += 1.0


@compiled_within
def _add_exactly(shape: int, first: int, stop: int, life: Life, cells: Cells) -> None:
    """Add what the values of a life miss in some cells: its moments by quadrature take their place."""
    origin, spacing, nodes, _, moments = cells
    for cell in range(max(first, origin), min(stop, origin + moments.shape[1])):
        mean, slope, bend = _quadrature(shape, float(cell) * spacing, float(cell + 1) * spacing, life)
        for k in range(len(nodes)):
            place = float(cell + 1) * spacing if k == len(nodes) - 1 else float(cell) * spacing + nodes[k] * spacing
            if place < life[2]:
                value = life[5] * area_over_square(shape, (place - life[0] - life[1]) * life[3], life[4])
                mean, slope, bend = _without(value, k, cells, mean, slope, bend)
        _add_moments(cell - origin, mean, slope, bend, moments)


@compiled_within
def _quadrature(shape: int, low: float, high: float, life: Life) -> tuple[float, float, float]:
    """Return the moments of a life over a cell (um).

    Each half of the life is cut from far to near mid-life, if its pass is off the centre line into ever shorter pieces.
    """
    birth, half, end, inverse, aside, weight = life
    left, right = low - birth - half, min(high, end) - birth - half
    sharp = 0.5 * np.sqrt(aside) / inverse if shape == OFF_CENTRE_LENS else half
    mean, slope, bend, scale = 0.0, 0.0, 0.0, 2.0 * weight / (high - low)
    for way in (-1.0, 1.0):
        near, far = (max(left, 0.0), min(right, half)) if way > 0.0 else (max(-right, 0.0), min(-left, half))
        while far > near:
            piece = max(near, 0.5 * far) if far > sharp else near
            root = np.sqrt(half - far)
            step = np.sqrt(half - piece) - root
            for node, share in GAUSS:
                w = root + step * node
                x = half - w * w
                z = 2.0 * (way * x - left) / (high - low) - 1.0
                part = scale * step * share * w * area_over_square(shape, x * inverse, aside)
                mean, slope, bend = mean + part, slope + part * z, bend + part * (1.5 * z * z - 0.5)
            far = piece
    return mean, slope, bend


@compiled_within
def _without(value: float, k: int, cells: Cells, mean: float, slope: float, bend: float) -> tuple[float, float, float]:
    """Return moments without those of the value at the k-th place of a cell."""
    rule = cells[3]
    return mean - rule[0, k] * value, slope - rule[1, k] * value, bend - rule[2, k] * value


@compiled_within
def _add_moments(cell: int, mean: float, slope: float, bend: float, moments: Doubles) -> None:
    moments[0, cell] += mean
    moments[1, cell] += slope
    moments[2, cell] += bend


@compiled
def add_values(total: Doubles, values: Doubles, rule: Doubles, moments: Doubles) -> None:
    """Add the moments of the values at the edges of the cells and within them."""
    for i in range(3):
        part, low, high = moments[i], rule[i, 0], rule[i, len(values) + 1]
        for k in range(len(part)):
            part[k] += low * total[k] + high * total[k + 1]
        for n in range(len(values)):
            within, share = values[n], rule[i, n + 1]
            for k in range(len(part)):
                part[k] += share * within[k]


@cache
def lobatto(within: int) -> tuple[Doubles, Doubles]:
    """Return the edges and ``within`` places of a cell from 0 to 1, and (3, places) what each adds to the moments."""
    places = np.concatenate([[-1.0], Legendre.basis(within + 1).deriv().roots(), [1.0]])
    rule = np.linalg.inv(legvander(places, within + 1))[:3] / np.array([[1.0], [3.0], [5.0]])
    return 0.5 * (places + 1.0), np.ascontiguousarray(rule)


def _lives(shape: Shape, rows: LiveRows, weight: Doubles) -> tuple[int, Lives]:
    """Return number and values of lives in compiled code.

    A parabola off the centre line is a centred one of a smaller diameter, sqrt(d^2 - b^2).
    """
    half, diameter, aside, number = rows.half_life, rows.diameter, np.zeros(len(rows)), SHAPES[shape]
    if rows.offset is not None and shape == "parabola":
        weight, diameter = weight * (half / diameter) * (half / diameter), half
    elif rows.offset is not None:
        number, aside = OFF_CENTRE_LENS, np.square(rows.offset / diameter)
    return number, (rows.birth, half, rows.death, 1.0 / diameter, aside, weight)


def sum_at_places(shape: Shape, rows: LiveRows, weight: Doubles, first: int, end: int, spacing: float) -> Doubles:
    """Return the weighted sum of all lives at the places i * spacing (um), i from ``first`` to ``end`` - 1."""
    number, lives = _lives(shape, rows, weight)
    places = np.arange(first, end) * spacing
    total = np.zeros(places.size)
    add_areas(number, places, first, spacing, lives, total)
    return total


def sum_over_cells(
    shape: Shape, rows: LiveRows, weight: Doubles, first: int, end: int, spacing: float, within: int = 2
) -> tuple[Doubles, Doubles]:
    """Return the same sum at the edges of the cells ``first`` ... ``end`` - 1, and its Legendre moments (3, cells).

    Cell i begins at i * spacing. within: number of places within a cell.
    """
    number, lives = _lives(shape, rows, weight)
    places = np.arange(first, end + 1) * spacing
    total, values, moments = np.zeros(places.size), np.zeros((within, end - first)), np.zeros((3, end - first))
    nodes, rule = lobatto(within)
    add_areas(number, places, first, spacing, lives, total)
    add_cells(number, places, lives, values, (first, spacing, nodes, rule, moments))
    add_values(total, values, rule, moments)
    return total, moments


@compiled
def count_live(first: int, end: int, spacing: float, birth: Doubles, departure: Doubles) -> NDArray[np.uint32]:
    """Return how many junctions live at each place, birth <= s < departure (um); departure may be infinite."""
    change = np.zeros(end - first + 1, np.int32)
    for row in range(len(birth)):
        gone = min(departure[row], end * spacing)
        change[min(max(first_at_or_after(birth[row], spacing) - first, 0), end - first)] += 1
        change[min(max(first_at_or_after(gone, spacing) - first, 0), end - first)] -= 1
    return np.cumsum(change[:-1]).astype(np.uint32)
