"""The slider's motion by an adaptive Runge-Kutta method, begun anew at every birth, mid-life, death and tick.

Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I", DOP853. A junction's area leaves 0 as s^1.5 and
returns to it so; within each stretch the clock runs as 3 q^2 - 2 q^3, which makes both ends smooth in q.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tests.oracle.oscillator import Doubles, Motion, Oscillator
from tests.oracle.slow_contact import Rows

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


def motion(
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
