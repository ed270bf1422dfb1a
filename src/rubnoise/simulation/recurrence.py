"""The slider's recurrence over the cells of a panel, compiled."""

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, fused


@compiled_bare
def advance_slider(
    moments: Doubles, transition: Doubles, gains: Doubles, every: int, displacement: Doubles, velocity: Doubles
) -> None:
    """Step the slider through cells, exactly in the propagator.

    moments (3, cells): Legendre moments of the force over each cell, in units in which gains (2, 3) are what they add
    to x and x'. transition (2, 2) is the free motion over a cell less the identity. displacement (um) and velocity
    (um/s) begin with the state before the first cell and receive the state after every ``every``-th one.
    """
    x, v = displacement[0], velocity[0]
    # By name, since the compiler can't know that none of them is among the numbers written.
    x_from_x, x_from_v, v_from_x, v_from_v = transition[0, 0], transition[0, 1], transition[1, 0], transition[1, 1]
    x_mean, x_slope, x_bend = gains[0, 0], gains[0, 1], gains[0, 2]
    v_mean, v_slope, v_bend = gains[1, 0], gains[1, 1], gains[1, 2]
    means, slopes, bends = moments[0], moments[1], moments[2]
    cell = 0
    for tick in range(1, len(means) // every + 1):
        for _ in range(every):
            push_x = x_mean * means[cell] + x_slope * slopes[cell] + x_bend * bends[cell]
            push_v = v_mean * means[cell] + v_slope * slopes[cell] + v_bend * bends[cell]
            # Two short chains for each: nothing else has to be waited for.
            next_x = fused(x_from_x, x, x) + fused(x_from_v, v, push_x)
            v = fused(v_from_v, v, v) + fused(v_from_x, x, push_v)
            x = next_x
            cell += 1
        displacement[tick] = x
        velocity[tick] = v
