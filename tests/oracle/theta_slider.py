"""The slider's motion by exact convolution, the force of each junction integrated in an angle where it is entire.

On the rising half of a life s = d (1 - cos t), t in [0, pi/2], the lens is d^2 (t - sin t cos t)/2 and ds = d sin t dt;
the falling half is its mirror. Gauss-Legendre in t against the oscillator's impulse response then converges to rounding
on every piece between ticks, births, mid-lives and deaths. Between ticks the motion is carried by the exact transition.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np

from tests.oracle.oscillator import Doubles, Motion, Oscillator
from tests.oracle.slow_contact import Rows

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


def add_impulses(
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


def motion(
    slider: Oscillator,
    speed: float,
    ticks: Doubles,
    rows: Rows,
    start: tuple[float, float],
    add: Callable[[Oscillator, float, Doubles, Rows, int, Doubles, int], None] = add_impulses,
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
