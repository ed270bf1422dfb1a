"""A block without processes: the same rows, tick ranges and kernels, but no event queue.

Births and diameters already say which junctions live where; `Ended` says where an intervention ended lives early. The
columns are the same as with processes, bit for bit, because those are also computed from rows and never from the clock.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.simulation.block import Block, Visit
from rubnoise.simulation.state import LiveRows

Ended = Callable[[Integers], Doubles]
"""Returns where each junction was ended early (um), given the junctions' numbers; infinite if it was not."""


def play_at_once(block: Block, visit: Visit, ended: Ended | None = None) -> LiveRows:
    """Visit the tick ranges of a block; return its rows, carried ones first.

    ``ended``: says where an intervention ended lives, if the run had one and is replayed.
    """
    rows = block.state.live.then(block.born)
    natural = rows.natural_death
    departure = rows.departure if ended is None else np.minimum(rows.departure, ended(rows.junction))
    rows = replace(rows, departure=np.minimum(departure, natural))
    for tick_range in block.tick_ranges:
        known = rows
        if ended is not None:
            # For lives that were ended early, kernels use another method. So the end is hidden until the tick range
            # in which the processes would have it.
            wake = block.end if tick_range is block.tick_ranges[-1] else tick_range.wake
            known = replace(rows, departure=np.where(rows.departure > wake, natural, rows.departure))
        # Many of the block's births may lie behind the last tick of the range; leaving them out saves time.
        count = int(np.searchsorted(rows.birth, tick_range.last_distance, side="right"))
        visit(tick_range, known.part(0, count))
    return rows
