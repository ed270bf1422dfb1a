"""The landmarks of a run between two times, and the sticks, slips, flights and impacts that follow from them."""

from bisect import bisect_left
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows
from rubnoise.record.rows import ContactKind, LandmarkKind


@dataclass(frozen=True, slots=True, kw_only=True)
class Landmarks:
    """Rows ``first`` to before ``last`` of /landmarks: those between two times in s."""

    rows: Rows
    first: int
    last: int
    begin: float
    end: float
    kind: NDArray[Any]
    time: Doubles

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the landmarks between two times in s; at most ``most``, up to the time of the next one."""
        first, last = first_landmark(rows, begin), first_landmark(rows, end)
        if most is not None and last - first > most:
            last = first + most
            end = float(rows.column("landmarks", "time", last, last + 1)[0])
        kind, time = (rows.column("landmarks", name, first, last) for name in ("kind", "time"))
        return cls(rows=rows, first=first, last=last, begin=begin, end=end, kind=kind, time=time)

    def column(self, name: str) -> NDArray[Any]:
        """Return another column of them."""
        return self.rows.column("landmarks", name, self.first, self.last)

    def lasting(self, begins: int, ends: int) -> tuple[Doubles, Doubles, Doubles]:
        """Return the intervals in s that begin at one kind of landmark and last until the next landmark.

        These are begin and end of each, cut off at the two times, and the durations of those that lie wholly between
        them. ``ends``: if the first landmark is of this kind, an interval had begun before it.
        """
        at = np.flatnonzero(self.kind == begins)
        whole = at[at + 1 < self.kind.size]
        if self.kind.size:
            before = self.kind[0] == ends
        else:
            last = self.first - 1
            before = last >= 0 and self.rows.column("landmarks", "kind", last, self.first)[0] == begins
        return (
            np.concatenate([[self.begin] * bool(before), self.time[at]]),
            np.concatenate(
                [[self.time[0] if self.kind.size else self.end] * bool(before), np.append(self.time, self.end)[at + 1]]
            ),
            self.time[whole + 1] - self.time[whole],
        )


def first_landmark(rows: Rows, time: float) -> int:
    """Return the first landmark at or after a time in s, or their number if there is none."""
    return bisect_left(
        range(rows.rows("landmarks")), time, key=lambda row: float(rows.column("landmarks", "time", row, row + 1)[0])
    )


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
        found = Landmarks.of(rows, begin, end, most)
        begins, ends, times = found.lasting(ContactKind.CONTACT_LOST, ContactKind.CONTACT_MADE)
        made = found.kind == ContactKind.CONTACT_MADE
        return cls(
            begin=begins,
            end=ends,
            times=times,
            impacts=found.time[made],
            speeds=found.column("impact_speed")[made],
        )

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
        found = Landmarks.of(rows, begin, end, most)
        begins, ends, times = found.lasting(LandmarkKind.STICK, LandmarkKind.SLIP)
        breakaways, distance = np.flatnonzero(found.kind == LandmarkKind.SLIP), found.column("distance")
        slipped = breakaways[breakaways + 1 < distance.size]
        return cls(
            stick_begin=begins,
            stick_end=ends,
            stick_times=times,
            slip_lengths=distance[slipped + 1] - distance[slipped],
        )
