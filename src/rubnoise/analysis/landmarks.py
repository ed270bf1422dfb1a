"""The landmarks of a run between two times, and the sticks, slips, flights and impacts that follow from them."""

from bisect import bisect_left
from dataclasses import dataclass
from typing import Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows
from rubnoise.record.rows import ContactKind, LandmarkKind


def first_landmark(rows: Rows, time: float) -> int:
    """Return the first landmark at or after a time in s, or their number if there is none."""
    return bisect_left(
        range(rows.rows("landmarks")), time, key=lambda row: float(rows.column("landmarks", "time", row, row + 1)[0])
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Lasting:
    """Rows ``first`` to before ``last`` of /landmarks, and what lasts from one kind of them to the next landmark.

    begin, end: of each in s, cut off at two times; times: the durations in s of those wholly between these.
    """

    first: int
    last: int
    begin: Doubles
    end: Doubles
    times: Doubles


def _lasting(rows: Rows, begin: float, end: float, most: int | None, begins: int, ends: int) -> _Lasting:
    """Return what lasts between two times in s; of more than ``most`` landmarks, up to the time of the next one.

    ``begins`` and ``ends`` are kinds of landmarks. If the first one of a run ends something, it began with it.
    """
    first, last = first_landmark(rows, begin), first_landmark(rows, end)
    if most is not None and last - first > most:
        last = first + most
        end = float(rows.column("landmarks", "time", last, last + 1)[0])
    kind, time = (rows.column("landmarks", name, max(first - 1, 0), last) for name in ("kind", "time"))
    if first == 0:
        before = begins if kind.size and kind[0] == ends else -1
        kind, time = np.append(before, kind), np.append(begin, time)
    at = np.flatnonzero(kind == begins)
    whole = at[(at > 0) & (at + 1 < kind.size)]
    until = np.append(time, end)[at + 1]
    durations = time[whole + 1] - time[whole]
    return _Lasting(first=first, last=last, begin=np.maximum(time[at], begin), end=until, times=durations)


@dataclass(frozen=True, slots=True, kw_only=True)
class Flights:
    """Flights and impacts between two times of a run.

    begin, end: every flight in s, from contact lost to contact made, cut off at the two times; times: the durations in
    s of flights that begin and end between them; impacts, speeds: the times in s when contact is made, and the speeds
    in um/s at which the overlap then grows, by sliding and by falling.
    """

    begin: Doubles
    end: Doubles
    times: Doubles
    impacts: Doubles
    speeds: Doubles

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the flights of a free run between two times in s, of ``most`` landmarks at most."""
        found = _lasting(rows, begin, end, most, ContactKind.CONTACT_LOST, ContactKind.CONTACT_MADE)
        names = ("kind", "time", "impact_speed")
        kind, time, speed = (rows.column("landmarks", name, found.first, found.last) for name in names)
        made = kind == ContactKind.CONTACT_MADE
        return cls(begin=found.begin, end=found.end, times=found.times, impacts=time[made], speeds=speed[made])

    def share(self, begin: float, end: float) -> float:
        """Return the share of the time from one to the other, in s, that the slider is off the surface."""
        return float((self.end - self.begin).sum()) / (end - begin)


@dataclass(frozen=True, slots=True, kw_only=True)
class StickSlip:
    """Sticks and slips between two times of a run.

    stick_begin, stick_end: every stick in s, cut off at the two times; stick_times: the durations in s of sticks that
    begin and end between them; slip_lengths: the distances in um from a breakaway to the next stick or turn.
    """

    stick_begin: Doubles
    stick_end: Doubles
    stick_times: Doubles
    slip_lengths: Doubles

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the sticks and slips of a two-way run between two times in s, of ``most`` landmarks at most."""
        found = _lasting(rows, begin, end, most, LandmarkKind.STICK, LandmarkKind.SLIP)
        kind, distance = (rows.column("landmarks", name, found.first, found.last) for name in ("kind", "distance"))
        slipped = np.flatnonzero(kind[:-1] == LandmarkKind.SLIP)
        return cls(
            stick_begin=found.begin,
            stick_end=found.end,
            stick_times=found.times,
            slip_lengths=distance[slipped + 1] - distance[slipped],
        )
