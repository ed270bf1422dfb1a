"""Evenly spaced positions with whole blocks of others around them, for kernels that take many positions together."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.simulation.kernels.taylor import BLOCK
from rubnoise.simulation.kernels.ticks import place_ticks


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """Positions i * spacing (um) from i = ``origin`` on, of which those at the indices ``wanted`` are asked for."""

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
        """Return the indices of the positions wanted and the one before them: the edges of the cells that end there."""
        return slice(self.wanted.start - 1, self.wanted.stop)
