"""Where a place lies among the ticks, and how many junctions live at each: the same for every pulse; compiled."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.compiling import compiled, compiled_bare

Doubles = NDArray[np.float64]


@compiled_bare
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
def count_live(positions: Doubles, birth: Doubles, departure: Doubles, count: NDArray[np.uint32]) -> None:
    """Count the junctions that live at each tick, birth <= s < departure.

    positions (um, increasing) and count have one entry a tick, birth and departure (um) one a junction; departure is
    infinite while a junction is alive.
    """
    ticks = len(positions)
    change = np.zeros(ticks + 1, np.int64)
    for row in range(len(birth)):
        change[first_at_or_after(positions, birth[row])] += 1
        change[first_at_or_after(positions, departure[row])] -= 1
    live = 0
    for tick in range(ticks):
        live += change[tick]
        count[tick] = live
