"""Where a place lies among the ticks, and how many junctions live at each: the same for every pulse; compiled.

The kernels of the pulses call this file, and the compiler's cache does not see that it has changed: after a change here
their files have to be touched, or their machine code of before goes on being used.
"""

import numpy as np
from numpy.typing import NDArray

from rubnoise.simulation.compiling import compiled

Doubles = NDArray[np.float64]


@compiled
def first_at_or_after(positions: Doubles, distance: float) -> int:
    """Return the first index whose position is not before a distance, or the number of positions."""
    count = len(positions)
    if count == 0 or positions[count - 1] < distance:
        return count
    if positions[0] >= distance:
        return 0
    spacing = (positions[count - 1] - positions[0]) / (count - 1)
    index = min(max(int((distance - positions[0]) / spacing), 0), count - 1)
    while index > 0 and positions[index - 1] >= distance:
        index -= 1
    while positions[index] < distance:
        index += 1
    return index


@compiled
def deposit_counts(positions: Doubles, birth: Doubles, departure: Doubles, change: NDArray[np.int64]) -> None:
    """Count every junction at the ticks at which it lives, birth <= s < departure.

    positions (um, increasing) and change have one entry a tick, birth and departure (um) one a junction; departure is
    infinite while a junction is alive. ``change`` receives differences: its running sum is the junction count.
    """
    ticks = len(positions)
    for row in range(len(birth)):
        first = first_at_or_after(positions, birth[row])
        last = first_at_or_after(positions, departure[row])
        if first < ticks:
            change[first] += 1
        if last < ticks:
            change[last] -= 1
