"""Evenly spaced positions, where a place lies among them, and how many junctions live at each; partly compiled.

Whole blocks of positions lie around those wanted, because kernels process many positions together.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_bare, inlined

BLOCK = 64
"""Positions in a block, eight Taylor panels: grids begin and end at multiples of it."""


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
    """Return the number of positions per um, approximately if they are rounded; 0 if there are fewer than two."""
    count = len(positions)
    return (count - 1) / (positions[count - 1] - positions[0]) if count > 1 else 0.0


@inlined
def first_near(positions: Doubles, per_um: float, distance: float) -> int:
    """Return the same as `first_at_or_after`, searched from a guess; a wrong guess only costs time."""
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

    positions (um, increasing) and count have one entry per tick, birth and departure (um) one per junction; departure
    is infinite while a junction is alive.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """Positions i * spacing (um) from i = ``origin`` on; those at the indices ``wanted`` are to be computed."""

    origin: int
    spacing: float
    wanted: slice
    position: Doubles

    @classmethod
    def around(cls, first: int, end: int, spacing: float) -> Self:
        """Return a grid for the positions i * spacing with i from ``first`` to ``end`` - 1."""
        origin = first // BLOCK * BLOCK - BLOCK
        beyond = (end // BLOCK + 2) * BLOCK
        position = np.empty(beyond - origin)
        place_ticks(origin, spacing, position)
        return cls(
            origin=origin,
            spacing=spacing,
            wanted=slice(first - origin, end - origin),
            position=position,
        )

    def cells(self) -> slice:
        """Return the indices of the wanted positions and the one before: the edges of the cells that end there."""
        return slice(self.wanted.start - 1, self.wanted.stop)
