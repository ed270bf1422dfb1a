"""One block of a run: the step of the fold, which also writes the block's rows.

How a junction gets into a file: `draws` gives its birth, diameter and strength. An engine, `junctions` or `batch`,
plays its life. `area` sums the live junctions at the ticks, for /trace. `slider`, `load` or `two_way` computes the
motion under their force, for /slider and /load. The sink takes all rows; if the run is written to a file, it is a
`rubnoise.storage.writer.RunWriter`. In two-way and in free motion, `two_way` and `free_motion` write most rows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.record.rows import junction_columns, junction_states
from rubnoise.record.sink import Appender, Sink
from rubnoise.simulation.area import Sample, sample
from rubnoise.simulation.draws import BlockBirths, blocks_drawn_at_once, draw_blocks
from rubnoise.simulation.kernel import peak_areas
from rubnoise.simulation.load import MovingSeparation
from rubnoise.simulation.observer import Notifier
from rubnoise.simulation.slider import Propagator, SliderMotion
from rubnoise.simulation.state import MOVING, LiveRows, State
from rubnoise.simulation.ticks import TickRange, tick_ranges

if TYPE_CHECKING:
    from rubnoise.simulation.two_way import TwoWayMotion

Motion = SliderMotion | MovingSeparation

Watch = Callable[[float, int, int], None]
"""Called after each tick range: distance reached (um), junctions born, live count. It may raise to stop the run."""


class Play(Protocol):
    """An engine: plays one block, tick range by tick range, and chooses the rows from which each range is computed."""

    def __call__(
        self,
        *,
        state: State,
        births_of_block: BlockBirths,
        born: LiveRows,
        tick_ranges: Sequence[TickRange],
        run_end: float,
        sample: Callable[[TickRange, LiveRows], Sample],
        move: Callable[[TickRange, LiveRows, Sample], None] | None,
    ) -> LiveRows:
        """Sample every tick range, then move the slider through it; return all rows.

        The carried rows come first, then the newborn ones; each has its departure if its life has ended.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSetup:
    """What stays the same in all blocks of a run."""

    model: Model
    seed: int
    constants: Propagator | None
    sink: Sink
    play: Play
    watch: Watch | None = None
    notifier: Notifier | None = None


def next_state(run: RunSetup, state: State) -> State:
    """Play one block, or several at once, write their rows and ticks, and return the state from which to continue."""
    blocks = blocks_drawn_at_once(run.model, state.block)
    births = draw_blocks(run.model, run.seed, state.block, state.next_birth, blocks)
    born = _born(births, state.junctions)
    cells = 1 if run.constants is None else run.constants.cells_per_tick
    ranges = list(tick_ranges(run.model, state, births, cells))
    motion = _motion(run, state)
    two_way = _two_way(run, state) if run.model.is_two_way else None
    slider = Appender(run.sink, "slider", state.slider_rows)
    rows = run.play(
        state=state,
        births_of_block=births,
        born=born,
        tick_ranges=ranges,
        run_end=run.model.distance,
        sample=lambda tick_range, rows: _write_trace(run, motion, tick_range, rows),
        move=_moving(motion, two_way, slider),
    )
    natural = rows.natural_death
    if two_way is None:
        _write_junctions(run, state, rows, natural)
    else:
        two_way.through(rows, min(births.next_birth, run.model.distance))
    ticks = ranges[-1].end if ranges else state.ticks
    return State(
        block=state.block + births.blocks,
        begin=births.next_birth,
        next_birth=births.next_birth,
        junctions=state.junctions + len(births),
        ticks=ticks,
        live=_carried(rows, natural, (ticks - 1) * run.model.tick),
        slider_rows=slider.rows if two_way is None else two_way.slider_rows,
        **{name: getattr(state if motion is None else motion, name) for name in MOVING},
        motion=None if two_way is None else two_way.state,
    )


def _born(births: BlockBirths, first: int) -> LiveRows:
    return LiveRows(
        junction=np.arange(first, first + len(births), dtype=np.int64),
        birth=births.birth,
        diameter=births.diameter,
        strength=births.strength,
        departure=np.full(len(births), np.inf),
        offset=births.offset,
    )


