"""Observers: functions called during a run, at births, mid-lives and deaths and at the events of a two-way slider."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from heapq import heappop, heappush
from itertools import count
from typing import Any, Final, Literal

from numpy.typing import NDArray

from rubnoise.errors import Refused
from rubnoise.record.rows import LandmarkKind

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
