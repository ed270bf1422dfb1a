"""The slider's recurrence over the cells of a panel, compiled."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.compiling import compiled_bare

Doubles = NDArray[np.float64]


@compiled_bare
def advance_slider(
    moments: Doubles, transition: Doubles, gains: Doubles, every: int, displacement: Doubles, velocity: Doubles
) -> None:
    """Step the slider through cells, exactly in the propagator.

    moments (3, cells): Legendre moments of the force over each cell, in units in which gains (2, 3) are what they add
    to x and x'. transition (2, 2) is the free motion over a cell less the identity. displacement (um) and velocity
    (um/s) begin with the state before the first cell and receive the state after every ``every``-th one.
    """
    x = displacement[0]
    v = velocity[0]
    for cell in range(moments.shape[1]):
        mean, slope, bend = moments[0, cell], moments[1, cell], moments[2, cell]
        next_x = transition[0, 0] * x + transition[0, 1] * v
        next_v = transition[1, 0] * x + transition[1, 1] * v
        next_x += gains[0, 0] * mean + gains[0, 1] * slope + gains[0, 2] * bend
        next_v += gains[1, 0] * mean + gains[1, 1] * slope + gains[1, 2] * bend
        x += next_x
        v += next_v
        if (cell + 1) % every == 0:
            displacement[(cell + 1) // every] = x
            velocity[(cell + 1) // every] = v
