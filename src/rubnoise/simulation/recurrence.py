"""The slider's recurrence over the cells of a panel, compiled."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.simulation.compiling import compiled

Doubles = NDArray[np.float64]


@compiled
def advance_slider(
    positions: Doubles,
    integrals: Doubles,
    corrections: Doubles,
    transition: Doubles,
    gains: Doubles,
    every: int,
    displacement: Doubles,
    velocity: Doubles,
) -> None:
    """Step the slider through the cells between positions, exactly in the propagator.

    displacement (um) and velocity (um/s) begin with the state at positions[0] and receive the state at every
    ``every``-th position. transition (2, 2) is the free motion over a cell less the identity; gains (2, 3) is what
    the three Legendre moments of the force over the cell (uN um) add to x and x'.
    """
    x = displacement[0]
    v = velocity[0]
    for cell in range(1, len(positions)):
        width = positions[cell] - positions[cell - 1]
        low1, low2, low3 = integrals[0, cell - 1], integrals[1, cell - 1], integrals[2, cell - 1]
        top1, top2, top3 = integrals[0, cell], integrals[1, cell], integrals[2, cell]
        mean = (top1 - low1) + corrections[0, cell]
        slope = (top1 + low1) - 2.0 * (top2 - low2) / width + corrections[1, cell]
        bend = (top1 - low1) - 6.0 * (top2 + low2) / width + 12.0 * (top3 - low3) / (width * width)
        bend += corrections[2, cell]
        next_x = transition[0, 0] * x + transition[0, 1] * v
        next_v = transition[1, 0] * x + transition[1, 1] * v
        next_x += gains[0, 0] * mean + gains[0, 1] * slope + gains[0, 2] * bend
        next_v += gains[1, 0] * mean + gains[1, 1] * slope + gains[1, 2] * bend
        x += next_x
        v += next_v
        if cell % every == 0:
            displacement[cell // every] = x
            velocity[cell // every] = v
