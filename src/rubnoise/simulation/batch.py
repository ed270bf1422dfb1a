"""A block without processes: the same rows, tick ranges and kernels, but no event queue.

Births and diameters already say which junctions live where; `Ended` says where an intervention ended lives early. The
columns are the same as with processes, bit for bit, because those are also computed from rows and never from the clock.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.simulation.area import Sample
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.ticks import TickRange

Ended = Callable[[Integers], Doubles]
"""Returns where each junction was ended early (um), given the junctions' numbers; infinite if it was not."""


def play_at_once(
    *,
    state: State,
    births_of_block: BlockBirths,
    born: LiveRows,
    tick_ranges: Sequence[TickRange],
    run_end: float,
    sample: Callable[[TickRange, LiveRows], Sample],
    move: Callable[[TickRange, LiveRows, Sample], None] | None,
    ended: Ended | None = None,
) -> LiveRows:
    """Fill the tick ranges of one block; return its rows, carried ones first.

    ``ended``: says where an intervention ended lives, if the run had one and is replayed.
    """
    rows = state.live.then(born)
    natural = rows.natural_death
    departure = rows.departure if ended is None else np.minimum(rows.departure, ended(rows.junction))
    rows = replace(rows, departure=np.minimum(departure, natural))
    for tick_range in tick_ranges:
        known = rows
        if ended is not None:
            # For lives that were ended early, kernels use another method. So the end is hidden until the tick range
            # in which the processes would have it.
            last = tick_range is tick_ranges[-1]
            wake = min(births_of_block.next_birth, run_end) if last else tick_range.wake
            known = replace(rows, departure=np.where(rows.departure > wake, natural, rows.departure))
        # Many of the block's births may lie behind the last tick of the range; leaving them out saves time.
        seen = known.part(0, int(np.searchsorted(rows.birth, tick_range.last_distance, side="right")))
        found = sample(tick_range, seen)
        if move is not None:
            move(tick_range, seen, found)
    return rows
