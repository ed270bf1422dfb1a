"""A run from its first block to its last, as a fold over blocks, each of which writes its rows.

How a junction gets into a file: `draws` gives its birth, diameter and strength. An engine plays its life, `junctions`
with events or `play_at_once` without. `area` sums the live junctions at the ticks, for /trace. `linear` or `two_way`
computes the motion under their force, for /slider and /load. The sink takes all rows; if the run is written to a file,
it is a `rubnoise.storage.writer.RunWriter`. In two-way and in free motion, `two_way` and `free_motion` write most rows.
"""

import gc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.rows import Sink
from rubnoise.simulation.area import sample
from rubnoise.simulation.draws import Engine, draw_block, start
from rubnoise.simulation.junctions import Processes
from rubnoise.simulation.linear import LinearMotion, slider_constants
from rubnoise.simulation.observer import Intervention, Notifier, Observer
from rubnoise.simulation.state import LiveRows, State, Watch, junction_columns
from rubnoise.simulation.ticks import tick_ranges

if TYPE_CHECKING:
    from rubnoise.simulation.two_way import TwoWayMotion

Ended = Callable[[Integers], Doubles]
"""Returns where each junction was ended early (um), given the junctions' numbers; infinite if it was not."""

Play = Callable[[State, LiveRows, float, Sequence[float]], Iterator[LiveRows]]
"""An engine: plays a block from a state on, given its births, its end and the places where it is sampled, all in um. It
yields at each place all junctions alive up to there, and then all rows, carried ones first."""


def simulate(
    model: Model,
    seed: int,
    sink: Sink,
    *,
    engine: Engine = "events",
    intervene: Intervention | None = None,
    observe: Observer | None = None,
    watch: Watch | None = None,
    ended: Ended | None = None,
) -> State:
    """Run a model block by block, write each block's rows to a sink, and return the last state.

    The same model and seed give the same rows, bit for bit, with either engine. ``intervene``: a SimPy process of the
    caller, beside those of the contact; ``observe``: is called at births, mid-lives, deaths and landmarks; ``watch``:
    is called after each tick range; ``ended``: says where an intervention ended lives, so that the batch engine can
    replay the run. Raises Refused as `check_guests` does.
    """
    check_guests(model, engine, observe, intervene)
    if model.free is not None:
        from rubnoise.simulation.free_motion import FreeMotion  # takes long to load, and few runs need it

        state, step = State(), FreeMotion(model, model.free, seed, sink, watch).next_state
    else:
        notifier = None if observe is None else Notifier(observe, model.distance, two_way=model.is_two_way)
        play: Play = partial(play_at_once, ended=ended)
        if engine == "events":
            play = Processes(model, notifier, intervene)
        state = start(model, seed)
        step = ContactRun(model, seed, sink, play, watch, state.live, notifier).next_state
    # Once the C library has given back an array as large as this, it keeps smaller ones for later. Else those of every
    # range of ticks would get their memory from the system anew, which took up to a third of the time.
    np.empty(3_900_000)  # glibc heeds none beyond 32 MB
    # Inside a block, the collector of garbage would check all live processes again and again: a fifth of the time.
    looked = gc.isenabled()
    gc.disable()
    try:
        while state.ticks <= model.tick_count or (model.free is None and state.next_birth <= model.distance):
            state = step(state)
            gc.collect(0)
    finally:
        if looked:
            gc.enable()
    return state


