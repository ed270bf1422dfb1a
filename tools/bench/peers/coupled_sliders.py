"""A slider that pushes back, driven over given junctions by methods that a user could pick.

m x'' + c x' + k x = G(s) sign(w), w = V - x', s = V t - (x - x_0); where w = 0 and |k x + c V| <= G it sticks. All of
them begin anew where w has come to 0, and a stick is its closed form. solve_ivp begins anew at every birth, mid-life
and death, too, without which its order is lost, and where w turns away from 0, without which it misses standstills
between which it does not look; fixed steps go over all this.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import acos, inf, sqrt
from typing import Any

import numba
import numpy as np
from scipy.integrate import solve_ivp

from bench.case import Doubles


@dataclass(frozen=True)
class Stretch:
    """Junctions in order of birth (um, MPa), a slider at rest at a displacement (um), and the times (s) of its rows."""

    birth: Doubles
    diameter: Doubles
    strength: Doubles
    mass: float
    stiffness: float
    damping: float
    speed: float
    displacement: float
    times: Doubles


LONGEST = 0.01
"""Time in s after which solve_ivp starts again without an event, so that it computes few rows at once."""

AT_ONCE = 1e-9
"""Time in s from a breakaway, where w' = 0, to where w' is looked at."""

STANDSTILL, BORDER, TURN = range(3)
"""Of solve_ivp's events."""

Mover = Callable[[Stretch, float], Doubles]
"""Returns displacements (um) at the times of the rows, from a stretch and a tolerance, or a step in s."""

Forces = Callable[[float, Doubles, Doubles, Doubles], float]
"""Returns G in uN at a distance from the births, diameters and strengths of those who live there."""


def numpy_force(s: float, birth: Doubles, d: Doubles, strength: Doubles) -> float:
    """Return G by arrays."""
    x = np.minimum(np.abs(d - (s - birth)), d)
    return float(strength @ (0.5 * (d * d * np.arccos(x / d) - x * np.sqrt(d * d - x * x))))


@numba.njit(cache=True)
def compiled_force(s: float, birth: Doubles, diameter: Doubles, strength: Doubles) -> float:
    """Return G by a compiled loop over the junctions that are alive there."""
    total = 0.0
    for n in range(birth.size):
        d = diameter[n]
        x = abs(d - (s - birth[n]))
        if x < d:
            total += 0.5 * strength[n] * (d * d * acos(x / d) - x * sqrt(d * d - x * x))
    return total


def solve_numpy(stretch: Stretch, tolerance: float) -> Doubles:
    """Move by solve_ivp of order 8, the force by arrays."""
    return _solve(stretch, tolerance, numpy_force)


def solve_compiled(stretch: Stretch, tolerance: float) -> Doubles:
    """Move by solve_ivp of order 8, the force compiled."""
    return _solve(stretch, tolerance, compiled_force)


def rk4_compiled(stretch: Stretch, step: float) -> Doubles:
    """Move by Runge-Kutta steps, all of it compiled."""
    found = np.empty(stretch.times.size)
    rows = (stretch.birth, stretch.diameter, stretch.strength)
    constants = (stretch.mass, stretch.stiffness, stretch.damping, stretch.speed)
    _rk4(rows, constants, stretch.displacement, stretch.times, step, found)
    return found


def _solve(stretch: Stretch, tolerance: float, force: Forces) -> Doubles:
    k, c, speed = stretch.stiffness, stretch.damping, stretch.speed
    birth, d, strength, times = stretch.birth, stretch.diameter, stretch.strength, stretch.times
    cuts = np.unique(np.concatenate([birth, birth + d, birth + 2.0 * d, [-inf, inf]]))
    end, found, told = float(times[-1]), np.full(times.size, stretch.displacement), 0
    t, x, v, s, way = 0.0, stretch.displacement, 0.0, 0.0, 1.0
    until = LONGEST

    while t < end:
        # What is at a border belongs to the piece ahead.
        piece = int(np.searchsorted(cuts, s, "right" if way > 0.0 else "left"))
        border = float(cuts[piece] if way > 0.0 else cuts[piece - 1])
        middle = min(max(0.5 * (s + border), s - 1.0), s + 1.0)
        live = np.flatnonzero((birth < middle) & (middle < birth + 2.0 * d))
        rows = (birth[live], d[live], strength[live])
        place, slope, events = _piece(stretch, rows, force, (t, x, s), way, border)
        until = min(until, end)
        asked = times[told : int(np.searchsorted(times, until))]
        step = solve_ivp(
            slope,
            (t, until),
            (x, v),
            "DOP853",
            np.append(asked, until),
            events=events,
            rtol=tolerance,
            atol=tolerance * np.array([1.0, speed]),
        )
        missed = [
            time
            for time, (_, speed_there) in zip(step.t_events[TURN], step.y_events[TURN], strict=True)
            if time > t + AT_ONCE and way * (speed - speed_there) < 0.0
        ]
        if missed and not len(step.t_events[STANDSTILL]):
            # It has stood still and gone on, both within one step: so far and no further.
            until = float(missed[0])
            continue
        which = next((n for n in (STANDSTILL, BORDER) if len(step.t_events[n])), None)
        if count := min(len(step.t), asked.size):
            found[told : told + count] = step.y[0][:count]
            told += count
        if which is None:
            t, x, v = until, float(step.y[0][-1]), float(step.y[1][-1])
        else:
            t, (x, v) = float(step.t_events[which][0]), step.y_events[which][0].tolist()
        s, until = place(t, x), t + LONGEST
        if which == BORDER:
            s = border
        if which != STANDSTILL:
            continue
        v, bears, pull = speed, force(s, *rows), k * x + c * speed
        if abs(pull) > bears:
            way = 1.0 if pull > 0.0 else -1.0
            continue
        rest, way = (bears - pull) / (k * speed), 1.0
        while told < times.size and times[told] <= t + rest:
            found[told] = x + speed * (times[told] - t)
            told += 1
        t, x, until = t + rest, x + speed * rest, t + rest + LONGEST
    found[told:] = x
    return found


