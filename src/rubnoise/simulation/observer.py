"""Observers, called at the events of a run; junctions that are alive, and interventions that end their lives."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from heapq import heappop, heappush
from itertools import count
from operator import index
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray
from simpy import Environment, Process
from simpy.events import ProcessGenerator

from rubnoise.contact.pulses import Pulse, area_of
from rubnoise.errors import Refused
from rubnoise.record.rows import LandmarkKind
from rubnoise.simulation.state import LiveRows

OnLife = Callable[[int, float], None]
"""Called with the row number of a junction and the distance in um of its birth, mid-life or death."""

OnMotion = Callable[[float, float, float], None]
"""Called with time (s), sliding distance (um) and velocity x' (um/s) of a landmark."""

_LIVES: Final = ("birth", "mid_life", "death")
_MOTION: Final = {kind.name.lower(): kind for kind in LandmarkKind}


@dataclass(frozen=True, slots=True, kw_only=True)
class Observer:
    """Functions to call at the events of a run, while it runs; None if nothing is to be called.

    birth, mid_life (half of the life after birth; d on the centre line), death: called with the junction's number,
    which is its row in /junctions, and the distance in um, which equals that of the row to the bit. A birth before the
    start and a death after the end of the run are not reported. Mid-lives cost one more event for each junction, but
    only if an observer asks for them.

    stick, slip, reversal, forward: called when a two-way slider begins to do this, with time (s), sliding distance (um)
    and velocity x' (um/s), which equal those of the row in /landmarks to the bit. In a two-way run all calls come in
    order of time; a birth or death is reported when the slider first passes there. Raises Refused if a value is not
    callable.

    >>> import rubnoise
    >>> born = []
    >>> observer = rubnoise.Observer(birth=lambda number, distance: born.append(distance))
    >>> record = rubnoise.simulate("paper/fig4", observe=observer)
    >>> bool(len(born) == (record.junctions["birth_distance"][:] > 0.0).sum())
    True
    """

    birth: OnLife | None = None
    mid_life: OnLife | None = None
    death: OnLife | None = None
    stick: OnMotion | None = None
    slip: OnMotion | None = None
    reversal: OnMotion | None = None
    forward: OnMotion | None = None

    def __post_init__(self) -> None:
        for event in fields(self):
            function = getattr(self, event.name)
            if function is not None and not callable(function):
                of = (
                    "a time, a distance and a velocity"
                    if event.name in _MOTION
                    else "a junction's number and a distance"
                )
                raise Refused(f"Observer: {event.name}: {function!r} is no function of {of}")

    @property
    def of_motion(self) -> tuple[str, ...]:
        """Names of the landmarks that it watches."""
        return tuple(name for name in _MOTION if getattr(self, name) is not None)

    @property
    def of_lives(self) -> bool:
        """Whether it watches births, mid-lives or deaths."""
        return any(getattr(self, name) is not None for name in _LIVES)


class Notifier:
    """Calls an observer at the events of a run, up to its end (um).

    In a two-way run, the contact is played ahead of the slider. So a birth, mid-life or death waits until the slider
    first passes it.
    """

    def __init__(self, observer: Observer, end: float, *, two_way: bool = False) -> None:
        """Begin; nothing waits."""
        self._end, self._two_way = end, two_way
        self.observer = observer
        self._waiting: list[tuple[float, int, OnLife, int]] = []
        self._order = count()

    def life(self, event: Literal["birth", "mid_life", "death"], junction: int, distance: float) -> None:
        """Report a birth, a mid-life or a death at its place in um."""
        function: OnLife | None = getattr(self.observer, event)
        if function is None or distance > self._end:
            return
        if self._two_way:
            heappush(self._waiting, (distance, next(self._order), function, junction))
        else:
            function(junction, distance)

    def landmarks(self, columns: Mapping[str, NDArray[Any]]) -> None:
        """Report landmarks in order, each after the events that the slider passed before it."""
        names = ("kind", "time", "distance", "velocity")
        for kind, time, distance, velocity in zip(*(columns[name].tolist() for name in names), strict=True):
            self.reach(distance)
            function: OnMotion | None = getattr(self.observer, LandmarkKind(kind).name.lower())
            if function is not None:
                function(time, distance, velocity)

    def reach(self, distance: float) -> None:
        """Report the waiting events up to the distance (um) that a two-way slider has reached."""
        while self._waiting and self._waiting[0][0] <= distance:
            place, _, function, junction = heappop(self._waiting)
            function(junction, place)


# Interventions.
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
