"""Where a place lies among the ticks, and how many junctions live at each: the same for every pulse; compiled."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_bare, inlined


@compiled_bare
def place_ticks(first: int, spacing: float, positions: Doubles) -> None:
    """Fill in the positions i * spacing (um) from i = ``first`` on."""
    for n in range(len(positions)):
        positions[n] = float(first + n) * spacing


@compiled_bare
def first_at_or_after(positions: Doubles, distance: float) -> int:
    """Return the first index whose position is not before a distance, or the number of positions."""
    return first_near(positions, per_um_of(positions), distance)


@inlined
def per_um_of(positions: Doubles) -> float:
    """Return how many positions there are to a um: roughly, where they are rounded or hardly any."""
    count = len(positions)
    return (count - 1) / (positions[count - 1] - positions[0]) if count > 1 else 0.0


@inlined
def first_near(positions: Doubles, per_um: float, distance: float) -> int:
    """Return what `first_at_or_after` does from a guess at it, which costs nothing but time where it is wrong."""
    count = len(positions)
    if count == 0 or positions[count - 1] < distance:
        return count
    if positions[0] >= distance:
        return 0
    index = min(max(int((distance - positions[0]) * per_um), 0), count - 1)
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
    change = np.zeros(ticks + 1, np.int32)
    per_um = per_um_of(positions)
    for row in range(len(birth)):
        change[first_near(positions, per_um, birth[row])] += 1
        change[first_near(positions, per_um, departure[row])] -= 1
    live = 0
    for tick in range(ticks):
        live += change[tick]
        count[tick] = live
