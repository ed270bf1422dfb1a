"""The kernel: sums over lives, at evenly spaced places and over the cells between them, for every pulse.

A life adds w a(x), x = (s - b - h)/d, to every place s at which it lives; b is its birth, h half its life, d its
diameter and w its weight. With w = d^2 the sum is the real contact area, with w = psi d^2 the friction force. A life
counts while birth <= s < departure.

Over a cell the sum is needed as three Legendre moments, int_0^1 of it times P_i(2y - 1) dy. They come from its values
at the edges of the cell and at three more on either side, as if it were one polynomial there. That is wrong near where
a life begins, turns or ends. There every life adds the difference between its true moments and those of its values:

- at its birth and at its death: those of u^1.5 (c_0 + c_1 u + c_2 u^2), or of a polynomial;
- at its mid-life: those of the kink;
- about the end of a life that was ended early, in all cells of a life of few cells, and where a pass off the centre
  line turns sharply: Gauss nodes in the square root of the distance from the nearer end.

The area of one life is right to 1e-12 d^2. Its mean over a cell is right to 5e-10, 6e-9 and 2e-7 d^2 at 220, 50 and 20
cells a life, its bend to five times this. Polynomials, the triangle and the parabola, are right to rounding.

Sums at places go in order of birth, and what a life adds to a place depends on both alone. So they do not depend on
where a run is cut into ranges. Moments do, by less than these errors, in the three cells on either side of a cut: lives
that do not reach into a range are not handed over. Loops over places have one output and the pulse chosen outside, so
that the compiler takes several places at once; it may also fuse a product with a sum.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_within
from rubnoise.contact.pulses import LENS_SERIES, Shape
from rubnoise.simulation.cell_moments import (
    AFTER,
    BEFORE,
    GAUSS,
    ROOT,
    ROOT_CELLS,
    RULE,
    WHOLE,
    Series,
    missed_of,
    moments_of,
)
from rubnoise.simulation.state import LiveRows

LENS_SHAPE, TRIANGLE_SHAPE, PARABOLA_SHAPE, OFF_CENTRE_LENS = range(4)
SHAPES: Final[dict[Shape, int]] = {"lens": LENS_SHAPE, "triangle": TRIANGLE_SHAPE, "parabola": PARABOLA_SHAPE}
"""Number of each pulse shape in compiled code; passes of the lens off the centre line have their own."""

SHORT: Final = 6.0  # cells in half a life: below it no series is right in the cells of its birth and death

NEAR: Final = 8
"""Cells from the centre line within which a pass turns so sharply that as many on either side need other nodes."""

FAR: Final = 2**60  # a cell that no run reaches

QUARTER_TURN: Final = 0.25 * np.pi

Lives = tuple[Doubles, Doubles, Doubles, Doubles, Doubles, Doubles]
"""Birth, half life and end (um), 1/d, (b/d)^2 for a pass at a distance b from the centre line, and weight."""

Life = tuple[float, float, float, float, float, float]  # the same of one life

Cells = tuple[int, float, Doubles, Doubles]
"""Number and width (um) of the first cell, the moments (3, cells), and room for what a landmark adds to some cells."""


@compiled_within
def lens_area(u: float) -> float:
    """Return the area over d^2 of a lens, at the distance u <= 1 from the nearer end of its life over d."""
    value = LENS_SERIES[-1]
    for n in range(len(LENS_SERIES) - 2, -1, -1):
        value = value * u + LENS_SERIES[n]
    return u * np.sqrt(u) * value


@compiled_within
def area_of_life(shape: int, since: float, half: float, inverse: float, aside: float) -> float:
    """Return the area over d^2 at a distance (um) since the birth; 0 outside the life. half: of the life (um)."""
    if shape == OFF_CENTRE_LENS:
        x = (since - half) * inverse
        return lens_area(max(1.0 - np.sqrt(x * x + aside), 0.0))
    u = max(min(since, half + half - since) * inverse, 0.0)
    if shape == TRIANGLE_SHAPE:
        return QUARTER_TURN * u
    if shape == PARABOLA_SHAPE:
        return QUARTER_TURN * u * (2.0 - u)
    return lens_area(u)


def _adder(shape: int) -> Any:
    """Return a compiled function that adds one life to neighbouring places."""

    @compiled_within
    def add(places: Doubles, life: Life, total: Doubles) -> None:
        birth, half, _, inverse, aside, weight = life
        for k in range(len(places)):
            total[k] += weight * area_of_life(shape, places[k] - birth, half, inverse, aside)

    return add


_add_lens, _add_triangle, _add_parabola, _add_off_centre_lens = map(_adder, range(4))


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
        life = birth[row], half[row], end[row], inverse[row], aside[row], weight[row]
        if shape == LENS_SHAPE:
            _add_lens(here, life, found)
        elif shape == TRIANGLE_SHAPE:
            _add_triangle(here, life, found)
        elif shape == PARABOLA_SHAPE:
            _add_parabola(here, life, found)
        else:
            _add_off_centre_lens(here, life, found)


@compiled
def add_missed(shape: int, lives: Lives, cells: Cells) -> None:
    """Add what the values of all lives at the edges of the cells miss of the moments."""
    birth, half, end, inverse, aside, weight = lives
    spacing = cells[1]
    for row in range(len(birth)):
        life = birth[row], half[row], end[row], inverse[row], aside[row], weight[row]
        if half[row] < SHORT * spacing:
            first, stop = int(np.floor(birth[row] / spacing)), first_at_or_after(end[row], spacing)
            _add_exactly(shape, first - BEFORE, stop + BEFORE, life, cells)
        else:
            _add_landmarks(shape, life, cells)


@compiled_within
def _add_landmarks(shape: int, life: Life, cells: Cells) -> None:
    """Add what the values of a long life miss at its birth, its turn and its end.

    From ``first`` to ``stop`` by Gauss nodes; in the cells before by the series of birth and turn, after of the death.
    """
    birth, half, end, inverse, aside, weight = life
    _, spacing, _, room = cells
    width, middle, death = spacing * inverse, birth + half, birth + 2.0 * half
    turn, first, stop = int(np.floor(middle / spacing)), FAR, -FAR
    if shape == OFF_CENTRE_LENS and aside < (NEAR * width) * (NEAR * width):
        first, stop = turn - NEAR, turn + NEAR + 1
    if end < death:
        gone = first_at_or_after(end, spacing)
        first, stop = min(first, gone - AFTER), gone + BEFORE
    _add_exactly(shape, first, stop, life, cells)
    kind, series = _series_of(shape, width, half * inverse, aside, weight)
    cell = int(np.floor(birth / spacing))
    count = missed_of(kind, 1, cell + 1.0 - birth / spacing, series, room)
    _add_room(cell - BEFORE, count, -FAR, first, cells)
    if end >= death:
        cell = int(np.ceil(death / spacing)) - 1
        count = missed_of(kind, -1, death / spacing - cell, series, room)
        _add_room(cell + BEFORE + 1 - count, count, stop, FAR, cells)
    if shape == LENS_SHAPE:  # whose slope changes by -2 sqrt(1 - x^2)
        series = -2.0 * weight * width, 0.0, weight * width * width * width / 3.0
    elif shape == TRIANGLE_SHAPE:
        series = -2.0 * QUARTER_TURN * weight * width, 0.0, 0.0
    else:
        return
    count = missed_of(WHOLE, 1, turn + 1.0 - middle / spacing, series, room)
    _add_room(turn - BEFORE, count, -FAR, first, cells)


@compiled_within
def _series_of(shape: int, width: float, rise: float, aside: float, weight: float) -> tuple[int, Series]:
    """Return how a life begins, and the kind of powers; cells of ``width`` and ``rise``, half the life, are over d.

    Off the centre line u is rise s (1 - q s - (b/d)^2 s^2/2 ...) at the distance s from an end.
    """
    if shape == TRIANGLE_SHAPE:
        return WHOLE, (weight * width * QUARTER_TURN, 0.0, 0.0)
    if shape == PARABOLA_SHAPE:
        return WHOLE, (2.0 * weight * width * QUARTER_TURN, -weight * width * width * QUARTER_TURN, 0.0)
    q, scale = 0.5 * aside / rise, weight * (width * rise) * np.sqrt(width * rise)
    c0, c1, c2 = LENS_SERIES[0], LENS_SERIES[1], LENS_SERIES[2]
    second = c1 * rise - 1.5 * q * c0
    third = c2 * rise * rise - 2.5 * c1 * rise * q + c0 * (0.375 * q * q - 0.75 * aside)
    return ROOT, (scale * c0, scale * width * second, scale * width * width * third)


@compiled_within
def _add_room(at: int, count: int, low: int, high: int, cells: Cells) -> None:
    """Add what a landmark adds to some cells from ``at`` on, but only to those from ``low`` to ``high``."""
    origin, _, moments, room = cells
    begin = max(at, low, origin)
    end = min(at + count, high, origin + moments.shape[1])
    if begin < end:
        for i in range(3):
            some = moments[i, begin - origin : end - origin]
            missed = room[i * count + begin - at : i * count + end - at]
            for k in range(len(some)):
                some[k] += missed[k]


@compiled_within
def _add_exactly(shape: int, first: int, stop: int, life: Life, cells: Cells) -> None:
    """Add what the values of a life miss in some cells: its moments by quadrature take their place."""
    origin, spacing, moments, _ = cells
    birth, half, end, inverse, aside, weight = life
    first = max(first, origin, int(np.floor(birth / spacing)) - BEFORE)
    stop = min(stop, origin + moments.shape[1])
    if first >= stop:
        return
    for cell in range(first, stop):
        mean, slope, bend = _quadrature(shape, float(cell) * spacing, float(cell + 1) * spacing, life)
        _add_moments(cell - origin, mean, slope, bend, moments)
    for edge in range(first - BEFORE, stop + AFTER):
        place = float(edge) * spacing
        if birth <= place < end:
            value = weight * area_of_life(shape, place - birth, half, inverse, aside)
            for cell in range(max(edge - AFTER, first), min(edge + BEFORE + 1, stop)):
                mean, slope, bend = RULE[:, edge - cell + BEFORE]
                _add_moments(cell - origin, -mean * value, -slope * value, -bend * value, moments)


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
                part = scale * step * share * w * area_of_life(shape, half - x, half, inverse, aside)
                mean, slope, bend = mean + part, slope + part * z, bend + part * (1.5 * z * z - 0.5)
            far = piece
    return mean, slope, bend


@compiled_within
def _add_moments(cell: int, mean: float, slope: float, bend: float, moments: Doubles) -> None:
    moments[0, cell] += mean
    moments[1, cell] += slope
    moments[2, cell] += bend


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
    shape: Shape, rows: LiveRows, weight: Doubles, first: int, end: int, spacing: float
) -> tuple[Doubles, Doubles]:
    """Return the same sum at the edges of the cells ``first`` ... ``end`` - 1, and its Legendre moments (3, cells).

    Cell i begins at i * spacing.
    """
    number, lives = _lives(shape, rows, weight)
    before, after = first - BEFORE, end + AFTER
    places = np.arange(before, after) * spacing
    values = np.zeros(places.size)
    add_areas(number, places, before, spacing, lives, values)
    moments = moments_of(values)
    add_missed(number, lives, (first, spacing, moments, np.empty(3 * ROOT_CELLS)))
    return values[BEFORE : BEFORE + end - first + 1], moments


@compiled
def count_live(first: int, end: int, spacing: float, birth: Doubles, departure: Doubles) -> NDArray[np.uint32]:
    """Return how many junctions live at each place, birth <= s < departure (um); departure may be infinite."""
    change = np.zeros(end - first + 1, np.int32)
    for row in range(len(birth)):
        gone = min(departure[row], end * spacing)
        change[min(max(first_at_or_after(birth[row], spacing) - first, 0), end - first)] += 1
        change[min(max(first_at_or_after(gone, spacing) - first, 0), end - first)] -= 1
    return np.cumsum(change[:-1]).astype(np.uint32)