def _piece(
    stretch: Stretch,
    rows: tuple[Doubles, Doubles, Doubles],
    force: Forces,
    begin: tuple[float, float, float],
    way: float,
    border: float,
) -> tuple[Callable[[float, float], float], Callable[[float, Doubles], list[float]], tuple[Any, ...]]:
    """Return the place and the slope in a piece of slip, and its events: w = 0, the border, and w turning from 0."""
    m, k, c, speed = stretch.mass, stretch.stiffness, stretch.damping, stretch.speed
    start_time, start, start_place = begin

    def place(time: float, x: float) -> float:
        return start_place + speed * (time - start_time) - (x - start)

    def slope(time: float, state: Doubles) -> list[float]:
        x, v = state
        return [v, (way * force(place(time, x), *rows) - c * v - k * x) / m]

    def standstill(_: float, state: Doubles) -> float:
        return float(speed - state[1])

    def reached(time: float, state: Doubles) -> float:
        # Where there is no border, nothing is ever passed.
        return float(np.clip(place(time, state[0]) - border, -1e9, 1e9))

    def turn(time: float, state: Doubles) -> float:
        return -slope(time, state)[1]

    standstill.terminal, standstill.direction = True, -way  # type: ignore[attr-defined]
    reached.terminal = True  # type: ignore[attr-defined]
    turn.direction = way  # type: ignore[attr-defined]
    return place, slope, (standstill, reached, turn)


@numba.njit(cache=True)
def _rk4(  # noqa: C901
    every: Sequence[Doubles], constants: Sequence[float], x: float, times: Doubles, step: float, found: Doubles
) -> None:
    """Fill displacements at the times, at which steps end, from rest at x; a step to w = 0 is found by bisection."""
    birth, diameter, strength = every
    _, k, c, speed = constants
    longest = 2.0 * diameter.max()
    start, t, v, way, told = x, 0.0, 0.0, 1.0, 0
    first, last = 0, 0
    while told < times.size:
        if t >= times[told] - 1e-6 * step:
            t, found[told] = times[told], x
            told += 1
            continue
        h = min(step, times[told] - t)
        s = speed * t - (x - start)
        while first > 0 and birth[first - 1] > s - longest - 1.0:
            first -= 1
        while first < birth.size and birth[first] < s - longest - 1.0:
            first += 1
        while last > 0 and birth[last - 1] > s + 1.0:
            last -= 1
        while last < birth.size and birth[last] < s + 1.0:
            last += 1
        rows = (birth[first:last], diameter[first:last], strength[first:last])
        after, w = _rk4_step(t, x, v, h, way, start, constants, rows)
        if way * (speed - w) > 0.0:
            t, x, v = t + h, after, w
            continue
        low, high = 0.0, h
        for _ in range(50):
            h = 0.5 * (low + high)
            after, w = _rk4_step(t, x, v, h, way, start, constants, rows)
            if way * (speed - w) > 0.0:
                low = h
            else:
                high = h
        t, x, v = t + high, after, speed
        bears, pull = compiled_force(speed * t - (x - start), *rows), k * x + c * speed
        if abs(pull) > bears:
            way = 1.0 if pull > 0.0 else -1.0
            continue
        rest, way = (bears - pull) / (k * speed), 1.0
        while told < times.size and times[told] <= t + rest:
            found[told] = x + speed * (times[told] - t)
            told += 1
        t, x = t + rest, x + speed * rest


@numba.njit(cache=True)
def _rk4_step(
    t: float,
    x: float,
    v: float,
    h: float,
    way: float,
    start: float,
    constants: Sequence[float],
    rows: Sequence[Doubles],
) -> tuple[float, float]:
    m, k, c, speed = constants
    birth, d, strength = rows
    half = 0.5 * h
    a1 = (way * compiled_force(speed * t - (x - start), birth, d, strength) - c * v - k * x) / m
    x2, v2 = x + half * v, v + half * a1
    a2 = (way * compiled_force(speed * (t + half) - (x2 - start), birth, d, strength) - c * v2 - k * x2) / m
    x3, v3 = x + half * v2, v + half * a2
    a3 = (way * compiled_force(speed * (t + half) - (x3 - start), birth, d, strength) - c * v3 - k * x3) / m
    x4, v4 = x + h * v3, v + h * a3
    a4 = (way * compiled_force(speed * (t + h) - (x4 - start), birth, d, strength) - c * v4 - k * x4) / m
    return x + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0, v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
