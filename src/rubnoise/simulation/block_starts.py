"""Where the blocks that are played at once begin, and how the slider moves there: the rows of /blocks."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.record.rows import Phase
from rubnoise.record.sink import Columns
from rubnoise.simulation.draws import BlockBirths, births_per_block
from rubnoise.simulation.state import State
from rubnoise.simulation.ticks import first_tick_at_or_after

TWO_WAY: Final = ("time", "distance", "phase", "displacement", "velocity")
"""Columns with the motion of a two-way slider just before a block."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockStarts:
    """The starts of one or more blocks from a state on, with one entry per block in every array.

    Together with the junctions' rows they are enough to compute the blocks again. displacement (um) and velocity (um/s)
    are those at the last tick before a block; they are filled in while the slider moves. For a two-way slider,
    displacement, velocity, time (s), distance (um) and phase are those of the last row of /slider before the slider
    first reaches the block. separation (um) and its velocity (um/s) are those of /load at the last tick before a block.
    """

    block: NDArray[np.int64]
    birth_distance: Doubles
    first_junction: NDArray[np.int64]
    first_tick: NDArray[np.int64]
    time: Doubles
    distance: Doubles
    phase: NDArray[np.uint8]
    displacement: Doubles
    velocity: Doubles
    separation: Doubles
    separation_velocity: Doubles

    @classmethod
    def of(cls, model: Model, state: State, births: BlockBirths) -> Self:
        """Return the starts of these blocks, for now with the motion of ``state`` in each."""
        number = np.arange(births.blocks)
        later = [first_tick_at_or_after(model, float(distance)) for distance in births.first[1:]]
        return cls(
            block=state.block + number,
            birth_distance=births.first,
            first_junction=state.junctions + births_per_block(model) * number,
            first_tick=np.array([state.ticks, *later], dtype=np.int64),
            time=np.zeros(births.blocks),
            distance=np.zeros(births.blocks),
            phase=np.full(births.blocks, Phase.SLIP, dtype=np.uint8),
            displacement=np.full(births.blocks, state.displacement),
            velocity=np.full(births.blocks, state.velocity),
            separation=np.full(births.blocks, state.separation),
            separation_velocity=np.full(births.blocks, state.separation_velocity),
        )

    def pass_ticks(self, distance: Doubles, **motion: Doubles) -> None:
        """Record the motion at the last of some ticks before each block except the first; distance (um): the ticks."""
        before = np.searchsorted(distance, self.birth_distance)
        passed = np.flatnonzero(before[1:]) + 1
        for name, values in motion.items():
            getattr(self, name)[passed] = values[before[passed] - 1]

    def pass_births(self, junction: NDArray[np.int64], time: Doubles, slider: Columns, last: Sequence[float]) -> None:
        """Record the last row of a two-way slider before it first passes the birth that opens a block.

        junction, time (s): births, and when the slider first passed them; slider: all rows of /slider since ``last``;
        last: the columns TWO_WAY of the row before them. Block 0 is left out, because it begins at the start of the
        run.
        """
        for block in np.flatnonzero(np.isin(self.first_junction, junction) & (self.block > 0)).tolist():
            passed = time[np.searchsorted(junction, self.first_junction[block])]
            row = int(np.searchsorted(slider["time"], passed, side="right")) - 1
            for name, before in zip(TWO_WAY, last, strict=True):
                getattr(self, name)[block] = slider[name][row] if row >= 0 else before

    def columns(self, model: Model) -> dict[str, NDArray[Any]]:
        """Return the columns of /blocks."""
        names = ["block", "birth_distance", "first_junction", "first_tick"]
        names += TWO_WAY if model.is_two_way else ["displacement", "velocity"] * (model.slider is not None)
        names += ["separation", "separation_velocity"] * (model.separation is not None)
        return {name: getattr(self, name) for name in names}
