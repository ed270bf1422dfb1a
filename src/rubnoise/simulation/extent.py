"""How many rows a run will have, counted without running it."""

from typing import Literal

from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.simulation.draws import count_births, start

Engine = Literal["events", "batch"]
"""How a block is played: as processes with their events, or all at once. Both give the same rows, bit for bit."""


def extent(model: Model, seed: int) -> Extent:
    """Return how many rows a run will have: its births are counted from the gaps alone, without any event."""
    ticks = model.tick_count + 1
    if model.free is not None:
        return Extent(
            junctions=None,
            ticks=ticks,
            slider=model.slider_rows,
            landmarks=None,
            load=ticks,
        )
    return Extent(
        junctions=start(model, seed).junctions + count_births(model, seed),
        ticks=ticks,
        slider=model.slider_rows,
        landmarks=None if model.is_two_way else 0,
        load=0 if model.separation is None else ticks,
    )
