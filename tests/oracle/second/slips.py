"""A two-way slider integrated again from one row or landmark to the next, not by the simulation's steps; compiled.

With l the distance passed since a row, u = |w| and d = +1 forward and -1 in reversal,

    m u' = d (k x + c V) - c u - G(s_0 + d l)        l' = u        x = x_0 + V t - d l.

G is summed over lives by the formula of their area. Between births, mid-lives and deaths it is smooth but for a root
where a life begins or ends, which a clock t = q^2 or q (2 - q) takes away. Each stretch between two of them is passed
by the modified midpoint rule with extrapolation (Gragg; Hairer, Norsett and Wanner, Solving Ordinary Differential
Equations I, II.9), in time and of no fixed order; the simulation passes most of them in distance, by collocation.
"""

from typing import Final, NamedTuple

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled
from rubnoise.contact.pulses import Shape
from rubnoise.record.rows import Phase
from tests.oracle.second.sums import lens_fraction

SHAPES: Final[dict[Shape, int]] = {"lens": 0, "triangle": 1, "parabola": 2}
_SLIP, _STICK = int(Phase.SLIP), int(Phase.STICK)

_PLAIN, _LEFT, _RIGHT = range(3)
"""Clocks: t = q, q^2 and q (2 - q), for a root nowhere, at the beginning and at the end of a stretch."""

_COLUMNS: Final = 8
_TRIES: Final = 60
_NOWHERE: Final = 1e300
_SHORT: Final = 0.1
"""Of the longest step: in so short a time no error grows by more than it is."""
_STEPS: Final = 100_000
_ROUNDED: Final = 16.0 * 2.0**-52
"""Of a place or a speed: what rounding makes of it in a step, about."""


class Oscillator(NamedTuple):
    """m (kg), k (N/m), c (N s/m), V (um/s), the longest step (s), and what an extrapolation may leave of l (um).

    error: a small error of a place (um), whose growth from a node to the next is computed.
    """

    mass: float
    stiffness: float
    damping: float
    drive: float
    longest: float
    limit: float
    error: float


class Contact(NamedTuple):
    """Lives in order of birth: birth, diameter, death (um), psi d^2 (uN), the largest death up to each; their shape.

    places: births, mid-lives and deaths in order (um); rooted: 1 for births, -1 for deaths, 0 for mid-lives.
    """

    birth: Doubles
    diameter: Doubles
    death: Doubles
    weight: Doubles
    reach: Doubles
    shape: int
    places: Doubles
    rooted: Integers


class Nodes(NamedTuple):
    """Rows and landmarks in order of time: time (s), distance, displacement (um), velocity (um/s), phase from there."""

    time: Doubles
    distance: Doubles
    displacement: Doubles
    velocity: Doubles
    phase: Integers


class Led(NamedTuple):
    """Where nodes lead: distance (um) and velocity (um/s) at the next one, the lowest u on the way (um/s), G (uN) here.

    grown, grown_speed: what an error of x here makes of the distance and the velocity there.
    passed, speed: when the places of a contact are passed (s), for the first time, and how fast (um/s).
    """

    distance: Doubles
    velocity: Doubles
    lowest: Doubles
    force: Doubles
    grown: Doubles
    grown_speed: Doubles
    passed: Doubles
    speed: Doubles


class Lives(NamedTuple):
    """Who lives in a stretch: how far the nearer end is at its origin (um), how that grows (1, -1), 1/d, psi d^2."""

    gap: Doubles
    grows: Doubles
    inverse: Doubles
    weight: Doubles


class Start(NamedTuple):
    """Where a step begins: the way d, x before a path (um) that has been passed since (s), and u (um/s)."""

    way: float
    displacement: float
    since: float
    path: float
    speed: float


def follow(oscillator: Oscillator, contact: Contact, nodes: Nodes) -> Led:
    """Integrate from each node to the next; sticks are ridden through by their closed form, s at rest and x' = V."""
    count, places = nodes.time.size, contact.places.size
    sizes = (count, count, count, count, count, count, places, places)
    led, other = (Led(*(np.full(size, np.nan) for size in sizes)) for _ in range(2))
    room = Lives(*(np.empty(contact.birth.size + 1) for _ in range(4)))
    _follow(oscillator, contact, nodes, led, other, room, np.empty((_COLUMNS, 2)))
    return led


