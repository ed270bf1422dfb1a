"""The slider alone, driven through given junctions by methods that a user could pick."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from bench.case import DAMPING, MASS, SPEED, STIFFNESS, STRENGTH, Case, Doubles
from bench.peers import naive_numpy, naive_simpy, numba_loops

TOLERANCE = 1e-8
SMALLEST = 1e-6
"""Relative tolerance of solve_ivp, and its absolute one in um and um/s."""

Mover = Callable[[Case, Doubles], Doubles]
"""Returns displacements (um) at the ticks from the areas (um^2) there."""


def lsim(case: Case, area: Doubles) -> Doubles:
    """Move by scipy.signal.lsim, exact for a force that is straight between ticks."""
    return naive_numpy.move(case, area)[0]


def rk4_python(case: Case, area: Doubles) -> Doubles:
    """Move by Runge-Kutta steps in Python."""
    force = (STRENGTH * area).tolist()
    x, v, places = 0.0, 0.0, [0.0]
    for n in range(len(force) - 1):
        x, v = naive_simpy.rk4_step(x, v, force[n], force[n + 1], case.step)
        places.append(x)
    return np.array(places)


def rk4_numba(case: Case, area: Doubles) -> Doubles:
    """Move by Runge-Kutta steps in numba."""
    return numba_loops.slider(case, area)[0]


def solve_ticks(case: Case, area: Doubles) -> Doubles:
    """Move by scipy.integrate.solve_ivp, its default method, through a force interpolated between ticks."""
    times, force = case.ticks / SPEED, STRENGTH * area
    return _solve(times, lambda t: float(np.interp(t, times, force)), "RK45")


def solve_exactly(case: Case, birth: Doubles, diameter: Doubles) -> Doubles:
    """Move by solve_ivp of order 8 through the force itself, summed over the living whenever it is asked for."""
    longest = 2.0 * float(diameter.max())

    def force(t: float) -> float:
        s = t * SPEED
        near = slice(*np.searchsorted(birth, [s - longest, s]))
        d = diameter[near]
        x = np.minimum(np.abs(d - (s - birth[near])), d)
        return 0.5 * STRENGTH * float(np.sum(d * d * np.arccos(x / d) - x * np.sqrt(d * d - x * x)))

    return _solve(case.ticks / SPEED, force, "DOP853")


def _solve(times: Doubles, force: Callable[[float], float], method: str) -> Doubles:
    def slope(t: float, state: Doubles) -> list[float]:
        return [state[1], (force(t) - DAMPING * state[1] - STIFFNESS * state[0]) / MASS]

    span = (0.0, times[-1])
    # The force comes in pieces of at most a tick; a longer step would not see them.
    solved = solve_ivp(
        slope, span, [0.0, 0.0], method, times, rtol=TOLERANCE, atol=SMALLEST, max_step=times[1] - times[0]
    )
    return solved.y[0]
