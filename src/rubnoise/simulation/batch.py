"""A block without processes: the same rows, tick ranges and kernels, and no queue of events.

Who lives where is plain from births and diameters as long as no life is ended early. The columns come out bit for bit
as they do with processes, since those, too, are computed from rows and never from the clock.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rubnoise.simulation.area import Sample
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.ticks import TickRange


def play_at_once(
    *,
    state: State,
    births_of_block: BlockBirths,
    born: LiveRows,
    tick_ranges: Sequence[TickRange],
    run_end: float,
    sample: Callable[[TickRange, LiveRows], Sample],
    move: Callable[[TickRange, LiveRows, Sample], None] | None,
) -> tuple[LiveRows, int]:
    """Fill the tick ranges of one block; return its rows, carried ones first, and that it took no events."""
    del births_of_block, run_end
    rows = state.live.then(born)
    rows = replace(rows, departure=np.minimum(rows.departure, rows.natural_death))
    for tick_range in tick_ranges:
        # The ticks of a range may end before many of the block's births: those would only be looked at.
        seen = rows.part(0, int(np.searchsorted(rows.birth, tick_range.last_distance, side="right")))
        found = sample(tick_range, seen)
        if move is not None:
            move(tick_range, seen, found)
    return rows, 0