@compiled
def _gather(contact: Contact, origin: float, middle: float, lives: Lives) -> int:
    """Find who lives at a place, measured from an origin; return how many."""
    end = np.searchsorted(contact.birth, middle)
    count = 0
    for row in range(np.searchsorted(contact.reach, middle, side="right"), end):
        if contact.death[row] <= middle:
            continue
        rising = middle - contact.birth[row] < contact.diameter[row]
        edge = contact.birth[row] if rising else contact.birth[row] + 2.0 * contact.diameter[row]
        lives.gap[count] = origin - edge if rising else edge - origin
        lives.grows[count] = 1.0 if rising else -1.0
        lives.inverse[count] = 1.0 / contact.diameter[row]
        lives.weight[count] = contact.weight[row]
        count += 1
    return count


@compiled
def _force(offset: float, shape: int, lives: Lives, count: int) -> float:
    """Return G in uN at an offset (um) from the origin of lives."""
    total = 0.0
    for n in range(count):
        u = min(max((lives.gap[n] + lives.grows[n] * offset) * lives.inverse[n], 0.0), 1.0)
        bent = u * (2.0 - u) if shape == 2 else u
        total += lives.weight[n] * (lens_fraction(u) if shape == 0 else 0.25 * np.pi * bent)
    return total


@compiled
def _rate(oscillator: Oscillator, way: float, x: float, time: float, path: float, u: float, force: float) -> float:
    """Return u' where a path (um) has been passed in a time (s) since x."""
    place = x + oscillator.drive * time - way * path
    pull = way * (oscillator.stiffness * place + oscillator.damping * oscillator.drive)
    return (pull - oscillator.damping * u - force) / oscillator.mass


@compiled
def _midpoint(
    oscillator: Oscillator, start: Start, h: float, clock: int, steps: int, shape: int, lives: Lives, count: int
) -> tuple[float, float]:
    """Return path and u after a time h by the modified midpoint rule of so many steps, an even number."""
    way, x, since, path, u = start
    size = 1.0 / steps
    path_before, u_before = path, u
    for n in range(steps):
        part, rate = _clock(n * size, clock)
        force = _force(way * path, shape, lives, count)
        growth = h * rate * _rate(oscillator, way, x, since + part * h, path, u, force)
        stride = size if n == 0 else 2.0 * size
        path_next, u_next = path_before + stride * (h * rate * u), u_before + stride * growth
        path_before, u_before, path, u = path, u, path_next, u_next
    _, rate = _clock(1.0, clock)
    force = _force(way * path, shape, lives, count)
    growth = h * rate * _rate(oscillator, way, x, since + h, path, u, force)
    return 0.5 * (path + path_before + size * (h * rate * u)), 0.5 * (u + u_before + size * growth)


@compiled
def _clock(q: float, clock: int) -> tuple[float, float]:
    """Return t(q) and dt/dq of a clock."""
    if clock == _LEFT:
        return q * q, 2.0 * q
    if clock == _RIGHT:
        return q * (2.0 - q), 2.0 * (1.0 - q)
    return q, 1.0


@compiled
def _extrapolated(
    oscillator: Oscillator, start: Start, h: float, clock: int, shape: int, lives: Lives, count: int, table: Doubles
) -> tuple[float, float, bool]:
    """Return path and u after a time h, and whether rules of 2, 4, 6 ... steps have come to the limit.

    What is left of u goes on for as long as the longest step, however short this one is.
    """
    path, u = 0.0, 0.0
    for column in range(_COLUMNS):
        path, u = _midpoint(oscillator, start, h, clock, 2 * (column + 1), shape, lives, count)
        away, away_u = np.inf, np.inf
        for back in range(column):
            # Aitken and Neville, in the square of the step.
            ratio = (column + 1.0) / (column - back)
            share = 1.0 / (ratio * ratio - 1.0)
            away, away_u = (path - table[back, 0]) * share, (u - table[back, 1]) * share
            table[back, 0], table[back, 1] = path, u
            path, u = path + away, u + away_u
        table[column, 0], table[column, 1] = path, u
        near, near_u = (
            oscillator.limit + _ROUNDED * abs(path),
            oscillator.limit / oscillator.longest + _ROUNDED * abs(u),
        )
        if column > 1 and abs(away) <= near and abs(away_u) <= near_u:
            return path, u, True
    return path, u, False


@compiled
def _time_to(distance: float, u: float, growth: float) -> float:
    """Return after which time a distance is passed at a speed u that grows steadily; infinite if never."""
    root = u * u + 2.0 * growth * distance
    if root < 0.0:
        return np.inf
    below = u + np.sqrt(root)
    return 2.0 * distance / below if below > 0.0 else np.inf


