"""The random draws of a run: the births of every block, and of the past before the start; and what they will take."""

from collections.abc import Mapping
from dataclasses import replace
from math import ceil
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import largest_of
from rubnoise.model import Model
from rubnoise.record.rows import Extent, extent_of
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.ticks import LARGEST_TICK_RANGE, cells_per_tick
from rubnoise.streams import Stream, uniforms

BLOCK: Final = 16_384
"""Births of a block: enough to make arrays worth their overhead, few enough for the processor's cache."""

_STREAMS: Final = {
    1: (Stream.DIAMETERS, Stream.STRENGTHS, Stream.OFFSETS),
    -1: (Stream.PAST_DIAMETERS, Stream.PAST_STRENGTHS, Stream.PAST_OFFSETS),
}
"""Streams of a run, and of what was born before its start."""


def births_per_block(model: Model) -> int:
    """Return the births of a block, which is at least ten mean lives long, however dense the contact."""
    return max(BLOCK, ceil(10.0 * model.mean_junction_count))


def draw_block(model: Model, seed: int, block: int, begin: float, first: int) -> tuple[LiveRows, float]:
    """Return those births of a block that lie within the run, numbered from ``first`` on, and the next birth (um).

    That may lie beyond the run.
    """
    birth = model.births.places(seed, block, begin, births_per_block(model), 1)
    count = min(int(np.searchsorted(birth, model.distance, side="right")), birth.size - 1)
    junction = np.arange(first, first + count, dtype=np.int64)
    return _rows(model, seed, 1, block, junction, birth[:count]), float(birth[count])


def count_births(model: Model, seed: int) -> int:
    """Return the number of births within the run, counted from the gaps alone."""
    block, begin, count = 0, model.births.around(seed)[1], 0
    while begin <= model.distance:
        birth = model.births.places(seed, block, begin, births_per_block(model), 1)
        count += int(np.searchsorted(birth[:-1], model.distance, side="right"))
        block, begin = block + 1, float(birth[-1])
    return count


def start(model: Model, seed: int) -> State:
    """Return the state before the first block: the junctions of the past that are alive, none in an empty contact."""
    live = past(model, seed, 0.0)
    live = replace(live, junction=np.arange(len(live), dtype=np.int64))
    return State(next_birth=model.births.around(seed)[1], junctions=len(live), live=live)


def past(model: Model, seed: int, begin: float) -> LiveRows:
    """Return the junctions born before the start that live beyond ``begin`` um, in order of birth.

    The latest has the number -1. A contact that starts empty has none. All births are looked at from the longest
    possible life before ``begin`` on.
    """
    found, block, place = LiveRows.none(), 0, model.births.around(seed)[0]
    count, oldest = births_per_block(model), begin - 2.0 * largest_of(model.sizes)
    while model.start == "stationary" and place >= oldest:
        birth = model.births.places(seed, block, place, count, -1)
        junction = -1 - block * count - np.arange(count, dtype=np.int64)
        rows = _rows(model, seed, -1, block, junction, birth[:-1])
        found = found.then(rows.at(np.flatnonzero(rows.natural_death > begin)))
        block, place = block + 1, float(birth[-1])
    return found.at(np.arange(len(found))[::-1])


def _rows(model: Model, seed: int, way: int, block: int, junction: NDArray[np.int64], birth: Doubles) -> LiveRows:
    """Return the first junctions of a block: the n-th is always made of the n-th numbers of its streams."""
    sizes, strengths, offsets = _STREAMS[way]
    count = birth.size
    diameter, strength, offset = model.sizes.quantile(uniforms(seed, sizes, block, count)), np.ones(count), None
    if model.strengths is not None:
        strength = model.strengths.quantile(uniforms(seed, strengths, block, count))
    if model.pulse.offset != "none":
        offset = np.asarray(diameter * (2.0 * uniforms(seed, offsets, block, count) - 1.0))
    return LiveRows(
        junction=junction,
        birth=birth,
        diameter=diameter,
        strength=strength,
        departure=np.full(count, np.inf),
        offset=offset,
    )


Engine = Literal["events", "batch"]
"""How a block is played: as processes with their events, or all at once. Both give the same rows, bit for bit."""


def extent(model: Model, seed: int) -> Extent:
    """Return how many rows a run will have: its births are counted from the gaps alone, without any event."""
    return extent_of(model, 0 if model.free else start(model, seed).junctions + count_births(model, seed))


PROGRAM_BYTES: Final = 225_000_000  # memory of a process before the run, with everything loaded that a run needs

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