def _motion(run: RunSetup, state: State) -> Motion | None:
    if run.constants is None:
        return None
    moving = {name: getattr(state, name) for name in MOVING}
    if run.model.separation is not None:
        return MovingSeparation(run.model, run.model.separation, run.constants, **moving)
    return SliderMotion(run.model, run.constants, **moving)


def _two_way(run: RunSetup, state: State) -> "TwoWayMotion":
    from rubnoise.simulation.two_way import TwoWayMotion  # takes long to load, and few runs need it

    return TwoWayMotion(run.model, run.seed, run.sink, state, run.notifier)


def _moving(
    motion: Motion | None, two_way: "TwoWayMotion | None", slider: Appender
) -> Callable[[TickRange, LiveRows, Sample], None] | None:
    """Return the function that computes the motion through a tick range and writes it; None if nothing moves."""
    if two_way is not None:
        return lambda tick_range, rows, _: two_way.through(rows, tick_range.last_distance)
    if motion is None:
        return None
    if isinstance(motion, MovingSeparation):
        return partial(_write_load, slider)
    return lambda _range, _rows, found: slider.append(motion.through(found))


def _write_trace(run: RunSetup, motion: Motion | None, tick_range: TickRange, rows: LiveRows) -> Sample:
    found = sample(run.model, rows, tick_range, 0 if run.constants is None else run.constants.cells_per_tick)
    if isinstance(motion, MovingSeparation):
        found = motion.through(found)  # /trace has the force after the load has changed it
    run.sink.write("trace", tick_range.first, found.columns)
    if run.watch is not None:
        born = int(rows.junction[-1]) + 1 if len(rows) else 0
        run.watch(tick_range.last_distance, born, int(found.columns["junction_count"][-1]))
    return found


def _write_load(slider: Appender, tick_range: TickRange, rows: LiveRows, found: Sample) -> None:
    del rows
    slider.sink.write("load", tick_range.first, found.moved["load"])
    if "slider" in found.moved:
        slider.append(found.moved["slider"])


def _write_junctions(run: RunSetup, state: State, rows: LiveRows, natural: Doubles) -> None:
    """Write the new rows, and rewrite those whose junction has been ended early since they were written."""
    carried = len(state.live)
    written = 0 if state.block == 0 else carried
    if len(rows) > written or state.block == 0:
        first = 0 if state.block == 0 else state.junctions
        _write_rows(run, first, rows.part(written, len(rows)), natural[written:])
    since = np.isinf(state.live.departure) & (rows.departure[:carried] < natural[:carried])
    for row in np.flatnonzero(since[:written]).tolist():
        _write_rows(run, int(rows.junction[row]), rows.part(row, row + 1), natural[row : row + 1])


def _write_rows(run: RunSetup, first: int, rows: LiveRows, natural: Doubles) -> None:
    # Only junctions alive at the start have a birth with a minus sign, even if it is -0.0.
    at_start = np.signbit(rows.birth)
    columns = junction_columns(
        first_row=first,
        birth=rows.birth,
        diameter=rows.diameter,
        strength=None if run.model.strengths is None else rows.strength,
        natural=natural,
        departure=rows.departure,
        state=junction_states(natural, rows.departure, at_start, run.model.distance),
        speed=run.model.sliding_speed,
        offset=rows.offset,
        peak=None if rows.offset is None else peak_areas(run.model.pulse.shape, rows.diameter, rows.offset),
    )
    run.sink.write("junctions", first, columns)


def _carried(rows: LiveRows, natural: Doubles, last_tick: float) -> LiveRows:
    """Return the rows that live beyond the last finished tick; a departure at the natural death becomes infinite."""
    beyond = np.flatnonzero(np.minimum(rows.departure, natural) > last_tick)
    kept = rows.at(beyond)
    return replace(kept, departure=np.where(kept.departure < natural[beyond], kept.departure, np.inf))