@compiled
def _step(
    oscillator: Oscillator,
    start: Start,
    most: float,
    border: float,
    clocks: tuple[int, int],
    shape: int,
    lives: Lives,
    count: int,
    table: Doubles,
) -> tuple[float, float, float, bool]:
    """Go on for a time (s), or to a border (um of path); return time, path and u, and whether the border is reached.

    clocks: of a step that ends before the border, and of one that ends there. The path is nan where none is found.
    """
    force = _force(start.way * start.path, shape, lives, count)
    growth = _rate(oscillator, start.way, start.displacement, start.since, start.path, start.speed, force)
    least = 1e-13 + 1e-9 * (border - start.path)
    ahead = _time_to(border - start.path, start.speed, growth)
    landing = ahead < most
    h = ahead if landing else most
    low, high = 0.0, np.inf
    for _ in range(_TRIES):
        path, u, found = _extrapolated(oscillator, start, h, clocks[int(landing)], shape, lives, count, table)
        beyond = path - border
        if not found:
            h, landing = 0.5 * h, False
        elif landing and abs(beyond) <= least:
            return h, border, u, True
        elif not landing and beyond <= least:
            return h, path, u, False
        else:
            if beyond > 0.0:
                high = h
            else:
                low = h
            # Where u has fallen far on its way to the border, only u itself leads there soon.
            h -= beyond / (u if u > 0.0 else 0.5 * start.speed)
            landing = h < most or high < np.inf
            if not landing:
                h = most
            elif not low < h < min(high, most):
                # A slip that begins with u = 0 and u' = 0 goes as t^3, where Newton's step leaves the bracket.
                h = 0.5 * (low + min(high, most))
    return h, np.nan, np.nan, False


@compiled
def _pass(
    oscillator: Oscillator,
    contact: Contact,
    led: Led,
    begin: tuple[float, float, float, float, float],
    duration: float,
    lives: Lives,
    table: Doubles,
) -> tuple[float, float, float]:
    """Go on from (way, time, s, x, u) for a duration; return the path, u, and the lowest u on the way; nan where lost.

    No step goes beyond where a life begins, turns or ends.
    """
    way, now, origin, x, u = begin
    places, ahead = contact.places, int(way)
    at = int(np.searchsorted(places, origin, side="right") if ahead > 0 else np.searchsorted(places, origin) - 1)
    path, since, lowest, clock, count, gathered = 0.0, 0.0, u, _PLAIN, 0, -2
    for _ in range(_STEPS):
        known = 0 <= at < len(places)
        border = way * (places[at] - origin) if known else _NOWHERE
        if gathered != at:
            middle = 0.5 * (path + border) if known else path + 1.0
            count, gathered = _gather(contact, origin, origin + way * middle, lives), at
        clocks = (clock, _RIGHT if known and contact.rooted[at] == -ahead and clock == _PLAIN else clock)
        start = Start(way, x, since, path, u)
        most = min(duration - since, oscillator.longest)
        h, path, u, landed = _step(oscillator, start, most, border, clocks, contact.shape, lives, count, table)
        since, lowest, clock = since + h, min(lowest, u), _PLAIN
        if landed:
            if ahead > 0 and np.isnan(led.passed[at]):
                led.passed[at], led.speed[at] = now + since, u
            clock = _LEFT if contact.rooted[at] == ahead else _PLAIN
            at += ahead
        if since >= duration or np.isnan(path):
            return path, u, lowest
    return np.nan, np.nan, lowest


@compiled
def _follow(
    oscillator: Oscillator, contact: Contact, nodes: Nodes, led: Led, other: Led, lives: Lives, table: Doubles
) -> None:
    for n in range(len(nodes.time)):
        time, s, x, velocity = nodes.time[n], nodes.distance[n], nodes.displacement[n], nodes.velocity[n]
        count = _gather(contact, s, s, lives)
        led.force[n] = _force(0.0, contact.shape, lives, count)
        if n + 1 == len(nodes.time):
            return
        duration = nodes.time[n + 1] - time
        if nodes.phase[n] == _STICK or not duration > 0.0:
            led.distance[n], led.velocity[n], led.lowest[n] = s, velocity, 0.0
            led.grown[n], led.grown_speed[n] = 0.0, 0.0
            continue
        way = 1.0 if nodes.phase[n] == _SLIP else -1.0
        begin = (way, time, s, x, way * (oscillator.drive - velocity))
        path, u, lowest = _pass(oscillator, contact, led, begin, duration, lives, table)
        led.distance[n], led.velocity[n], led.lowest[n] = s + way * path, oscillator.drive - way * u, lowest
        led.grown[n], led.grown_speed[n] = 0.0, 0.0
        if duration < _SHORT * oscillator.longest:
            continue
        begin = (way, time, s, x + way * oscillator.error, way * (oscillator.drive - velocity))
        path_off, u_off, _ = _pass(oscillator, contact, other, begin, duration, lives, table)
        led.grown[n], led.grown_speed[n] = abs(path_off - path), abs(u_off - u)
