"""NumPy and SciPy: the pulses added one junction at a time, the slider by scipy.signal.lsim."""

import numpy as np
from scipy.signal import lsim

from bench.case import DAMPING, MASS, STIFFNESS, STRENGTH, Case, Doubles
from bench.peers.tables import maker


def superpose(case: Case, birth: Doubles, diameter: Doubles) -> tuple[Doubles, Doubles]:
    """Return real contact area (um^2) and number of junctions at the ticks."""
    ticks = case.ticks
    area, change = np.zeros(ticks.size), np.zeros(ticks.size + 1)
    first = np.searchsorted(ticks, birth)
    last = np.searchsorted(ticks, birth + 2.0 * diameter)
    for b, d, i, j in zip(birth, diameter, first, last, strict=True):
        x = np.minimum(np.abs(d - (ticks[i:j] - b)), d)
        area[i:j] += 0.5 * (d * d * np.arccos(x / d) - x * np.sqrt(d * d - x * x))
    np.add.at(change, first, 1.0)
    np.add.at(change, last, -1.0)
    return area, np.cumsum(change)[:-1]


def move(case: Case, area: Doubles) -> tuple[Doubles, Doubles]:
    """Return displacement (um) and velocity (um/s) at the ticks, the force a straight line between them."""
    matrices = ([[0.0, 1.0], [-STIFFNESS / MASS, -DAMPING / MASS]], [[0.0], [1.0 / MASS]], np.eye(2), np.zeros((2, 1)))
    _, motion, _ = lsim(matrices, STRENGTH * area, np.arange(area.size) * case.step)
    return motion[:, 0], motion[:, 1]


run = maker(superpose, move)
