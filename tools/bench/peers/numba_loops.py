"""Plain loops in numba: junction by junction and tick by tick with the arc cosine, and a Runge-Kutta step a tick."""

from math import acos, sqrt

import numba
import numpy as np

from bench.case import DAMPING, MASS, STIFFNESS, STRENGTH, Case, Doubles
from bench.peers.tables import maker


@numba.njit(cache=True)
def add_pulses(birth: Doubles, diameter: Doubles, tick: float, area: Doubles, count: Doubles) -> None:
    """Add every junction to area (um^2) and count at the ticks of its life."""
    for n in range(birth.size):
        b, d = birth[n], diameter[n]
        first = int(np.ceil(b / tick))
        while first < area.size and first * tick < b + 2.0 * d:
            x = min(abs(d - (first * tick - b)), d)
            area[first] += 0.5 * (d * d * acos(x / d) - x * sqrt(d * d - x * x))
            count[first] += 1.0
            first += 1


@numba.njit(cache=True)
def move(force: Doubles, h: float, displacement: Doubles, velocity: Doubles) -> None:
    """Step the slider by the classical Runge-Kutta method, the force a straight line between ticks."""
    x, v = 0.0, 0.0
    for n in range(force.size - 1):
        middle = 0.5 * (force[n] + force[n + 1])
        a1 = (force[n] - DAMPING * v - STIFFNESS * x) / MASS
        v2 = v + 0.5 * h * a1
        a2 = (middle - DAMPING * v2 - STIFFNESS * (x + 0.5 * h * v)) / MASS
        v3 = v + 0.5 * h * a2
        a3 = (middle - DAMPING * v3 - STIFFNESS * (x + 0.5 * h * v2)) / MASS
        v4 = v + h * a3
        a4 = (force[n + 1] - DAMPING * v4 - STIFFNESS * (x + h * v3)) / MASS
        x += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
        v += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
        displacement[n + 1], velocity[n + 1] = x, v


def superpose(case: Case, birth: Doubles, diameter: Doubles) -> tuple[Doubles, Doubles]:
    """Return real contact area (um^2) and number of junctions at the ticks."""
    area, count = np.zeros(case.tick_count + 1), np.zeros(case.tick_count + 1)
    add_pulses(birth, diameter, case.tick, area, count)
    return area, count


def slider(case: Case, area: Doubles) -> tuple[Doubles, Doubles]:
    """Return displacement (um) and velocity (um/s) at the ticks."""
    displacement, velocity = np.zeros(area.size), np.zeros(area.size)
    move(STRENGTH * area, case.step, displacement, velocity)
    return displacement, velocity


run = maker(superpose, slider)
