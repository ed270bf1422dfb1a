"""Real contact area, friction force and the moments of the force, summed again from rows; compiled.

The formulas are not those of the simulation.
"""

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled
from rubnoise.contact.pulses import Pulse


def add_areas(
    pulse: Pulse,
    positions: Doubles,
    lives: tuple[Integers, Integers],
    shapes: tuple[Doubles, ...],
    area: Doubles,
    force: Doubles,
) -> None:
    """Add what junctions have of area in um^2 and of force in uN at the positions in um at which they live.

    ``lives`` holds the first position of each junction and the one after its last, ``shapes`` birth, diameter (um) and
    strength (MPa), and of passes off the centre line the offset (um).
    """
    _ADDED[pulse.name](positions, *lives, *shapes, area, force)


@compiled
def lens_fraction(u: float) -> float:
    """Return the area of the lens over d^2 at the distance u d from the nearer end of the life, 0 <= u <= 1.

    Half of t - sin t cos t with cos t = 1 - u (paper Eq. 2); t = 2 asin(sqrt(u/2)) keeps its digits as u goes to 0, and
    what the difference then loses is 2^-53 of t, not of the area.
    """
    return 0.5 * (2.0 * np.arcsin(np.sqrt(0.5 * u)) - (1.0 - u) * np.sqrt(u * (2.0 - u)))


