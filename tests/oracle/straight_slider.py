"""The slider's motion under triangular lives, whose force is straight between births, mid-lives, deaths and ticks.

Gauss-Legendre of that straight force against the oscillator's impulse response, piece by piece; between ticks the
motion is carried by the exact transition.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from tests.oracle import theta_slider
from tests.oracle.oscillator import Doubles, Motion, Oscillator
from tests.oracle.slow_contact import Rows, triangle_area
from tests.oracle.theta_slider import impulse_response, pieces

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
    """Return the motion as `theta_slider.motion` does, under triangular lives."""
    return theta_slider.motion(slider, speed, ticks, rows, start, add_impulses)
