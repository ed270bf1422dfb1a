"""Observers: functions called during a run, at births, mid-lives and deaths and at the events of a two-way slider."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from heapq import heappop, heappush
from itertools import count
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused
from rubnoise.record.rows import LandmarkKind
from rubnoise.simulation.state import LiveRows

Told = Callable[[int, float], None]
"""Is told the row number of a junction and the distance in um at which something happens to it."""

ToldOfMotion = Callable[[float, float, float], None]
"""Is told time (s), sliding distance (um) and velocity x' (um/s) of a landmark."""

_MOTION: Final = {kind.name.lower(): kind for kind in LandmarkKind}


@dataclass(frozen=True, slots=True, kw_only=True)
class Observer:
    """Functions that are called at what happens in a run, while it happens; None for no interest.

    birth, mid_life (at birth + d), death: given the junction's number, which is its row in /junctions, and the distance
    in um of what happens, to the bit that of the row. Junctions alive at the start have been born before, and those
    alive at the end die later: an observer is called at neither. Mid-lives cost one more
    event a junction, only if an observer asks for them.

    stick, slip, reversal, forward: given time (s), sliding distance (um) and velocity x' (um/s) where a two-way slider
    begins that, to the bit those of the row in /landmarks. Of a two-way run everything comes in order of time, a birth
    or death when the slider first passes there. Raises Refused for what cannot be called.
    """

    birth: Told | None = None
    mid_life: Told | None = None
    death: Told | None = None
    stick: ToldOfMotion | None = None
    slip: ToldOfMotion | None = None
    reversal: ToldOfMotion | None = None
    forward: ToldOfMotion | None = None

    def __post_init__(self) -> None:
        for event in fields(self):
            told = getattr(self, event.name)
            if told is not None and not callable(told):
                of = (
                    "a time, a distance and a velocity"
                    if event.name in _MOTION
                    else "a junction's number and a distance"
                )
                raise Refused(f"Observer: {event.name}: {told!r} is no function of {of}")

    @property
    def of_motion(self) -> tuple[str, ...]:
        """Names of the landmarks that are asked for."""
        return tuple(name for name in _MOTION if getattr(self, name) is not None)

    @property
    def of_lives(self) -> bool:
        """Whether births, mid-lives or deaths are asked for."""
        return any(told is not None for told in (self.birth, self.mid_life, self.death))


class Telling:
    """Tells an observer everything once, wherever a run is cut into blocks.

    The contact of a two-way run is ahead of its slider: what happens there waits until the slider first passes it.
    """

    def __init__(self, observer: Observer, *, two_way: bool = False) -> None:
        """Know of nobody yet."""
        self._observer = observer
        self._two_way = two_way
        self._waiting: list[tuple[float, int, Told, int]] = []
        self._order = count()
        self._of_motion = {kind.value: getattr(observer, name) for name, kind in _MOTION.items()}
        self._rising: set[int] = set()
        self._alive: set[int] = set()
        self._begun = False

    def begin(self, carried: LiveRows, distance: float) -> None:
        """Take note of who is alive where the first block begins (um)."""
        if not self._begun:
            self._begun = True
            self._alive.update(carried.junction[carried.death > distance].tolist())
            self._rising.update(carried.junction[_middle(carried) > distance].tolist())

    def is_rising(self, junction: int) -> bool:
        """Whether a mid-life is still to be told, and somebody asks for it."""
        return self._observer.mid_life is not None and junction in self._rising

    def birth(self, junction: int, distance: float) -> None:
        """Tell of a birth."""
        self._alive.add(junction)
        self._rising.add(junction)
        self._tell(self._observer.birth, junction, distance)

    def mid_life(self, junction: int, distance: float) -> None:
        """Tell of a mid-life, unless that has been done."""
        if junction in self._rising:
            self._rising.remove(junction)
            self._tell(self._observer.mid_life, junction, distance)

    def death(self, junction: int, distance: float) -> None:
        """Tell of a death, unless that has been done."""
        if junction in self._alive:
            self._alive.remove(junction)
            self._rising.discard(junction)
            self._tell(self._observer.death, junction, distance)

    def settle(self, rows: LiveRows, distance: float) -> None:
        """Tell what happens at the very end of a block (um): rounding decides whether its clock came to it."""
        moments = [(_middle(rows), self._rising, self.mid_life), (rows.death, self._alive, self.death)]
        for places, waiting, tell in moments:
            for row in np.flatnonzero(places <= distance).tolist():
                if int(rows.junction[row]) in waiting:
                    tell(int(rows.junction[row]), float(places[row]))

    def resume_motion(self, rows: LiveRows, times: NDArray[np.float64], reached: float, distance: float) -> None:
        """Take note of what lies ahead of the slider where the first block begins (um).

        rows: that still wait for a first passage; times (2, rows): of their births and deaths (s); reached: where the
        slider is (um).
        """
        if self._begun:
            return
        places = (rows.birth, _middle(rows), rows.death)
        ahead = (np.isnan(times[0]) & ~np.signbit(rows.birth), places[1] > reached, np.isnan(times[1]))
        tell = (self._observer.birth, self._observer.mid_life, self._observer.death)
        for told, place, left in zip(tell, places, ahead, strict=True):
            for row in np.flatnonzero(left & (place <= distance)).tolist():
                self._tell(told, int(rows.junction[row]), float(place[row]))

    def landmarks(self, columns: Mapping[str, NDArray[Any]]) -> None:
        """Tell of landmarks in their order, each after what the slider has passed before it."""
        names = ("kind", "time", "distance", "velocity")
        for kind, time, distance, velocity in zip(*(columns[name].tolist() for name in names), strict=True):
            self.reach(distance)
            told = self._of_motion[kind]
            if told is not None:
                told(time, distance, velocity)

    def reach(self, distance: float) -> None:
        """Tell what has waited until a two-way slider came to a distance (um)."""
        while self._waiting and self._waiting[0][0] <= distance:
            place, _, told, junction = heappop(self._waiting)
            told(junction, place)

    def _tell(self, told: Told | None, junction: int, distance: float) -> None:
        if told is None:
            return
        if self._two_way:
            heappush(self._waiting, (distance, next(self._order), told, junction))
        else:
            told(junction, distance)


def _middle(rows: LiveRows) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Where each life has its greatest area, in um; nowhere for a life that ends before."""
    middle = rows.birth + rows.diameter
    return np.where(middle < rows.death, middle, np.inf)