@compiled
def _add_lenses(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi = birth[row], diameter[row], strength[row]
        for tick in range(first[row], last[row]):
            age = positions[tick] - born
            each = d * d * lens_fraction(max(min(age, 2.0 * d - age), 0.0) / d)
            area[tick] += each
            force[tick] += psi * each


@compiled
def _add_triangles(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi = birth[row], diameter[row], strength[row]
        for tick in range(first[row], last[row]):
            age = positions[tick] - born
            each = 0.25 * np.pi * d * max(min(age, 2.0 * d - age), 0.0)
            area[tick] += each
            force[tick] += psi * each


@compiled
def _add_parabolas(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi = birth[row], diameter[row], strength[row]
        for tick in range(first[row], last[row]):
            u = (positions[tick] - born) / d - 1.0
            each = 0.25 * np.pi * d * d * max(1.0 - u * u, 0.0)
            area[tick] += each
            force[tick] += psi * each


@compiled
def off_centre_fraction(x: float, offset: float) -> float:
    """Return the area of the lens over d^2 whose centres are x d along the motion and b d across it from each other."""
    r = min(np.hypot(x, offset), 1.0)
    return 0.5 * (np.arccos(r) - r * np.sqrt((1.0 - r) * (1.0 + r)))


@compiled
def _add_off_centre(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    offset: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi, b = birth[row], diameter[row], strength[row], offset[row] / diameter[row]
        half = np.sqrt((d - offset[row]) * (d + offset[row]))
        for tick in range(first[row], last[row]):
            each = d * d * off_centre_fraction((positions[tick] - born - half) / d, b)
            area[tick] += each
            force[tick] += psi * each


@compiled
def _add_off_centre_parabolas(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    offset: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        d, b = diameter[row], offset[row]
        middle = birth[row] + np.sqrt(d * d - b * b)
        for tick in range(first[row], last[row]):
            square = (positions[tick] - middle) ** 2 + b * b
            each = 0.25 * np.pi * max(d * d - square, 0.0)
            area[tick] += each
            force[tick] += strength[row] * each


_ADDED: dict[str, Callable[..., None]] = {
    "lens": _add_lenses,
    "triangle": _add_triangles,
    "parabola": _add_parabolas,
    "off-centre lens": _add_off_centre,
    "off-centre parabola": _add_off_centre_parabolas,
}


NARROW: Final = 128.0
"""Diameters of more cells than this have their moments by quadrature: closed forms lose (d/cell)^2 roundings."""

_COUNT = 6
_RULE = np.polynomial.legendre.leggauss(_COUNT)
_NODES = tuple((0.5 + 0.5 * _RULE[0]).tolist())
_WEIGHTS = tuple((0.5 * _RULE[1]).tolist())
_TWO = 0.5 / 3.0**0.5  # two nodes at this distance from the middle are exact for cubics


def force_moments(pulse: Pulse, positions: Doubles, width: float, shapes: tuple[Doubles, ...]) -> Doubles:
    """Return int F P_i(2y - 1) ds over each cell between positions for i = 0, 1, 2, in uN um, shape (3, cells).

    ``width`` (um) is that of every cell: positions far out are rounded, and their differences are not as wide.
    ``shapes`` holds birth, diameter, death (um) and strength (MPa), and of passes off the centre line the offset (um).
    Closed forms are differences over a cell of what is
    as large as over a life; where cells are a very small part of a diameter, quadrature takes their place.
    """
    moments = np.zeros((3, positions.size - 1))
    _MOMENTS_ADDED[pulse.name](positions, width, shapes, moments)
    return moments


def _add_all_triangles(positions: Doubles, width: float, shapes: tuple[Doubles, ...], moments: Doubles) -> None:
    _add(_add_triangle_moments, positions, width, shapes, moments)


def _add_all_parabolas(positions: Doubles, width: float, shapes: tuple[Doubles, ...], moments: Doubles) -> None:
    _add(_add_parabola_moments, positions, width, shapes, moments)


def _add_all_lenses(positions: Doubles, width: float, shapes: tuple[Doubles, ...], moments: Doubles) -> None:
    fine = shapes[1] > NARROW * width
    _add(_add_lens_moments, positions, width, tuple(each[~fine] for each in shapes), moments)
    _add(_add_fine_lenses, positions, width, tuple(each[fine] for each in shapes), moments)


def _add_all_off_centre(positions: Doubles, width: float, shapes: tuple[Doubles, ...], moments: Doubles) -> None:
    _add(_add_off_centre_moments, positions, width, shapes, moments)


def _add_all_off_centre_parabolas(
    positions: Doubles, width: float, shapes: tuple[Doubles, ...], moments: Doubles
) -> None:
    birth, diameter, death, strength, offset = shapes
    chord = np.sqrt(diameter * diameter - offset * offset)
    _add(_add_parabola_moments, positions, width, (birth, chord, death, strength), moments)


_MOMENTS_ADDED: dict[str, Callable[..., None]] = {
    "lens": _add_all_lenses,
    "triangle": _add_all_triangles,
    "parabola": _add_all_parabolas,
    "off-centre lens": _add_all_off_centre,
    "off-centre parabola": _add_all_off_centre_parabolas,
}


def _add(add: Any, positions: Doubles, width: float, shapes: tuple[Doubles, ...], moments: Doubles) -> None:
    """Add what lives bring to cells, by ages: each by the cell in which it begins and the age at its edge."""
    begin = np.maximum(np.searchsorted(positions, shapes[0], side="right") - 1, 0)
    add(begin, positions[begin] - shapes[0], width, *shapes, moments)


@compiled
def _end_of_life(birth: float, diameter: float, death: float) -> float:
    """Return the age at which a life ends: from its diameter, unless it was ended early, since far births round."""
    return 2.0 * diameter if death >= birth + 2.0 * diameter else death - birth


@compiled
def _integrals(age: float, d: float, half: float) -> tuple[float, float, float]:
    """Return antiderivatives of the area, of first, second and third order, in one half of a life: 1 or -1."""
    u = min(max(age / d if half > 0.0 else 2.0 - age / d, 0.0), 1.0)
    t = 2.0 * np.arcsin(np.sqrt(0.5 * u))
    x, square = 1.0 - u, u * (2.0 - u)
    w = np.sqrt(square)
    j1 = 0.5 * (w - x * t - w * square / 3.0)
    j2 = 0.5 * (0.625 * (t - x * w) - 0.5 * square * t + x * w * square / 12.0)
    rest = x * t * (0.5 - x * x / 6.0) - w * (1.0 / 3.0 + square * (1.0 / 18.0 - square / 60.0))
    j3 = 0.5 * (1.25 * j1 + rest)
    cube = d * d * d
    return half * cube * j1, cube * d * j2, half * cube * d * d * j3


@compiled
def _add_to_cell(moments: Doubles, cell: int, width: float, m0: float, m1: float, m2: float) -> None:
    """Add raw moments about the middle of a cell as moments of Legendre polynomials over it."""
    moments[0, cell] += m0
    moments[1, cell] += 2.0 * m1 / width
    moments[2, cell] += 6.0 * m2 / (width * width) - 0.5 * m0


@compiled
def _add_lens_moments(
    begin: Integers,
    origin: Doubles,
    width: float,
    birth: Doubles,
    diameter: Doubles,
    death: Doubles,
    strength: Doubles,
    moments: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi = birth[row], diameter[row], strength[row]
        end = _end_of_life(born, d, death[row])
        cell = begin[row]
        edge = origin[row] + width
        p = max(origin[row], 0.0)
        half = 1.0 if p < d else -1.0
        p1, p2, p3 = _integrals(p, d, half)
        while cell < moments.shape[1] and p < end:
            middle = edge - 0.5 * width
            q = min(edge, end)
            if half > 0.0:
                q = min(q, d)
            q1, q2, q3 = _integrals(q, d, half)
            y, z = p - middle, q - middle
            m1 = z * q1 - y * p1 - (q2 - p2)
            m2 = z * z * q1 - y * y * p1 - 2.0 * (z * q2 - y * p2) + 2.0 * (q3 - p3)
            _add_to_cell(moments, cell, width, psi * (q1 - p1), psi * m1, psi * m2)
            p, p1, p2, p3 = q, q1, q2, q3
            if half > 0.0 and p >= d:
                half = -1.0
                p1, p2, p3 = _integrals(p, d, half)
            if q >= edge:
                cell += 1
                edge = origin[row] + (cell - begin[row] + 1) * width


@compiled
def _add_fine_lenses(
    begin: Integers,
    origin: Doubles,
    width: float,
    birth: Doubles,
    diameter: Doubles,
    death: Doubles,
    strength: Doubles,
    moments: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d = birth[row], diameter[row]
        end = _end_of_life(born, d, death[row])
        cell = begin[row]
        edge = origin[row] + width
        p = max(origin[row], 0.0)
        while cell < moments.shape[1] and p < end:
            q = min(edge, end)
            if p < d:
                q = min(q, d)
            _add_fine_piece(p, q, d, strength[row], edge - width, width, cell, moments)
            p = q
            if q >= edge:
                cell += 1
                edge = origin[row] + (cell - begin[row] + 1) * width


@compiled
def _add_fine_piece(
    p: float, q: float, d: float, psi: float, edge: float, width: float, cell: int, moments: Doubles
) -> None:
    """Add a piece of one half of a life between two ages by quadrature in w = sqrt(u), in which the area is smooth."""
    rising = p < d
    begin = min(max(p / d if rising else 2.0 - p / d, 0.0), 1.0)
    step = (q - p) / d if rising else (p - q) / d
    root = np.sqrt(begin)
    total = root + np.sqrt(max(begin + step, 0.0))
    if total == 0.0:
        return
    m0, m1, m2 = 0.0, 0.0, 0.0
    for node in range(_COUNT):
        w = root + step / total * _NODES[node]
        part = _WEIGHTS[node] * 2.0 * w * lens_fraction(min(w * w, 1.0))
        y = (p - edge) - 0.5 * width + (q - p) * _NODES[node] * (w + root) / total
        m0 += part
        m1 += part * y
        m2 += part * y * y
    scale = psi * d * d * d * abs(step) / total
    _add_to_cell(moments, cell, width, scale * m0, scale * m1, scale * m2)


@compiled
def _add_triangle_moments(
    begin: Integers,
    origin: Doubles,
    width: float,
    birth: Doubles,
    diameter: Doubles,
    death: Doubles,
    strength: Doubles,
    moments: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d = birth[row], diameter[row]
        end = _end_of_life(born, d, death[row])
        slope = 0.25 * np.pi * d * strength[row]
        cell = begin[row]
        edge = origin[row] + width
        p = max(origin[row], 0.0)
        while cell < moments.shape[1] and p < end:
            q = min(edge, end)
            if p < d:
                q = min(q, d)
            for share in (0.5 - _TWO, 0.5 + _TWO):
                age = p + share * (q - p)
                y = (p - (edge - width)) - 0.5 * width + share * (q - p)
                part = 0.5 * (q - p) * slope * min(age, 2.0 * d - age)
                _add_to_cell(moments, cell, width, part, part * y, part * y * y)
            p = q
            if q >= edge:
                cell += 1
                edge = origin[row] + (cell - begin[row] + 1) * width


_THREE = 0.5 * 0.6**0.5  # three nodes, in the middle and at this distance from it, are exact for degree 5


@compiled
def _add_parabola_moments(
    begin: Integers,
    origin: Doubles,
    width: float,
    birth: Doubles,
    diameter: Doubles,
    death: Doubles,
    strength: Doubles,
    moments: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d = birth[row], diameter[row]
        end = _end_of_life(born, d, death[row])
        cell = begin[row]
        edge = origin[row] + width
        p = max(origin[row], 0.0)
        while cell < moments.shape[1] and p < end:
            q = min(edge, end)
            for share, weight in ((0.5 - _THREE, 5.0), (0.5, 8.0), (0.5 + _THREE, 5.0)):
                age = p + share * (q - p)
                y = (p - (edge - width)) - 0.5 * width + share * (q - p)
                part = weight / 18.0 * (q - p) * 0.25 * np.pi * strength[row] * age * (2.0 * d - age)
                _add_to_cell(moments, cell, width, part, part * y, part * y * y)
            p = q
            if q >= edge:
                cell += 1
                edge = origin[row] + (cell - begin[row] + 1) * width


_LONGEST_TURN = 0.5
_SHORTEST_TURN = 1e-7


@compiled
def _add_off_centre_moments(
    begin: Integers,
    origin: Doubles,
    width: float,
    birth: Doubles,
    diameter: Doubles,
    death: Doubles,
    strength: Doubles,
    offset: Doubles,
    moments: Doubles,
) -> None:
    for row in range(len(birth)):
        half = np.sqrt((diameter[row] - offset[row]) * (diameter[row] + offset[row]))
        end = 2.0 * half if death[row] >= birth[row] + 2.0 * half else death[row] - birth[row]
        cell = begin[row]
        edge = origin[row] + width
        p = max(origin[row], 0.0)
        while cell < moments.shape[1] and p < end:
            q = min(edge, end)
            _add_turning(p, q, half, diameter[row], abs(offset[row]), strength[row], edge, width, cell, moments)
            p = q
            if q >= edge:
                cell += 1
                edge = origin[row] + (cell - begin[row] + 1) * width


@compiled
def _add_turning(
    p: float, q: float, half: float, d: float, b: float, psi: float, edge: float, width: float, cell: int,
    moments: Doubles,
) -> None:  # fmt: skip
    """Add a piece of a life between two ages by quadrature in the angle t of x = -h cos t, where its ends are smooth.

    The area turns at t = pi/2, as sharply as b is small beside h: steps are half as long as it is away, at most.
    """
    angle = 2.0 * np.arcsin(np.sqrt(min(p / (2.0 * half), 1.0)))
    last = 2.0 * np.arcsin(np.sqrt(min(q / (2.0 * half), 1.0)))
    m0, m1, m2 = 0.0, 0.0, 0.0
    while angle < last:
        away = np.hypot(0.5 * np.pi - angle, min(b / half, 1.0))
        step = min(last - angle, _LONGEST_TURN, max(0.5 * away, _SHORTEST_TURN))
        for node in range(_COUNT):
            t = angle + step * _NODES[node]
            part = _WEIGHTS[node] * step * half * np.sin(t) * off_centre_fraction(half * np.cos(t) / d, b / d)
            y = 2.0 * half * np.sin(0.5 * t) ** 2 - edge + 0.5 * width
            m0 += part
            m1 += part * y
            m2 += part * y * y
        angle += step
    scale = psi * d * d
    _add_to_cell(moments, cell, width, scale * m0, scale * m1, scale * m2)
