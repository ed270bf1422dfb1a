"""A block without its story: the same rows, panels and kernels as with processes, and no queue of events.

Who lives where is plain from births and diameters as long as nobody ends a life early. The columns come out bit for bit
as they do with processes, since those, too, are computed from rows and never from the clock.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rubnoise.record.rows import natural_death
from rubnoise.simulation.area import Sample
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.panels import Panel
from rubnoise.simulation.state import LiveRows, State


def play_at_once(
    *,
    state: State,
    births_of_block: BlockBirths,
    born: LiveRows,
    panels: Sequence[Panel],
    run_end: float,
    sample: Callable[[Panel, LiveRows], Sample],
    move: Callable[[Panel, LiveRows, Sample], None] | None,
) -> tuple[LiveRows, int]:
    """Fill the panels of one block; return its rows, carried ones first, and that it took no events."""
    del births_of_block, run_end
    rows = state.live.then(born)
    rows = replace(rows, departure=np.minimum(rows.departure, natural_death(rows.birth, rows.diameter)))
    for panel in panels:
        # A panel's ticks may end before many of the block's births: those would only be looked at.
        seen = rows.part(0, int(np.searchsorted(rows.birth, panel.last_distance, side="right")))
        found = sample(panel, seen)
        if move is not None:
            move(panel, seen, found)
    return rows, 0
