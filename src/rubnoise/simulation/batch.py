"""A block without processes: the same rows, tick ranges and kernels, and no queue of events.

Who lives where is plain from births and diameters, and where lives were ended early from the places where they were.
The columns come out bit for bit as they do with processes, since those, too, are computed from rows and never from the
clock.
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
"""Returns, of junctions by their numbers, where each was ended early (um); infinite if nothing ended it."""


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
) -> tuple[LiveRows, int]:
    """Fill the tick ranges of one block; return its rows, carried ones first, and that it took no events.

    ``ended``: where an intervention ended lives, when a run is played again that had one.
    """
    rows = state.live.then(born)
    natural = rows.natural_death
    departure = rows.departure if ended is None else np.minimum(rows.departure, ended(rows.junction))
    rows = replace(rows, departure=np.minimum(departure, natural))
    for tick_range in tick_ranges:
        known = rows
        if ended is not None:
            # A kernel sums a life that is cut short in another way: it is told where the processes know it.
            last = tick_range is tick_ranges[-1]
            wake = min(births_of_block.next_birth, run_end) if last else tick_range.wake
            known = replace(rows, departure=np.where(rows.departure > wake, natural, rows.departure))
        # The ticks of a range may end before many of the block's births: those would only be looked at.
        seen = known.part(0, int(np.searchsorted(rows.birth, tick_range.last_distance, side="right")))
        found = sample(tick_range, seen)
        if move is not None:
            move(tick_range, seen, found)
    return rows, 0
