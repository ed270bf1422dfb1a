"""The contact as SimPy processes: junctions are born, live for 2d of sliding, and die.

Distance is the clock: ``env.now`` is the sliding distance in um, within its rounding. Only births, deaths and observed
mid-lives are events. The clock stops once per tick range, whose ticks are computed from exactly the junctions that have
joined and left by then. No row is computed from the clock, but for lives that an interrupt ends.
"""

from collections.abc import Iterator, Sequence
from math import ulp

import numpy as np
from simpy import Environment, Interrupt
from simpy.events import ProcessGenerator, Timeout

from rubnoise.model import Model
from rubnoise.simulation.observer import Intervention, LiveSet, Notifier, joined
from rubnoise.simulation.state import LiveRows, State


def until(env: Environment, place: float) -> Timeout:
    """Return the event at a place (um); the clock adds and rounds, so it may be slightly beyond."""
    return env.timeout(max(place - env.now, 0.0))


def junction(
    env: Environment, live: LiveSet, notifier: Notifier | None, number: int, birth: float, half_life: float
) -> ProcessGenerator:
    """Live through two half-lives of sliding and die, or die earlier at an interrupt; tell an observer of it."""
    middle, death = birth + half_life, birth + 2.0 * half_life
    try:
        if notifier is not None and notifier.observer.mid_life is not None and middle > 0.0:
            yield until(env, middle)
            notifier.life("mid_life", number, middle)
        yield env.timeout(max(death - env.now, 0.0))  # as `until` does, without the call
    except Interrupt:
        death = min(max(env.now, birth), death)
        live.ended[number] = death
    del live.processes[number]
    if notifier is not None:
        notifier.life("death", number, death)


def births(env: Environment, live: LiveSet, notifier: Notifier | None, born: LiveRows, end: float) -> ProcessGenerator:
    """Wait for a birth, start a junction, and repeat until the end of the block (um).

    The clock rounds, so it stops a little behind the end, when all events up to there have happened.
    """
    waits = np.maximum(np.diff(born.birth, prepend=env.now), 0.0)
    columns = (waits, born.junction, born.birth, born.half_life)
    for wait, number, birth, half_life in zip(*(each.tolist() for each in columns), strict=True):
        yield env.timeout(wait)
        live.join(number, env.process(junction(env, live, notifier, number, birth, half_life)))
        if notifier is not None:
            notifier.life("birth", number, birth)
    yield until(env, end + 4.0 * ulp(end))


class Processes:
    """The engine of processes: one clock and one live set for all blocks of a run."""

    def __init__(self, model: Model, notifier: Notifier | None, intervene: Intervention | None) -> None:
        """Begin at a distance of 0; the notifier's observer and the intervention may be None."""
        self._env = Environment()
        self._live = LiveSet()
        self._notifier = notifier
        self._pulse, self._intervene = model.pulse, intervene

    def __call__(self, state: State, born: LiveRows, end: float, wakes: Sequence[float]) -> Iterator[LiveRows]:
        """Play one block; yield the rows of those who have joined by each place and by its end, carried first."""
        env, live = self._env, self._live
        live.begin(state.live, born)
        if state.block == 0:
            self._begin(state.live)
        block_end = env.process(births(env, live, self._notifier, born, end))
        for wake in wakes:
            env.run(until=block_end if wake == end else until(env, wake))
            yield live.rows()
        env.run(until=block_end)
        yield live.rows()

    def _begin(self, alive: LiveRows) -> None:
        """Start the junctions that are alive when the run begins, and the process of the user."""
        env, live, notifier = self._env, self._live, self._notifier
        columns = (alive.junction, alive.birth, alive.half_life)
        for number, birth, half_life in zip(*(each.tolist() for each in columns), strict=True):
            live.processes[number] = env.process(junction(env, live, notifier, number, birth, half_life))
        if self._intervene is not None:
            joined(self._intervene, self._pulse, env, live)
