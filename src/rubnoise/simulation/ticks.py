"""Ranges of output ticks, which are computed and written at one go."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

from rubnoise.model import Model
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.state import State

LARGEST_TICK_RANGE = 294_912
"""Positions in a range at most, so that a thin contact, whose blocks are long, needs no more memory than others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TickRange:
    """Ticks ``first`` ... ``end`` - 1, ``tick`` um apart."""

    first: int
    end: int
    tick: float

    @property
    def last_distance(self) -> float:
        """The distance of the last tick in um."""
        return float(self.end - 1) * self.tick

    @property
    def wake(self) -> float:
        """Where the range is sampled among events (um): half a tick late, so that all at its last tick has happened."""
        return self.last_distance + 0.5 * self.tick


def tick_ranges(model: Model, state: State, births: BlockBirths, cells_per_tick: int) -> Iterator[TickRange]:
    """Yield the tick ranges of blocks, up to the next block's first birth or the end of the run."""
    end = first_tick_at_or_after(model, births.next_birth)
    size = max(LARGEST_TICK_RANGE // cells_per_tick, 1)
    for first in range(state.ticks, end, size):
        yield TickRange(first=first, end=min(first + size, end), tick=model.tick)


def first_tick_at_or_after(model: Model, distance: float) -> int:
    """Return the first tick that does not lie before a distance in um: one beyond the last where the run is over."""
    if distance > model.distance:
        return model.tick_count + 1
    tick = max(ceil(distance / model.tick) - 1, 0)
    while float(tick) * model.tick < distance:
        tick += 1
    return min(tick, model.tick_count + 1)
