"""The contact as SimPy processes: junctions are born, live for 2d of sliding, and die.

Distance is the clock: ``env.now`` is the sliding distance in um, within its rounding. Only births, deaths and observed
mid-lives are events. The aggregator wakes once per tick range, and computes it from exactly the junctions that have
joined and left by then. No row is computed from the clock, but for lives that an interrupt ends.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from simpy import Environment, Interrupt, Process
from simpy.events import ProcessGenerator, Timeout

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.simulation.block import Block, Visit
from rubnoise.simulation.intervention import Intervention, joined
from rubnoise.simulation.live_set import LiveSet
from rubnoise.simulation.observer import Notifier, OnLife
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import TickRange

Life = Callable[[Environment, LiveSet, int, float, float], ProcessGenerator]
"""The process function of a junction: its number, where it is born, and the distance from birth to mid-life (um)."""


def until(env: Environment, place: float) -> Timeout:
    """Return the event at a place (um); the clock adds and rounds, so it may be slightly beyond."""
    return env.timeout(max(place - env.now, 0.0))


def junction(env: Environment, live: LiveSet, number: int, birth: float, half_life: float) -> ProcessGenerator:
    """Live through two half-lives of sliding and die, or die earlier at an interrupt."""
    death = birth + 2.0 * half_life
    try:
        yield env.timeout(max(death - env.now, 0.0))
    except Interrupt:
        death = min(max(env.now, birth), death)
    live.leave(number, death)


def observed_junction(
    env: Environment, live: LiveSet, number: int, birth: float, half_life: float, notifier: Notifier
) -> ProcessGenerator:
    """Live as a junction does, and report mid-life and death to the observer."""
    middle, death = birth + half_life, birth + 2.0 * half_life
    try:
        if notifier.is_rising(number) and middle > env.now:
            yield until(env, middle)
            notifier.mid_life(number, middle)
        yield until(env, death)
    except Interrupt:
        death = min(max(env.now, birth), death)
    live.leave(number, death)
    notifier.death(number, death)


def births(
    env: Environment, live: LiveSet, born: LiveRows, end: float, life: Life, told: OnLife | None
) -> ProcessGenerator:
    """Wait for a birth, start a junction, and repeat until the end of the block (um)."""
    waits = np.maximum(np.diff(born.birth, prepend=env.now), 0.0)
    columns = (waits, born.junction, born.birth, born.half_life)
    for wait, number, birth, half_life in zip(*(each.tolist() for each in columns), strict=True):
        yield env.timeout(wait)
        live.join(number, env.process(life(env, live, number, birth, half_life)))
        if told is not None:
            told(number, birth)
    yield until(env, end)


def aggregate(
    env: Environment, tick_ranges: Sequence[TickRange], block_end: Process, visit: Visit, live: LiveSet
) -> ProcessGenerator:
    """Wake once per tick range, after all events up to its last tick, and visit its ticks with the live set.

    It wakes half a tick late, so that a birth or death at exactly that tick has happened, whatever the queue's order.
    """
    for tick_range in tick_ranges:
        yield block_end if tick_range is tick_ranges[-1] else until(env, tick_range.wake)
        visit(tick_range, live.rows())
    yield block_end


class Processes:
    """The engine of processes: one clock and one live set for all blocks of a run."""

    def __init__(self, model: Model, notifier: Notifier | None, intervene: Intervention | None) -> None:
        """Begin at a distance of 0; the notifier's observer and the intervention may be None."""
        self._env = Environment()
        self._live = LiveSet()
        self._notifier = notifier
        self._life: Life = junction if notifier is None else partial(observed_junction, notifier=notifier)
        self._start = None if intervene is None else lambda: joined(intervene, model.pulse, self._env, self._live)

    def __call__(self, block: Block, visit: Visit) -> LiveRows:
        """Play one block; return its rows at its end, carried ones first."""
        env, live, notifier, state = self._env, self._live, self._notifier, block.state
        live.begin(state.live, block.born, state.begin)
        if state.block == 0:
            self._begin(state.live, state.begin)
        told = None if notifier is None else notifier.birth
        block_end = env.process(births(env, live, block.born, block.end, self._life, told))
        env.run(until=env.process(aggregate(env, block.tick_ranges, block_end, visit, live)))
        rows = live.rows()
        if notifier is not None:
            notifier.end_block(rows, block.end)
        return rows

    def _begin(self, alive: LiveRows, distance: float) -> None:
        """Start the junctions that are alive when the run begins, and the process of the user."""
        env, live, notifier = self._env, self._live, self._notifier
        if notifier is not None:
            notifier.begin(alive, distance)
        alive = alive.at(np.flatnonzero(alive.death > distance))
        columns = (alive.junction, alive.birth, alive.half_life)
        for number, birth, half_life in zip(*(each.tolist() for each in columns), strict=True):
            live.processes[number] = env.process(self._life(env, live, number, birth, half_life))
        if self._start is not None:
            self._start()


def touch(env: Environment, end: float) -> ProcessGenerator:
    """Stay in contact with a free slider up to a distance (um)."""
    yield until(env, end)


def touches(env: Environment, made: list[float], lost: list[float]) -> ProcessGenerator:
    """Wait until contact is made, start a touch, and repeat."""
    for begin, end in zip(made, lost, strict=True):
        yield until(env, begin)
        env.process(touch(env, end))


def play_touches(begin: float, end: float, made: Doubles, lost: Doubles) -> None:
    """Play the touches of a block.

    made, lost (um): where each touch begins, in increasing order, and where it ends. The motion has decided this
    already, as with a two-way slider; no row is computed from the clock.
    """
    env = Environment(begin)
    env.process(touches(env, made.tolist(), lost.tolist()))
    env.run(until=until(env, end))
