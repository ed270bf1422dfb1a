"""What a run will take: its rows, counted without running it, and its memory, from a few measured constants."""

from collections.abc import Mapping
from typing import Final, Literal

from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.simulation.draws import births_per_block, count_births, start
from rubnoise.simulation.ticks import LARGEST_TICK_RANGE, cells_per_tick

Engine = Literal["events", "batch"]
"""How a block is played: as processes with their events, or all at once. Both give the same rows, bit for bit."""


def extent(model: Model, seed: int) -> Extent:
    """Return how many rows a run will have: its births are counted from the gaps alone, without any event."""
    ticks, free = model.tick_count + 1, model.free is not None
    return Extent(
        junctions=None if free else start(model, seed).junctions + count_births(model, seed),
        ticks=ticks,
        slider=model.slider_rows,
        landmarks=None if free or model.is_two_way else 0,
        load=0 if model.held is None else ticks,
    )


PROGRAM_BYTES: Final = 225_000_000
"""Memory of a process before the run, with everything loaded that a run needs."""

DRAWN_BYTES: Final = 50
ROW_BYTES: Final[Mapping[Engine, int]] = {"events": 320, "batch": 200}
ALIVE_BYTES: Final[Mapping[Engine, int]] = {"events": 1000, "batch": 0}
POSITION_BYTES: Final = 140
"""Memory for each birth drawn in a block, each row of the block that is played, each junction alive at the same time,
and each position of a tick range."""


def working_bytes(model: Model, engine: Engine) -> int:
    """Return the memory that a run needs besides its program: one block and one tick range, however long the run is."""
    drawn, alive = births_per_block(model), model.mean_live_junctions
    played = min(drawn, model.birth_rate * model.distance) + alive
    positions = min(LARGEST_TICK_RANGE, (model.tick_count + 1) * cells_per_tick(model))
    junctions = DRAWN_BYTES * drawn + ROW_BYTES[engine] * played + ALIVE_BYTES[engine] * alive
    return round(junctions + POSITION_BYTES * positions)
