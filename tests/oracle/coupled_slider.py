"""A slider that is coupled two ways, by an adaptive Runge-Kutta method with events: slow, plain, and all of its own.

m x'' + c x' + k x in G(s) Sgn(w), w = V - x', s = V t - (x - x_0): slip is integrated with DOP853 from one birth,
mid-life or death to the next, and ends where w = 0; a stick lasts (G - f)/(k V), f = k x + c V.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.oracle.sliders import Oscillator, lens_areas
from tests.oracle.slow_contact import Rows

Doubles = NDArray[np.float64]
STICK, BREAKAWAY, REVERSAL, FORWARD = range(4)


@dataclass(frozen=True, slots=True, kw_only=True)
class Landmark:
    """Where the slider begins to stick, to slip, to run back or to run on: time (s), distance, displacement (um)."""

    kind: int
    time: float
    distance: float
    displacement: float


@dataclass(slots=True, kw_only=True)
class Coupled:
    """The motion so far: landmarks, and pieces of it as (begin, end, x(t), x'(t))."""

    landmarks: list[Landmark] = field(default_factory=list)
    pieces: list[tuple[float, float, Callable[[float], tuple[float, float]]]] = field(default_factory=list)

    def at(self, times: Doubles) -> tuple[Doubles, Doubles]:
        """Return displacement (um) and velocity (um/s) at increasing times (s)."""
        found, piece = [], 0
        for time in times.tolist():
            while self.pieces[piece][1] < time:
                piece += 1
            found.append(self.pieces[piece][2](time))
        x, v = np.array(found).T
        return x, v


def force_at(rows: Rows, s: float, areas_of: Callable[[Doubles, Doubles], Doubles] = lens_areas) -> float:
    """Return G = sum psi A in uN at a distance s (um)."""
    live = (rows.birth < s) & (s < rows.birth + 2 * rows.diameter)
    d = rows.diameter[live]
    x = np.minimum(np.abs(d - (s - rows.birth[live])), d)
    return float(rows.strength[live] @ areas_of(x, d))


def _ride(begin: float, x: float, speed: float, time: float) -> tuple[float, float]:
    """Return displacement and velocity in a stick, which the drive carries along."""
    return x + speed * (time - begin), speed


def motion(  # noqa: C901, PLR0915
    slider: Oscillator,
    speed: float,
    rows: Rows,
    displacement: float,
    duration: float,
    *,
    tolerance: float = 1e-12,
    areas_of: Callable[[Doubles, Doubles], Doubles] = lens_areas,
) -> Coupled:
    """Return the motion from s = 0 and rest at a displacement (um) over a duration (s), driven at a speed (um/s)."""
    m, k, c = slider.mass, slider.stiffness, slider.damping
    cuts = np.unique(np.concatenate([rows.birth, rows.birth + rows.diameter, rows.birth + 2 * rows.diameter]))
    found = Coupled()
    t, x, s, w = 0.0, displacement, 0.0, speed
    way = 1.0
    scale = max(abs(displacement), 1.0)

    def tell(kind: int) -> None:
        found.landmarks.append(Landmark(kind=kind, time=t, distance=s, displacement=x))

    while t < duration:
        ahead = cuts[cuts > s + 1e-13] if way > 0 else cuts[cuts < s - 1e-13]
        cut = (ahead.min() if way > 0 else ahead.max()) if ahead.size else s + way * 1e3
        middle = 0.5 * (s + cut)
        live = (rows.birth < middle) & (middle < rows.birth + 2 * rows.diameter)
        born, d, psi = rows.birth[live], rows.diameter[live], rows.strength[live]
        begin, place, start = t, s, x

        def force(s: float, born: Doubles = born, d: Doubles = d, psi: Doubles = psi) -> float:
            return float(psi @ areas_of(np.minimum(np.abs(d - (s - born)), d), d))

        def slope(
            t: float,
            y: Doubles,
            force: Callable[[float], float] = force,
            begin: float = begin,
            start: float = start,
            way: float = way,
        ) -> tuple[float, float]:
            x = start + speed * (t - begin) - y[0]
            return y[1], (k * x + c * (speed - y[1]) - way * force(place + y[0])) / m  # noqa: B023

        def standstill(t: float, y: Doubles) -> float:
            return float(y[1])

        def border(t: float, y: Doubles, length: float = cut - s) -> float:
            return float(y[0]) - length

        def turn(t: float, y: Doubles, slope: Callable[..., tuple[float, float]] = slope) -> float:
            return slope(t, y)[1]

        standstill.terminal, standstill.direction = True, -way  # type: ignore[attr-defined]
        border.terminal = True  # type: ignore[attr-defined]
        turn.terminal, turn.direction = False, way  # type: ignore[attr-defined]
        step = solve_ivp(
            slope,
            (t, duration),
            (0.0, w),
            method="DOP853",
            rtol=tolerance,
            atol=tolerance * scale * np.array([1e-2, 1e-2 * slider.natural_rate]),
            max_step=0.3 / slider.fastest_rate,
            events=(standstill, border, turn),
            dense_output=True,
        )
        if not step.success:
            raise ArithmeticError(step.message)
        end = float(step.t[-1])
        arrived = step.status == 1 and step.t_events[0].size > 0
        for time, (_, least) in zip(step.t_events[2], step.y_events[2], strict=True):
            if time < end and way * least < 0.0 and not arrived:
                # Two standstills in one step of the method: the first is what counts.
                low = max((q for q in step.t if q < time), default=begin)
                end = float(brentq(lambda q: step.sol(q)[1], low, time, xtol=1e-16))  # noqa: B023
                arrived = True
        travelled, w = (float(value) for value in step.sol(end))

        def state(time: float, step: object = step, begin: float = begin, start: float = start) -> tuple[float, float]:
            y = step.sol(time)  # type: ignore[attr-defined]
            return start + speed * (time - begin) - float(y[0]), speed - float(y[1])

        found.pieces.append((begin, end, state))
        t, s, x = end, place + travelled, start + speed * (end - begin) - travelled
        if not arrived:
            if step.status == 1:
                s = float(cut)
            continue
        w = 0.0
        bears, f = force_at(rows, s, areas_of), k * x + c * speed
        if abs(f) <= bears:
            tell(STICK)
            rest = (bears - f) / (k * speed)
            found.pieces.append((t, t + rest, partial(_ride, t, x, speed)))
            t, x = t + rest, x + speed * rest
            if t < duration:
                tell(BREAKAWAY)
            way = 1.0
        elif f < -bears:
            if way > 0:
                tell(REVERSAL)
            way = -1.0
        else:
            if way < 0:
                tell(FORWARD)
            way = 1.0
    return found


def frozen(
    slider: Oscillator, speed: float, bears: float, displacement: float, landmarks: int
) -> list[tuple[int, float, float]]:
    """Return kind, time (s) and displacement (um) of the first landmarks with a constant G (uN): closed forms.

    In slip m x'' + c x' + k x = G d is a damped oscillation about d G/k; w = 0 where x' = V. Under-damped only.
    """
    m, k, c = slider.mass, slider.stiffness, slider.damping
    a = c / (2 * m)
    omega = math.sqrt(k / m - a * a)
    t, x, v, way = 0.0, displacement, 0.0, 1.0
    found: list[tuple[int, float, float]] = []
    while len(found) < landmarks:
        centre = way * bears / k
        p, q = x - centre, (v + a * (x - centre)) / omega

        def place(time: float, centre: float = centre, p: float = p, q: float = q) -> float:
            return centre + math.exp(-a * time) * (p * math.cos(omega * time) + q * math.sin(omega * time))

        def velocity(time: float, p: float = p, q: float = q) -> float:
            both = (q * omega - a * p) * math.cos(omega * time) - (p * omega + a * q) * math.sin(omega * time)
            return math.exp(-a * time) * both

        # From w = 0 the search begins a little later.
        later = 1e-7 if v == speed else 0.0
        grid = later + np.linspace(0.0, 2.2 * math.pi / omega, 20001)
        sign = np.array([way * (speed - velocity(time)) for time in grid.tolist()]) > 0.0
        crossed = np.flatnonzero(sign[:-1] & ~sign[1:])
        if not crossed.size:
            return found
        end = brentq(
            lambda time: speed - velocity(time), grid[crossed[0]], grid[crossed[0] + 1], xtol=1e-18, rtol=1e-15
        )
        t, x, v = t + end, place(end), speed
        f = k * x + c * speed
        if abs(f) <= bears:
            found.append((STICK, t, x))
            t, x = t + (bears - f) / (k * speed), (bears - c * speed) / k
            found.append((BREAKAWAY, t, x))
            way = 1.0
        elif f < -bears:
            if way > 0:
                found.append((REVERSAL, t, x))
            way = -1.0
        else:
            if way < 0:
                found.append((FORWARD, t, x))
            way = 1.0
    return found[:landmarks]
