"""Sliders moved by other means than the engine's: slow, plain, and nothing shared with it.

Two ways for a slider that does not push back: exact convolution, and an adaptive Runge-Kutta method; and fixed small
steps for one that bounces.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from tests.oracle.slow_contact import Doubles, Rows, triangle_area


@dataclass(frozen=True, slots=True, kw_only=True)
class Oscillator:
    """m x'' + c x' + k x = F: mass kg, stiffness N/m, damping N s/m."""

    mass: float
    stiffness: float
    damping: float

    @property
    def natural_rate(self) -> float:
        """Return the undamped rate sqrt(k/m) in rad/s."""
        return math.sqrt(self.stiffness / self.mass)

    @property
    def fastest_rate(self) -> float:
        """Return the larger |root| of m L^2 + c L + k = 0, per second."""
        decay = self.damping / (2 * self.mass)
        if decay <= self.natural_rate:
            return self.natural_rate
        return decay + math.sqrt(decay**2 - self.natural_rate**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Displacement (um) and velocity (um/s) at given distances, the first of them the start."""

    displacement: Doubles
    velocity: Doubles


# Exact convolution, the force of each junction integrated in an angle where it is entire.
# On the rising half of a life s = d (1 - cos t), t in [0, pi/2], the lens is d^2 (t - sin t cos t)/2, ds = d sin t dt;
# the falling half is its mirror. Gauss-Legendre in t against the oscillator's impulse response then converges to
# rounding on every piece between ticks, births, mid-lives and deaths. Between ticks the exact transition carries on.
NODES = 20
PHASE_PER_PANEL = 1.5
CRITICAL = 1e-9


def impulse_response(slider: Oscillator, time: Doubles) -> tuple[Doubles, Doubles]:
    """Return g and g' for m = 1: the displacement and velocity after a unit impulse, at times in s (g in s).

    Under-damped e^(-at) sin(wt)/w, critical t e^(-at), over-damped (e^(L1 t) - e^(L2 t))/(L1 - L2).
    """
    a = slider.damping / (2 * slider.mass)
    square = slider.natural_rate**2 - a**2
    if abs(square) < CRITICAL * a**2:
        decay = np.exp(-a * time)
        return time * decay, (1 - a * time) * decay
    w = np.sqrt(abs(square))
    if square > 0:
        decay = np.exp(-a * time)
        return decay * np.sin(w * time) / w, decay * (np.cos(w * time) - a / w * np.sin(w * time))
    slow, fast = -(slider.natural_rate**2) / (a + w), -(a + w)
    g = -np.exp(slow * time) * np.expm1((fast - slow) * time) / (2 * w)
    return g, (slow * np.exp(slow * time) - fast * np.exp(fast * time)) / (2 * w)


def transition_minus_one(slider: Oscillator, step: float) -> list[list[float]]:
    """Return the free motion of (x, v) over a step (s) less the identity, worked out with 60 digits.

    With b = w t the transition is e^(-at) ((cos b + a sin b/w, sin b/w), (-w0^2 sin b/w, cos b - a sin b/w)).
    """
    with mpmath.workdps(60):
        a = mpmath.mpf(slider.damping) / (2 * mpmath.mpf(slider.mass))
        stiffness = mpmath.mpf(slider.stiffness) / mpmath.mpf(slider.mass)
        h = mpmath.mpf(step)
        w: Any = mpmath.sqrt(mpmath.mpc(stiffness - a**2))
        cosine = mpmath.cos(w * h)
        sine = h if w == 0 else mpmath.sin(w * h) / w
        decay = mpmath.exp(-a * h)
        free = [[cosine + a * sine, sine], [-stiffness * sine, cosine - a * sine]]
        return [[float(mpmath.re(decay * free[i][j]) - (i == j)) for j in (0, 1)] for i in (0, 1)]


def pieces(rows: Rows, row: int, ticks: Doubles) -> Doubles:
    """Return the distances that cut one life into smooth pieces inside the ticks, its ends included."""
    birth, diameter = rows.birth[row], rows.diameter[row]
    end = min(rows.death[row], birth + 2 * diameter)
    cuts = np.concatenate([ticks, [birth, birth + diameter, end]])
    inside = (cuts >= max(birth, ticks[0])) & (cuts <= min(end, ticks[-1]))
    return np.unique(cuts[inside])


def angle(since_birth: Doubles, diameter: float) -> Doubles:
    """Return t of s = d (1 - cos t) for s on the rising half, its mirror's for s on the falling half."""
    rising = np.clip(np.minimum(since_birth, 2 * diameter - since_birth), 0, diameter)
    return 2 * np.arcsin(np.sqrt(rising / (2 * diameter)))


def add_lens_impulses(
    slider: Oscillator, speed: float, ticks: Doubles, rows: Rows, row: int, impulses: Doubles, panels: int
) -> None:
    """Add what one junction's force does to (x, v) within each cell, at the cell's end."""
    birth, d = rows.birth[row], rows.diameter[row]
    cuts = pieces(rows, row, ticks)
    if len(cuts) < 2:
        return
    middle = (cuts[1:] + cuts[:-1]) / 2
    cell = np.searchsorted(ticks, middle) - 1
    falling = middle > birth + d
    # A piece's two angles; on the falling half they run backwards, which the absolute width undoes.
    start, stop = angle(cuts[:-1] - birth, d), angle(cuts[1:] - birth, d)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    for panel in range(panels):
        low = start + (stop - start) * panel / panels
        high = start + (stop - start) * (panel + 1) / panels
        t = ((high + low)[:, None] + (high - low)[:, None] * nodes) / 2
        risen = d * (1 - np.cos(t))
        s = birth + np.where(falling[:, None], 2 * d - risen, risen)
        area = d**2 * (t - np.sin(t) * np.cos(t)) / 2
        width = np.abs(high - low)[:, None] / 2 * weights * d * np.sin(t) / speed
        impulse = rows.strength[row] / slider.mass * area * width
        g, rate = impulse_response(slider, (ticks[cell + 1][:, None] - s) / speed)
        np.add.at(impulses[0], cell, (impulse * g).sum(axis=1))
        np.add.at(impulses[1], cell, (impulse * rate).sum(axis=1))


def theta_motion(
    slider: Oscillator,
    speed: float,
    ticks: Doubles,
    rows: Rows,
    start: tuple[float, float],
    add: Callable[[Oscillator, float, Doubles, Rows, int, Doubles, int], None] = add_lens_impulses,
) -> Motion:
    """Return the motion at equally spaced ticks (um) of a slider that begins at ticks[0] with start = (x um, v um/s).

    speed in um/s; m x'' + c x' + k x = sum psi_i A_i(V t); ``add`` adds the impulses of one junction.
    """
    tick = (ticks[-1] - ticks[0]) / (len(ticks) - 1)
    panels = max(1, int(np.ceil(slider.fastest_rate * tick / speed / PHASE_PER_PANEL)))
    impulses = np.zeros((2, len(ticks) - 1))
    for row in range(len(rows.birth)):
        add(slider, speed, ticks, rows, row, impulses, panels)
    change = np.array(transition_minus_one(slider, tick / speed))
    states = [np.array(start)]
    for impulse in impulses.T:
        states.append(states[-1] + (change @ states[-1] + impulse))
    x, v = np.array(states).T
    return Motion(displacement=x, velocity=v)


# The same under triangular lives, whose force is straight between births, mid-lives, deaths and ticks.
def add_triangle_impulses(
    slider: Oscillator, speed: float, ticks: Doubles, rows: Rows, row: int, impulses: Doubles, panels: int
) -> None:
    """Add what one junction's force does to (x, v) within each cell, at the cell's end."""
    birth, d, strength = rows.birth[row], rows.diameter[row], rows.strength[row]
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    cuts = pieces(rows, row, ticks)
    for start, stop in pairwise(cuts):
        cell = np.searchsorted(ticks, (start + stop) / 2) - 1
        edges = np.linspace(start, stop, panels + 1)
        width = (edges[1:] - edges[:-1])[:, None] / 2
        s = ((edges[1:] + edges[:-1])[:, None] / 2 + width * nodes).ravel()
        area = np.array([triangle_area(place - birth, d) for place in s])
        impulse = strength / slider.mass * area * (width * weights).ravel() / speed
        g, rate = impulse_response(slider, (ticks[cell + 1] - s) / speed)
        impulses[:, cell] += (impulse * g).sum(), (impulse * rate).sum()


def straight_motion(slider: Oscillator, speed: float, ticks: Doubles, rows: Rows, start: tuple[float, float]) -> Motion:
    """Return the motion as `theta_motion` does, under triangular lives."""
    return theta_motion(slider, speed, ticks, rows, start, add_triangle_impulses)


# An adaptive Runge-Kutta method, begun anew at every birth, mid-life, death and tick.
# Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I", DOP853. A junction's area leaves 0 as s^1.5 and
# returns to it so; within each stretch the clock runs as 3 q^2 - 2 q^3, which makes both ends smooth in q.
RELATIVE_TOLERANCE = 1e-13
Areas = Callable[[Doubles, Doubles], Doubles]


def lens_areas(x: Doubles, d: Doubles) -> Doubles:
    """Return areas (um^2) of lenses of diameter d (um) whose centres are x <= d (um) apart."""
    return d**2 / 2 * np.arccos(x / d) - x / 2 * np.sqrt((d - x) * (d + x))


def triangle_areas(x: Doubles, d: Doubles) -> Doubles:
    """Return areas (um^2) of triangular lives at a distance x <= d (um) from their mid-lives."""
    return np.pi * d / 4 * (d - x)


def live_force(rows: Rows, live: NDArray[np.bool_], s: float, areas_of: Areas) -> float:
    """Return sum psi A (uN) at a distance s (um) over the junctions that live on this stretch."""
    d = rows.diameter[live]
    x = np.minimum(np.abs(d - (s - rows.birth[live])), d)
    return float(rows.strength[live] @ areas_of(x, d))


def stretches(rows: Rows, ticks: Doubles) -> Doubles:
    """Return every distance at which the integration begins anew, the first and the last tick included."""
    death = np.minimum(rows.death, rows.birth + 2 * rows.diameter)
    cuts = np.unique(np.concatenate([ticks, rows.birth, rows.birth + rows.diameter, death]))
    return cuts[(cuts >= ticks[0]) & (cuts <= ticks[-1])]


def crossed(
    slider: Oscillator, speed: float, rows: Rows, state: Doubles, start: float, stop: float, areas_of: Areas
) -> Doubles:
    """Return (x, v) at the end of a stretch (um) on which no junction is born, passes mid-life or dies."""
    from scipy.integrate import solve_ivp  # loading it takes longer than most tests, and tests.models needs this file

    length = stop - start
    middle = start + length / 2
    live = (rows.birth < middle) & (middle < rows.death)

    def slope(q: float, y: Doubles) -> Doubles:
        force = live_force(rows, live, start + length * q * q * (3 - 2 * q), areas_of)
        acceleration = (force - slider.damping * y[1] - slider.stiffness * y[0]) / slider.mass
        return np.array([y[1], acceleration]) * (length / speed * 6 * q * (1 - q))

    size = max(abs(state[0]), abs(state[1]) / slider.natural_rate, 1e-3)
    tolerance = 1e-15 * size * np.array([1.0, slider.natural_rate])
    solution = solve_ivp(slope, (0.0, 1.0), state, method="DOP853", rtol=RELATIVE_TOLERANCE, atol=tolerance)
    if not solution.success:
        raise ArithmeticError(f"no solution from {start} to {stop} um: {solution.message}")
    return np.asarray(solution.y[:, -1])


def stepped_motion(
    slider: Oscillator,
    speed: float,
    ticks: Doubles,
    rows: Rows,
    start: tuple[float, float],
    areas_of: Areas = lens_areas,
) -> Motion:
    """Return the motion at ticks (um) of a slider that begins at ticks[0] with start = (x um, v um/s).

    speed in um/s; m x'' + c x' + k x = sum psi_i A_i(V t), the areas those of the paper's lens or of another pulse.
    """
    cuts = stretches(rows, ticks)
    state = np.array(start, dtype=np.float64)
    states = [state]
    for low, high in pairwise(cuts):
        state = crossed(slider, speed, rows, state, low, high, areas_of)
        states.append(state)
    x, v = np.array(states)[np.isin(cuts, ticks)].T
    return Motion(displacement=x, velocity=v)


# A slider that bounces over paraboloids, by fixed small steps of Verlet.
FINER = 512
"""Steps instead of one in which an overlap stops growing or shrinking: where forces jump, Verlet is of first order."""


def bounce(
    place: Doubles,
    height: Doubles,
    live: float,
    speed: float,
    loss: Callable[[Doubles], Doubles],
    duration: float,
    steps: int,
    damping_ratio: float = 0.0,
    finer: int = FINER,
) -> Doubles:
    """Return z at every tenth step from z = z' = 0; loss: of overlaps and their rates, the share of the force."""
    h = duration / steps

    def overlaps(t: float, z: float, w: float) -> tuple[Doubles, Doubles]:
        off = speed * t - place
        return np.maximum(height - off * off - z, 0.0), -2.0 * speed * off - w

    def pull(t: float, z: float, w: float) -> float:
        overlap, rate = overlaps(t, z, w)
        return float((overlap * loss(rate)).sum()) / live - 1.0 - 2.0 * damping_ratio * w

    def moved(end: float, h: float, z: float, w: float, a: float) -> tuple[float, float, float]:
        z += h * w + 0.5 * h * h * a
        ahead = w + h * a
        for _ in range(3):
            new = pull(end, z, ahead)
            ahead = w + 0.5 * h * (a + new)
        return z, ahead, new

    def turns(t: float, before: tuple[float, ...], after: tuple[float, ...]) -> bool:
        """Whether an overlap turns between two ends of a step."""
        (begun, rate), (ended, later) = overlaps(t - h, *before[:2]), overlaps(t, *after[:2])
        return bool(((begun + ended > 0.0) & (rate * later < 0.0)).any())

    now = 0.0, 0.0, pull(0.0, 0.0, 0.0)
    found = [0.0]
    for n in range(1, steps + 1):
        after = moved(n * h, h, *now)
        if turns(n * h, now, after):
            after = now
            for part in range(1, finer + 1):
                after = moved((n - 1 + part / finer) * h, h / finer, *after)
        now = after
        if n % 10 == 0:
            found.append(now[0])
    return np.array(found)
