"""The slider's motion under triangular lives, whose force is straight between births, mid-lives, deaths and ticks.

Gauss-Legendre of that straight force against the oscillator's impulse response, piece by piece; between ticks the
motion is carried by the exact transition.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from tests.oracle.oscillator import Doubles, Motion, Oscillator
from tests.oracle.slow_contact import Rows, triangle_area
from tests.oracle.theta_slider import PHASE_PER_PANEL, impulse_response, pieces, transition_minus_one

NODES = 20


def add_impulses(
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


def motion(slider: Oscillator, speed: float, ticks: Doubles, rows: Rows, start: tuple[float, float]) -> Motion:
    """Return the motion at equally spaced ticks (um) of a slider that begins at ticks[0] with start = (x um, v um/s).

    speed in um/s; m x'' + c x' + k x = sum psi_i A_i(V t).
    """
    tick = (ticks[-1] - ticks[0]) / (len(ticks) - 1)
    panels = max(1, int(np.ceil(slider.fastest_rate * tick / speed / PHASE_PER_PANEL)))
    impulses = np.zeros((2, len(ticks) - 1))
    for row in range(len(rows.birth)):
        add_impulses(slider, speed, ticks, rows, row, impulses, panels)
    change = np.array(transition_minus_one(slider, tick / speed))
    states = [np.array(start)]
    for impulse in impulses.T:
        states.append(states[-1] + (change @ states[-1] + impulse))
    x, v = np.array(states).T
    return Motion(displacement=x, velocity=v)
