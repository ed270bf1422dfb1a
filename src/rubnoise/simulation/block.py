"""One block of a run: the step of the fold, and the only place from which rows are written."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from rubnoise.model import Model
from rubnoise.record.rows import junction_columns, junction_states, natural_death
from rubnoise.record.sink import Columns, Sink
from rubnoise.simulation.area import sample
from rubnoise.simulation.draws import BlockBirths, draw_block
from rubnoise.simulation.panels import Panel, panels
from rubnoise.simulation.propagator import Propagator
from rubnoise.simulation.slider import SliderMotion
from rubnoise.simulation.state import LiveRows, State

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
        sample: Callable[[Panel, LiveRows], Columns],
        move: Callable[[Panel, LiveRows, Columns], None] | None,
    ) -> tuple[LiveRows, int]:
        """Sample every panel, then move the slider through it; return all rows and how many events it took.

        The rows are the carried ones and then those born, each with its departure where its life has ended.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What stays the same through all blocks of a run."""

    model: Model
    seed: int
    constants: Propagator | None
    sink: Sink
    play: Play
    watch: Watch | None = None


def next_state(run: Run, state: State) -> State:
    """Play one block, write its rows and ticks, and return the state from which the next block goes on."""
    births = draw_block(run.model, run.seed, state.block, state.next_birth)
    born = _born(births, state.junctions)
    cells = 1 if run.constants is None else run.constants.cells_per_tick
    block_panels = list(panels(run.model, state, births, cells))
    motion = _motion(run, state)
    _write_block(run, state)
    rows, events = run.play(
        state=state,
        births_of_block=births,
        born=born,
        panels=block_panels,
        run_end=run.model.distance,
        sample=lambda panel, rows: _write_trace(run, panel, rows),
        move=None if motion is None else lambda panel, rows, trace: _write_slider(run, motion, panel, rows, trace),
    )
    _write_junctions(run, state, rows)
    ticks = block_panels[-1].end if block_panels else state.ticks
    return State(
        block=state.block + 1,
        begin=births.next_birth,
        next_birth=births.next_birth,
        junctions=state.junctions + len(births),
        ticks=ticks,
        events=state.events + events,
        live=_carried(rows, (ticks - 1) * run.model.tick),
        displacement=state.displacement if motion is None else motion.displacement,
        velocity=state.velocity if motion is None else motion.velocity,
    )


def _born(births: BlockBirths, first: int) -> LiveRows:
    return LiveRows(
        junction=np.arange(first, first + len(births), dtype=np.int64),
        birth=births.birth,
        diameter=births.diameter,
        strength=births.strength,
        departure=np.full(len(births), np.inf),
    )


def _motion(run: Run, state: State) -> SliderMotion | None:
    model = run.model
    if run.constants is None or model.sliding_speed is None:
        return None
    return SliderMotion(model.pulse, run.constants, model.sliding_speed, state.displacement, state.velocity)


def _write_block(run: Run, state: State) -> None:
    """Write down where a block begins: with the junctions' rows that is the state to compute it from again."""
    columns = {
        "block": np.array([state.block], dtype=np.int64),
        "birth_distance": np.array([state.next_birth]),
        "first_junction": np.array([state.junctions], dtype=np.int64),
        "first_tick": np.array([state.ticks], dtype=np.int64),
    }
    if run.constants is not None:
        columns |= {"displacement": np.array([state.displacement]), "velocity": np.array([state.velocity])}
    run.sink.write("blocks", state.block, columns)


def _write_trace(run: Run, panel: Panel, rows: LiveRows) -> Columns:
    columns = sample(run.model, rows, panel)
    run.sink.write("trace", panel.first, columns)
    if run.watch is not None:
        run.watch(
            panel.last_distance, int(rows.junction[-1]) + 1 if len(rows) else 0, int(columns["junction_count"][-1])
        )
    return columns


def _write_slider(run: Run, motion: SliderMotion, panel: Panel, rows: LiveRows, trace: Columns) -> None:
    run.sink.write("slider", panel.first, motion.through(panel, rows, trace))


def _write_junctions(run: Run, state: State, rows: LiveRows) -> None:
    """Write the rows that are new, and one by one those written before whose junction has been ended early since."""
    carried = len(state.live)
    new = np.arange(len(rows)) >= (0 if state.block == 0 else carried)
    ended = rows.departure < natural_death(rows.birth, rows.diameter)
    ended[:carried] &= np.isinf(state.live.departure)
    if new.any() or state.block == 0:
        _write_rows(run, 0 if state.block == 0 else state.junctions, rows.where(new))
    for row in np.flatnonzero(ended & ~new):
        _write_rows(run, int(rows.junction[row]), rows.where(np.arange(len(rows)) == row))


def _write_rows(run: Run, first: int, rows: LiveRows) -> None:
    # Only who was alive at the start has a birth with a minus sign, which -0.0 has too.
    at_start = np.signbit(rows.birth)
    state = junction_states(rows.birth, rows.diameter, rows.departure, at_start, run.model.distance)
    columns = junction_columns(
        first_row=first,
        birth=rows.birth,
        diameter=rows.diameter,
        strength=None if run.model.strengths is None else rows.strength,
        departure=rows.departure,
        state=state,
        speed=run.model.sliding_speed,
    )
    run.sink.write("junctions", first, columns)


def _carried(rows: LiveRows, last_tick: float) -> LiveRows:
    """Return the rows that still matter beyond the last finished tick; a natural departure is forgotten again."""
    early = rows.departure < natural_death(rows.birth, rows.diameter)
    kept = replace(rows, departure=np.where(early, rows.departure, np.inf))
    return kept.where(kept.death > last_tick)
