"""Interventions: a process of the user that ends lives, and the live junctions that it sees."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from operator import index

import numpy as np
from simpy import Environment
from simpy.events import ProcessGenerator

from rubnoise.contact.off_centre import area_of
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.simulation.process import DistanceClock, LiveSet


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveJunction:
    """A junction that is alive: row number, place of birth, diameter (um), area when it was looked at (um^2)."""

    number: int
    birth_distance: float
    diameter: float
    area: float


class LiveJunctions:
    """The junctions that are alive now: iterate for a LiveJunction each, in order of birth; ``end`` one by its number.

    Raises ValueError for a number to ``end`` that is not alive.

    >>> import rubnoise
    >>> def end_first(env, live):
    ...     yield env.timeout(50.0)
    ...     live.end(next(iter(live)).number)
    >>> record = rubnoise.simulate("paper/fig4", intervene=end_first)
    >>> int((record.junctions["state"][:] & rubnoise.JunctionState.ENDED_EARLY > 0).sum())
    1
    """

    def __init__(self, pulse: Pulse) -> None:
        """See no junction yet; lives have the area of a pulse."""
        self._pulse = pulse
        self._ended: set[int] = set()

    def look_at(self, env: Environment, live: LiveSet) -> None:
        """See the junctions of a block from now on."""
        self._env, self._live = env, live
        for number in self._ended & live.processes.keys():  # ended by an observer of a death at a block's very end
            live.processes[number].interrupt()
        self._ended &= live.processes.keys()

    def __len__(self) -> int:
        return len(self._live.processes.keys() - self._ended)

    def __contains__(self, number: object) -> bool:
        return number in self._live.processes and number not in self._ended

    def __iter__(self) -> Iterator[LiveJunction]:
        rows = self._live.alive()
        age = np.clip(self._env.now - rows.birth, 0.0, 2.0 * rows.half_life)  # the clock, which adds gaps, rounds
        areas = area_of(self._pulse, age, rows.diameter, rows.offset)
        columns = (rows.junction.tolist(), rows.birth.tolist(), rows.diameter.tolist(), areas.tolist())
        found = [
            LiveJunction(number=number, birth_distance=birth, diameter=diameter, area=area)
            for number, birth, diameter, area in zip(*columns, strict=True)
        ]
        return iter([junction for junction in found if junction.number not in self._ended])

    def end(self, number: int) -> None:
        """End the life of a junction where the clock stands; its row then has the state ended_early."""
        number = index(number)
        if number not in self:
            raise ValueError(f"junction {number} is not alive at {self._env.now:g} um")
        self._live.processes[number].interrupt()
        self._ended.add(number)

    def __repr__(self) -> str:
        return f"{len(self)} junctions alive at {self._env.now:g} um"


Intervention = Callable[[Environment, LiveJunctions], ProcessGenerator]
"""A SimPy process of the user's own: is given the environment, whose clock is in um, and who is alive."""


class Intervening:
    """One intervention through all blocks of a run, for which the clock and its queue outlive a block."""

    def __init__(self, intervention: Intervention, pulse: Pulse) -> None:
        """Start nothing yet."""
        self._intervention = intervention
        self._live = LiveJunctions(pulse)
        self._clock: DistanceClock | None = None
        self._started = False

    def clock(self, begin: float) -> DistanceClock:
        """Return the clock, which stands where a block begins (um); what the intervention waits for stays to come."""
        if self._clock is None:
            self._clock = DistanceClock(begin)
        else:
            self._clock.begin_again(begin)
        return self._clock

    def join(self, env: DistanceClock, live: LiveSet) -> None:
        """Show who lives in a block, and start the process in the first one; raises Refused if it is none."""
        self._live.look_at(env, live)
        if self._started:
            return
        self._started = True
        process = self._intervention(env, self._live)
        if not hasattr(process, "throw"):
            raise Refused(
                f"intervene: returned {process!r}, and has to be a process, a function that yields events:"
                " `yield env.timeout(100.0)` waits for 100 um"
            )
        env.process(process)


def name_of(intervention: Intervention) -> str:
    """Return what a result file calls an intervention: the module and the name of its function."""
    named = intervention if hasattr(intervention, "__qualname__") else type(intervention)
    return f"{named.__module__}.{named.__qualname__}"
