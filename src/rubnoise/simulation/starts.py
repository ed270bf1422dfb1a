"""Where the blocks that are played together begin, and what the slider does there: the rows of /blocks."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.simulation.draws import BlockBirths, births_per_block
from rubnoise.simulation.panels import first_tick_at_or_after
from rubnoise.simulation.state import State

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockStarts:
    """The blocks that begin where a state is and after it: one entry a block in every array.

    With the junctions' rows these are the states to compute the blocks from again. displacement (um) and velocity
    (um/s) are those at the last tick before a block, and become known while the slider moves.
    """

    block: NDArray[np.int64]
    birth_distance: Doubles
    first_junction: NDArray[np.int64]
    first_tick: NDArray[np.int64]
    displacement: Doubles
    velocity: Doubles

    @classmethod
    def of(cls, model: Model, state: State, births: BlockBirths) -> Self:
        """Return the starts of blocks whose slider does not move."""
        number = np.arange(births.blocks)
        later = [first_tick_at_or_after(model, float(distance)) for distance in births.first[1:]]
        return cls(
            block=state.block + number,
            birth_distance=births.first,
            first_junction=state.junctions + births_per_block(model) * number,
            first_tick=np.array([state.ticks, *later], dtype=np.int64),
            displacement=np.full(births.blocks, state.displacement),
            velocity=np.full(births.blocks, state.velocity),
        )

    def pass_slider(self, slider: Columns) -> None:
        """Take note of how the slider moves in the last of some rows that lie before a block, but for the first one."""
        before = np.searchsorted(slider["distance"], self.birth_distance)
        passed = np.flatnonzero(before[1:]) + 1
        self.displacement[passed] = slider["displacement"][before[passed] - 1]
        self.velocity[passed] = slider["velocity"][before[passed] - 1]

    def columns(self, *, moving: bool) -> dict[str, NDArray[Any]]:
        """Return the columns of /blocks."""
        names = ["block", "birth_distance", "first_junction", "first_tick"]
        return {name: getattr(self, name) for name in names + ["displacement", "velocity"] * moving}
