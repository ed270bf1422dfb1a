"""One block of a run: the step of the fold, which also writes the block's rows.

How a junction gets into a file: `draws` gives its birth, diameter and strength. An engine, `junctions` or `batch`,
plays its life. `area` sums the live junctions at the ticks, for /trace. `linear` or `two_way` computes the motion under
their force, for /slider and /load. The sink takes all rows; if the run is written to a file, it is a
`rubnoise.storage.writer.RunWriter`. In two-way and in free motion, `two_way` and `free_motion` write most rows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import max_area
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.record.sink import Columns, Sink
from rubnoise.simulation.area import sample
from rubnoise.simulation.draws import draw_block
from rubnoise.simulation.kernel import peak_areas
from rubnoise.simulation.linear import LinearMotion
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.ticks import TickRange, tick_ranges

if TYPE_CHECKING:
    from rubnoise.simulation.two_way import TwoWayMotion

Watch = Callable[[float, int, int], None]
"""Called after each tick range: distance reached (um), junctions born, live count. It may raise to stop the run."""

Visit = Callable[[TickRange, LiveRows], None]
"""Samples a tick range, moves the slider through it, and writes its rows, from all junctions alive in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """What an engine plays: the junctions that are born in a block, up to its ``end`` (um), and its tick ranges."""

    state: State
    born: LiveRows
    end: float
    tick_ranges: Sequence[TickRange]


Play = Callable[[Block, Visit], LiveRows]
"""An engine: plays a block and visits every tick range; returns all rows, the carried ones first.

Each row has its departure if its life has ended.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSetup:
    """What all blocks of a run share; linear or two_way: what moves through them, if something does."""

    model: Model
    seed: int
    sink: Sink
    play: Play
    watch: Watch | None = None
    linear: LinearMotion | None = None
    two_way: "TwoWayMotion | None" = None


def next_state(run: RunSetup, state: State) -> State:
    """Play one block, write its rows and ticks, and return the state from which to continue."""
    model, cells = run.model, 0 if run.linear is None else run.linear.cells_per_tick
    born, next_birth = draw_block(model, run.seed, state.block, state.next_birth, state.junctions)
    end = min(next_birth, model.distance)
    ranges = list(tick_ranges(model, state.ticks, next_birth, cells or 1))

    def visit(tick_range: TickRange, rows: LiveRows) -> None:
        found = sample(model, rows, tick_range, cells)
        groups = {"trace": found.columns} if run.linear is None else run.linear.through(found)
        _write_ticks(run, tick_range, rows, groups)
        if run.two_way is not None:
            run.two_way.through(rows, tick_range.last_distance)

    rows = run.play(Block(state=state, born=born, end=end, tick_ranges=ranges), visit)
    natural = rows.natural_death
    if run.two_way is None:
        _write_junctions(run, state, rows, natural)
    else:
        run.two_way.through(rows, end)
    ticks = ranges[-1].end if ranges else state.ticks
    return State(
        block=state.block + 1,
        next_birth=next_birth,
        junctions=state.junctions + len(born),
        ticks=ticks,
        live=_carried(rows, natural, (ticks - 1) * model.tick),
    )


def _write_ticks(run: RunSetup, tick_range: TickRange, rows: LiveRows, groups: dict[str, Columns]) -> None:
    for group, columns in groups.items():
        run.sink.write(group, tick_range.first, columns)
    if run.watch is not None:
        born = int(rows.junction[-1]) + 1 if len(rows) else 0
        run.watch(tick_range.last_distance, born, int(groups["trace"]["junction_count"][-1]))


def _write_junctions(run: RunSetup, state: State, rows: LiveRows, natural: Doubles) -> None:
    """Write the new rows, and rewrite those whose junction has been ended early since they were written."""
    carried = len(state.live)
    written = 0 if state.block == 0 else carried
    if len(rows) > written or state.block == 0:
        first = 0 if state.block == 0 else state.junctions
        run.sink.write("junctions", first, junction_columns(run.model, rows.part(written, len(rows))))
    since = np.isinf(state.live.departure) & (rows.departure[:carried] < natural[:carried])
    for row in np.flatnonzero(since[:written]).tolist():
        run.sink.write("junctions", int(rows.junction[row]), junction_columns(run.model, rows.part(row, row + 1)))


def junction_columns(model: Model, rows: LiveRows) -> dict[str, NDArray[Any]]:
    """Return the columns of /junctions for rows in order of birth (um, um^2, MPa, s).

    A row that was ended early has its real death and life; every other row has death = birth + 2d, also beyond the run.
    """
    half, natural, departure = rows.half_life, rows.natural_death, rows.departure
    early = departure < natural
    death, life = natural, 2.0 * half
    if early.any():
        death = np.where(early, departure, natural)
        life = np.where(early, death - rows.birth, life)
    columns: dict[str, NDArray[Any]] = {
        "junction": rows.junction,
        "birth_distance": rows.birth,
        "death_distance": death,
        "life_distance": life,
        "diameter": rows.diameter,
    }
    if rows.offset is None:
        columns["max_area"] = max_area(rows.diameter)
    else:
        columns["lateral_offset"] = rows.offset
        columns["max_area"] = peak_areas(model.pulse.shape, rows.diameter, rows.offset)
    if model.strengths is not None:
        columns["shear_strength"] = rows.strength
    if model.sliding_speed is not None:
        columns["birth_time"] = rows.birth / model.sliding_speed
        columns["death_time"] = death / model.sliding_speed
    bits = (
        # Only junctions alive at the start have a birth with a minus sign, even if it is -0.0.
        (JunctionState.ALIVE_AT_START, np.signbit(rows.birth)),
        (JunctionState.ALIVE_AT_END, np.minimum(departure, natural) > model.distance),
        (JunctionState.ENDED_EARLY, early),
    )
    columns["state"] = np.zeros(len(rows), dtype=np.uint8)
    for bit, of_whom in bits:
        columns["state"] |= of_whom.view(np.uint8) * np.uint8(bit)
    return columns


def _carried(rows: LiveRows, natural: Doubles, last_tick: float) -> LiveRows:
    """Return the rows that live beyond the last finished tick; a departure at the natural death becomes infinite."""
    beyond = np.flatnonzero(np.minimum(rows.departure, natural) > last_tick)
    kept = rows.at(beyond)
    return replace(kept, departure=np.where(kept.departure < natural[beyond], kept.departure, np.inf))
