"""The junctions that are alive, as their processes report it, and interventions: processes of a user that end lives."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from operator import index

import numpy as np
from simpy import Environment, Process
from simpy.events import ProcessGenerator

from rubnoise.contact.pulses import Pulse, area_of
from rubnoise.errors import Refused
from rubnoise.simulation.state import LiveRows


class LiveSet:
    """The live junctions of a run and their processes, and the rows of the block that is played.

    ``processes`` maps the row number of each live junction to its process, in order of birth; interrupting a process
    ends its junction now. ``ended`` maps that of each junction that was ended early in the block to where it was (um).
    """

    def __init__(self) -> None:
        """Hold no junction."""
        self.processes: dict[int, Process] = {}
        self.ended: dict[int, float] = {}
        self._rows = LiveRows.none()
        self._joined = 0

    def begin(self, carried: LiveRows, born: LiveRows) -> None:
        """Continue with the rows of a block, carried ones and those still to be born."""
        self._rows, self._joined = carried.then(born), len(carried)
        self.ended.clear()

    def join(self, number: int, process: Process) -> None:
        """Add the next junction that is born."""
        self.processes[number] = process
        self._joined += 1

    def rows(self) -> LiveRows:
        """Return the junctions that have joined so far, with the departures of those that were ended early."""
        junction, departure = self._rows.junction, self._rows.departure.copy()
        early = np.isin(junction, list(self.ended))
        departure[early] = [self.ended[number] for number in junction[early].tolist()]
        return replace(self._rows, departure=departure).at(slice(0, self._joined))

    def alive(self) -> LiveRows:
        """Return the junctions that have a process now, in order of birth."""
        return self._rows.at(np.searchsorted(self._rows.junction, list(self.processes)))


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveJunction:
    """A live junction: row number, place of birth (um), diameter (um), and area (um^2) when this object was made."""

    number: int
    birth_distance: float
    diameter: float
    area: float


class LiveJunctions:
    """The junctions that are alive now: iterate over them in order of birth, or ``end`` one by its number.

    Each is a LiveJunction. ``end`` raises ValueError if the junction is not alive.

    >>> import rubnoise
    >>> def end_first(env, live):
    ...     yield env.timeout(50.0)
    ...     live.end(next(iter(live)).number)
    >>> record = rubnoise.simulate("paper/fig4", intervene=end_first)
    >>> int((record.junctions["state"][:] & rubnoise.JunctionState.ENDED_EARLY > 0).sum())
    1
    """

    def __init__(self, pulse: Pulse, env: Environment, live: LiveSet) -> None:
        """Show the live junctions of a run; ``pulse`` gives the areas."""
        self._pulse, self._env, self._live = pulse, env, live
        self._ended: set[int] = set()

    def __len__(self) -> int:
        return len(self._live.processes.keys() - self._ended)

    def __contains__(self, number: object) -> bool:
        return number in self._live.processes and number not in self._ended

    def __iter__(self) -> Iterator[LiveJunction]:
        rows = self._live.alive()
        age = np.clip(self._env.now - rows.birth, 0.0, 2.0 * rows.half_life)  # the clock adds gaps and rounds
        areas = area_of(self._pulse, age, rows.diameter, rows.offset)
        columns = (rows.junction.tolist(), rows.birth.tolist(), rows.diameter.tolist(), areas.tolist())
        found = [
            LiveJunction(number=number, birth_distance=birth, diameter=diameter, area=area)
            for number, birth, diameter, area in zip(*columns, strict=True)
        ]
        return iter([junction for junction in found if junction.number not in self._ended])

    def end(self, number: int) -> None:
        """End the life of a junction now; its row then has the state ended_early."""
        number = index(number)
        if number not in self:
            raise ValueError(f"junction {number} is not alive at {self._env.now:g} um")
        self._live.processes[number].interrupt()
        self._ended.add(number)

    def __repr__(self) -> str:
        return f"{len(self)} junctions alive at {self._env.now:g} um"


Intervention = Callable[[Environment, LiveJunctions], ProcessGenerator]
"""A SimPy process function of the user: called with the environment, whose clock is in um, and the live junctions."""


def joined(intervention: Intervention, pulse: Pulse, env: Environment, live: LiveSet) -> None:
    """Start an intervention among the processes of a run; raise Refused if it is no process."""
    process = intervention(env, LiveJunctions(pulse, env, live))
    if not hasattr(process, "throw"):
        raise Refused(
            f"intervene: returned {process!r}, and has to be a process, a function that yields events:"
            " `yield env.timeout(100.0)` waits for 100 um"
        )
    env.process(process)


def name_of(intervention: Intervention) -> str:
    """Return the name of an intervention in a result file: the module and the name of its function."""
    named = intervention if hasattr(intervention, "__qualname__") else type(intervention)
    return f"{named.__module__}.{named.__qualname__}"
