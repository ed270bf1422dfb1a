"""The landmarks of a run between two times, and how long what begins at one of them lasts."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows


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
        """Return the landmarks between two times in s; of more than ``most`` the first, up to the time of the next."""
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
        """Return what begins at one kind of landmark and lasts until the next one, in s.

        Begin and end of each, cut off at the two times, and how long those last that lie between them as a whole.
        ``ends`` is the kind that shows as the first landmark that something has begun before it.
        """
        at = np.flatnonzero(self.kind == begins)
        whole = at[at + 1 < self.kind.size]
        before = self.kind[0] == ends if self.kind.size else self._kind_before() == begins
        return (
            np.concatenate([[self.begin] * bool(before), self.time[at]]),
            np.concatenate([[self.time[0] if self.kind.size else self.end] * bool(before), self._next(at)]),
            self.time[whole + 1] - self.time[whole],
        )

    def _next(self, at: NDArray[np.intp]) -> Doubles:
        return np.append(self.time, self.end)[at + 1]

    def _kind_before(self) -> int | None:
        if self.first == 0:
            return None
        return int(self.rows.column("landmarks", "kind", self.first - 1, self.first)[0])


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
