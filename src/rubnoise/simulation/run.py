"""A run from its first block to its last, as a fold over blocks."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

from rubnoise.errors import Refused
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.sink import Sink
from rubnoise.simulation.batch import Ended, play_at_once
from rubnoise.simulation.block import Play, RunSetup, Watch, next_state
from rubnoise.simulation.draws import start
from rubnoise.simulation.extent import Engine
from rubnoise.simulation.intervention import Intervention
from rubnoise.simulation.junctions import Processes, play_touches
from rubnoise.simulation.linear import LinearMotion, slider_constants
from rubnoise.simulation.observer import Notifier, Observer
from rubnoise.simulation.state import State


def finished(model: Model, state: State) -> bool:
    """Return whether every tick is finished and every birth of the run has happened."""
    return state.ticks > model.tick_count and (model.free is not None or state.next_birth > model.distance)


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
    notifier = None if observe is None else Notifier(observe, two_way=model.is_two_way)
    if engine == "batch":
        play: Play = partial(play_at_once, ended=ended)
    else:
        play = Processes(model, notifier if observe is not None and observe.of_lives else None, intervene)
    run = RunSetup(model=model, seed=seed, sink=sink, play=play, watch=watch)
    state = start(model, seed) if model.free is None else State()
    if model.is_two_way:
        from rubnoise.simulation.two_way import TwoWayMotion  # takes long to load, and few runs need it

        run = replace(run, two_way=TwoWayMotion(model, seed, sink, state.live, notifier))
    elif (constants := slider_constants(model)) is not None:
        run = replace(run, linear=LinearMotion(model, constants, state.live))
    step = partial(next_state, run) if model.free is None else _free_step(run, model.free, engine)
    with _collecting_by_blocks() as collect:
        while not finished(model, state):
            state = step(state)
            collect()
    return state


def _free_step(run: RunSetup, free: FreeSeparation, engine: Engine) -> Callable[[State], State]:
    from rubnoise.simulation.free_motion import FreeMotion  # takes long to load, and few runs need it

    motion = FreeMotion(run.model, free, run.seed, run.sink, play_touches if engine == "events" else None)

    def step(state: State) -> State:
        after = motion.next_state(state)
        if run.watch is not None:
            run.watch(float(after.ticks - 1) * run.model.tick, after.junctions, motion.in_contact)
        return after

    return step


@contextmanager
def _collecting_by_blocks() -> Iterator[Callable[[], object]]:
    """Switch off automatic garbage collection, and yield a function that collects the garbage of a block.

    Inside a block, the collector would check all live processes and events again and again: a fifth of the time.
    """
    looked = gc.isenabled()
    gc.disable()
    try:
        yield partial(gc.collect, 0)
    finally:
        if looked:
            gc.enable()


def check_guests(model: Model, engine: Engine, observe: Observer | None, intervene: Intervention | None) -> None:
    """Raise Refused if an observer or intervention is not of the right kind, or if the run lacks the events it needs.

    Landmarks, which only a two-way slider has, are reported by either engine. An intervention is also refused in a
    two-way run: when it ends a life the force jumps, and the model does not say how a slider at rest moves on then.
    Both are refused in free motion, where the motion itself decides where summits are touched and left.
    """
    for guest, name in ((observe, "observe"), (intervene, "intervene")):
        if guest is not None and model.free is not None:
            raise Refused(
                f"{name}: in free motion touches are known only after the motion of a block;"
                ' load.motion = "first-order" takes observers and interventions'
            )
    if observe is not None and not isinstance(observe, Observer):
        raise Refused(f"observe: {observe!r} is not an Observer; rubnoise.Observer(birth=...) makes one from functions")
    if intervene is not None and not callable(intervene):
        raise Refused(f"intervene: {intervene!r} is not a function of the environment and the live junctions")
    if intervene is not None and model.is_two_way:
        raise Refused(
            "intervene: when a life is ended early the force jumps, and the motion of a two-way slider is not"
            ' defined there; slider.coupling = "one-way" takes interventions'
        )
    motion = () if observe is None else observe.of_motion
    if motion and not model.is_two_way:
        raise Refused(
            f"observe: {motion[0]}: only a slider that pushes back sticks, breaks away and turns round;"
            ' slider.coupling = "two-way" makes it one'
        )
    hears_of_lives = observe is not None and (observe.of_lives or not motion)
    for asked, what in (
        (intervene is not None, "intervene: an intervention is a process among events"),
        (hears_of_lives, "observe: births, mid-lives and deaths are events"),
    ):
        if asked and engine != "events":
            raise Refused(f'{what}: it needs the engine "events", not "{engine}"')