class ContactRun:
    """A contact that is played block by block, what moves through it, and its rows."""

    def __init__(
        self,
        model: Model,
        seed: int,
        sink: Sink,
        play: Play,
        watch: Watch | None,
        live: LiveRows,
        notifier: Notifier | None,
    ) -> None:
        """Begin among the junctions alive at the start."""
        self._model, self._seed, self._sink, self._play, self._watch = model, seed, sink, play, watch
        self._linear: LinearMotion | None = None
        self._two_way: TwoWayMotion | None = None
        if model.is_two_way:
            from rubnoise.simulation import two_way  # takes long to load, and few runs need it

            self._two_way = two_way.TwoWayMotion(model, seed, sink, live, notifier)
        elif (constants := slider_constants(model)) is not None:
            self._linear = LinearMotion(model, constants, live)

    def next_state(self, state: State) -> State:
        """Play one block, write its rows and ticks, and return the state from which to continue."""
        model, cells = self._model, 1 if self._linear is None else self._linear.cells_per_tick
        born, next_birth = draw_block(model, self._seed, state.block, state.next_birth, state.junctions)
        end = min(next_birth, model.distance)
        ranges = list(tick_ranges(model, state.ticks, next_birth, cells))
        # Half a tick late: a birth or death at the last tick of a range has happened, whatever the queue's order.
        wakes = [ticks[-1] * model.tick + 0.5 * model.tick for ticks in ranges]
        wakes[-1:] = [end] if wakes else []
        playing = self._play(state, born, end, wakes)
        for ticks in ranges:
            self._write_ticks(ticks, next(playing))
        rows = next(playing)
        if self._two_way is None:
            self._write_junctions(state, rows)
        else:
            self._two_way.through(rows, end)
        finished = ranges[-1].stop if ranges else state.ticks
        return State(
            block=state.block + 1,
            next_birth=next_birth,
            junctions=state.junctions + len(born),
            ticks=finished,
            live=rows.at(np.flatnonzero(rows.death > (finished - 1) * model.tick)),
        )

    def _write_ticks(self, ticks: range, rows: LiveRows) -> None:
        """Sample a tick range, move what moves through it, and write its rows.

        Births beyond its last tick, of which one engine knows more than the other, are left out.
        """
        last = ticks[-1] * self._model.tick
        rows = rows.at(slice(0, int(np.searchsorted(rows.birth, last, side="right"))))
        if self._linear is None:
            groups = {"trace": sample(self._model, rows, ticks)[0]}
        else:
            groups = self._linear.through(rows, ticks)
        for group, columns in groups.items():
            self._sink.write(group, ticks.start, columns)
        if self._watch is not None:
            born = int(rows.junction[-1]) + 1 if len(rows) else 0
            self._watch(last, born, int(groups["trace"]["junction_count"][-1]))
        if self._two_way is not None:
            self._two_way.through(rows, last)

    def _write_junctions(self, state: State, rows: LiveRows) -> None:
        """Write the new rows, and rewrite those whose junction has been ended early since they were written."""
        carried = 0 if state.block == 0 else len(state.live)
        if len(rows) > carried or state.block == 0:
            first = 0 if state.block == 0 else state.junctions
            self._sink.write("junctions", first, junction_columns(self._model, rows.at(slice(carried, None))))
        since = np.isinf(state.live.departure[:carried]) & (rows.departure < rows.natural_death)[:carried]
        for row in np.flatnonzero(since).tolist():
            found = junction_columns(self._model, rows.at(slice(row, row + 1)))
            self._sink.write("junctions", int(rows.junction[row]), found)


def play_at_once(
    state: State, born: LiveRows, _end: float, wakes: Sequence[float], ended: Ended | None = None
) -> Iterator[LiveRows]:
    """Play a block without events: births and diameters already say which junctions live where.

    The rows are those of the processes, bit for bit, because those are also computed from draws and never from the
    clock. ``ended``: says where an intervention ended lives, if the run had one and is replayed.
    """
    rows = state.live.then(born)
    if ended is not None:
        rows = replace(rows, departure=ended(rows.junction))
    for wake in wakes:
        known = rows
        if ended is not None:
            # For lives that were ended early, kernels use another method. So the end is hidden until the tick range
            # in which the processes would have it.
            known = replace(rows, departure=np.where(rows.departure > wake, np.inf, rows.departure))
        yield known
    yield rows


def check_guests(model: Model, engine: Engine, observe: Observer | None, intervene: Intervention | None) -> None:
    """Raise Refused if an observer or intervention is not of the right kind, or if the run lacks the events it needs.

    Landmarks, which only a two-way slider has, are reported by either engine. An intervention is also refused in a
    two-way run: when it ends a life the force jumps, and the model does not say how a slider at rest moves on then.
    Both are refused in free motion, where the motion itself decides where summits are touched and left.
    """
    if observe is not None and not isinstance(observe, Observer):
        raise Refused(f"observe: {observe!r} is not an Observer; rubnoise.Observer(birth=...) makes one from functions")
    if intervene is not None and not callable(intervene):
        raise Refused(f"intervene: {intervene!r} is not a function of the environment and the live junctions")
    motion = () if observe is None else observe.of_motion
    hears_of_lives = observe is not None and (observe.of_lives or not motion)
    if model.free is not None and (observe is not None or intervene is not None):
        raise Refused(
            f"{'intervene' if observe is None else 'observe'}: in free motion touches are known only after the motion"
            ' of a block; load.motion = "first-order" takes observers and interventions'
        )
    if intervene is not None and model.is_two_way:
        raise Refused(
            "intervene: when a life is ended early the force jumps, and the motion of a two-way slider is not"
            ' defined there; slider.coupling = "one-way" takes interventions'
        )
    if motion and not model.is_two_way:
        raise Refused(
            f"observe: {motion[0]}: only a slider that pushes back sticks, breaks away and turns round;"
            ' slider.coupling = "two-way" makes it one'
        )
    needed = f'it needs the engine "events", not "{engine}"'
    if engine != "events" and intervene is not None:
        raise Refused(f"intervene: an intervention is a process among events: {needed}")
    if engine != "events" and hears_of_lives:
        raise Refused(f"observe: births, mid-lives and deaths are events: {needed}")
