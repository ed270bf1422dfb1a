"""Sticks and slips of a two-way slider, from its landmarks: when and how long it stands, and how far it then slides."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows
from rubnoise.record.rows import LandmarkKind


@dataclass(frozen=True, slots=True, kw_only=True)
class StickSlip:
    """Sticks and slips between two times of a run.

    stick_begin, stick_end: every stick in s, cut off at the two times; stick_times: how long those last that begin and
    end between them, in s; slip_lengths: how far those slips go, in um, from a breakaway to the next stick or turn.
    """

    stick_begin: Doubles
    stick_end: Doubles
    stick_times: Doubles
    slip_lengths: Doubles

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the sticks and slips of a two-way run between two times in s, of ``most`` landmarks at most."""
        first, last = first_landmark(rows, begin), first_landmark(rows, end)
        if most is not None and last - first > most:
            last = first + most
            end = float(rows.column("landmarks", "time", last, last + 1)[0])
        kind, time, distance = (rows.column("landmarks", name, first, last) for name in ("kind", "time", "distance"))
        sticks, breakaways = np.flatnonzero(kind == LandmarkKind.STICK), np.flatnonzero(kind == LandmarkKind.SLIP)
        ended, slipped = (some[some + 1 < kind.size] for some in (sticks, breakaways))
        stands = bool(kind.size and kind[0] == LandmarkKind.SLIP) or (not kind.size and stands_at(rows, begin))
        return cls(
            stick_begin=np.concatenate([[begin] * stands, time[sticks]]),
            stick_end=np.concatenate([[time[0] if kind.size else end] * stands, np.append(time, end)[sticks + 1]]),
            stick_times=time[ended + 1] - time[ended],
            slip_lengths=distance[slipped + 1] - distance[slipped],
        )


def stands_at(rows: Rows, time: float) -> bool:
    """Return whether a two-way slider stands at a time in s: whether the last landmark before it is a stick."""
    last = first_landmark(rows, time) - 1
    return last >= 0 and bool(rows.column("landmarks", "kind", last, last + 1)[0] == LandmarkKind.STICK)


def first_landmark(rows: Rows, time: float) -> int:
    """Return the first landmark at or after a time in s, or their number where there is none."""
    low, high = 0, rows.rows("landmarks")
    while low < high:
        middle = (low + high) // 2
        if rows.column("landmarks", "time", middle, middle + 1)[0] < time:
            low = middle + 1
        else:
            high = middle
    return low
