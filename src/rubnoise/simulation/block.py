"""One block of a run: the step of the fold, and the only place from which rows are written."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.record.rows import junction_columns, junction_states, natural_death
from rubnoise.record.sink import Appender, Sink
from rubnoise.simulation.area import Sample, sample
from rubnoise.simulation.draws import BlockBirths, blocks_together, draw_blocks
from rubnoise.simulation.kernels import Room
from rubnoise.simulation.observer import Telling
from rubnoise.simulation.panels import LARGEST_PANEL, Panel, panels
from rubnoise.simulation.propagator import Propagator
from rubnoise.simulation.slider import SliderMotion
from rubnoise.simulation.starts import BlockStarts
from rubnoise.simulation.state import LiveRows, State

if TYPE_CHECKING:
    from rubnoise.simulation.two_way import TwoWayMotion

ROOM: Final = 12 * LARGEST_PANEL
"""Numbers of room that are asked for, most of which are never touched. Usual systems take back what lies free at the
end of the heap where it is more than twice the largest piece ever freed: after a run, all arrays of a panel, which the
next one would have to be given anew."""

Watch = Callable[[float, int, int], None]
"""Told after each panel: distance reached (um), junctions born so far, live count. It may raise to stop the run."""


class Play(Protocol):
    """An engine: lets one block happen, panel by panel, and so decides which rows each panel is computed from."""

    def __call__(
        self,
        *,
        state: State,
        births_of_block: BlockBirths,
        born: LiveRows,
        panels: Sequence[Panel],
        run_end: float,
        sample: Callable[[Panel, LiveRows], Sample],
        move: Callable[[Panel, LiveRows, Sample], None] | None,
    ) -> tuple[LiveRows, int]:
        """Sample every panel, then move the slider through it; return all rows and how many events it took.

        The rows are the carried ones and then those born, each with its departure where its life has ended.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What stays the same through all blocks of a run; ``together``: whether small blocks are played some at a time."""

    model: Model
    seed: int
    constants: Propagator | None
    sink: Sink
    play: Play
    together: bool
    watch: Watch | None = None
    telling: Telling | None = None
    room: Room = field(default_factory=partial(Room, ROOM))


def next_state(run: Run, state: State) -> State:
    """Play one block, or some together, write their rows and ticks, and return the state from which to go on."""
    together = blocks_together(run.model, state.block) if run.together else 1
    births = draw_blocks(run.model, run.seed, state.block, state.next_birth, together)
    starts = BlockStarts.of(run.model, state, births)
    born = _born(births, state.junctions)
    cells = 1 if run.constants is None else run.constants.cells_per_tick
    block_panels = list(panels(run.model, state, births, cells))
    motion = None if run.constants is None else _motion(run, state, run.constants)
    two_way = _two_way(run, state, starts) if run.model.is_two_way else None
    slider = Appender(run.sink, "slider", state.slider_rows)
    rows, events = run.play(
        state=state,
        births_of_block=births,
        born=born,
        panels=block_panels,
        run_end=run.model.distance,
        sample=lambda panel, rows: _write_trace(run, panel, rows),
        move=_moving(motion, two_way, slider, starts),
    )
    natural = natural_death(rows.birth, rows.diameter)
    if two_way is None:
        _write_junctions(run, state, rows, natural)
    else:
        two_way.through(rows, min(births.next_birth, run.model.distance))
    run.sink.write("blocks", state.block, starts.columns(moving=motion is not None, two_way=two_way is not None))
    ticks = block_panels[-1].end if block_panels else state.ticks
    return State(
        block=state.block + births.blocks,
        begin=births.next_birth,
        next_birth=births.next_birth,
        junctions=state.junctions + len(births),
        ticks=ticks,
        events=state.events + events,
        live=_carried(rows, natural, (ticks - 1) * run.model.tick),
        slider_rows=slider.rows if two_way is None else two_way.slider_rows,
        displacement=state.displacement if motion is None else motion.displacement,
        velocity=state.velocity if motion is None else motion.velocity,
        two_way=b"" if two_way is None else two_way.pack(),
    )


def _born(births: BlockBirths, first: int) -> LiveRows:
    return LiveRows(
        junction=np.arange(first, first + len(births), dtype=np.int64),
        birth=births.birth,
        diameter=births.diameter,
        strength=births.strength,
        departure=np.full(len(births), np.inf),
    )


def _motion(run: Run, state: State, constants: Propagator) -> SliderMotion:
    return SliderMotion(run.model, constants, run.room, state.displacement, state.velocity)


def _two_way(run: Run, state: State, starts: BlockStarts) -> "TwoWayMotion":
    from rubnoise.simulation.two_way import TwoWayMotion  # which few runs need, and which takes long to load

    return TwoWayMotion(run.model, run.seed, run.sink, run.room, state, starts, run.telling)


def _moving(
    motion: SliderMotion | None, two_way: "TwoWayMotion | None", slider: Appender, starts: BlockStarts
) -> Callable[[Panel, LiveRows, Sample], None] | None:
    """Return what moves the slider through a panel; None where there is no slider."""
    if two_way is not None:
        return lambda panel, rows, _: two_way.through(rows, panel.last_distance)
    return None if motion is None else partial(_write_slider, slider, motion, starts)


def _write_trace(run: Run, panel: Panel, rows: LiveRows) -> Sample:
    # The moments of the force come with its sum where the slider needs them over the ticks themselves.
    moving = run.constants is not None and run.constants.cells_per_tick == 1
    found = sample(run.model, rows, panel, run.room if moving else None)
    run.sink.write("trace", panel.first, found.columns)
    if run.watch is not None:
        born = int(rows.junction[-1]) + 1 if len(rows) else 0
        run.watch(panel.last_distance, born, int(found.columns["junction_count"][-1]))
    return found


def _write_slider(
    slider: Appender, motion: SliderMotion, starts: BlockStarts, panel: Panel, rows: LiveRows, found: Sample
) -> None:
    columns = motion.through(panel, rows, found)
    starts.pass_slider(columns)
    slider.append(columns)


def _write_junctions(run: Run, state: State, rows: LiveRows, natural: Doubles) -> None:
    """Write the rows that are new, and one by one those written before whose junction has been ended early since."""
    carried = len(state.live)
    written = 0 if state.block == 0 else carried
    if len(rows) > written or state.block == 0:
        first = 0 if state.block == 0 else state.junctions
        _write_rows(run, first, rows.part(written, len(rows)), natural[written:])
    since = np.isinf(state.live.departure) & (rows.departure[:carried] < natural[:carried])
    for row in np.flatnonzero(since[:written]).tolist():
        _write_rows(run, int(rows.junction[row]), rows.part(row, row + 1), natural[row : row + 1])


def _write_rows(run: Run, first: int, rows: LiveRows, natural: Doubles) -> None:
    # Only who was alive at the start has a birth with a minus sign, which -0.0 has too.
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
    )
    run.sink.write("junctions", first, columns)


def _carried(rows: LiveRows, natural: Doubles, last_tick: float) -> LiveRows:
    """Return the rows that still matter beyond the last finished tick; a natural departure is forgotten again."""
    beyond = np.flatnonzero(np.minimum(rows.departure, natural) > last_tick)
    kept = rows.at(beyond)
    return replace(kept, departure=np.where(kept.departure < natural[beyond], kept.departure, np.inf))
