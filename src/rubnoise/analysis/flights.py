"""Flights and impacts of a slider that may leave its contact, from its landmarks: when it is off, how hard it falls."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from rubnoise.analysis.stick_slip import first_landmark
from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows
from rubnoise.record.rows import ContactKind


@dataclass(frozen=True, slots=True, kw_only=True)
class Flights:
    """Flights and impacts between two times of a run.

    begin, end: every flight in s, from contact lost to contact made, cut off at the two times; times: how long those
    last that begin and end between them, in s; impacts, speeds: when contact is made, in s, and how fast the
    overlap then grows, by sliding and by falling, in um/s.
    """

    begin: Doubles
    end: Doubles
    times: Doubles
    impacts: Doubles
    speeds: Doubles

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the flights of a free run between two times in s, of ``most`` landmarks at most."""
        first, last = first_landmark(rows, begin), first_landmark(rows, end)
        if most is not None and last - first > most:
            last = first + most
            end = float(rows.column("landmarks", "time", last, last + 1)[0])
        kind, time, speed = (rows.column("landmarks", name, first, last) for name in ("kind", "time", "impact_speed"))
        made, lost = kind == ContactKind.CONTACT_MADE, np.flatnonzero(kind == ContactKind.CONTACT_LOST)
        off = bool(made[0]) if kind.size else _is_off(rows, first)
        landed = lost[lost + 1 < kind.size]
        return cls(
            begin=np.concatenate([[begin] * off, time[lost]]),
            end=np.concatenate([[time[0] if kind.size else end] * off, np.append(time, end)[lost + 1]]),
            times=time[landed + 1] - time[landed],
            impacts=time[made],
            speeds=speed[made],
        )

    def share(self, begin: float, end: float) -> float:
        """Return the share of the time from one to the other, in s, that the slider is off the surface."""
        return float((self.end - self.begin).sum()) / (end - begin)


def _is_off(rows: Rows, landmark: int) -> bool:
    """Return whether the slider is off the surface just before a landmark: whether the last one lost contact."""
    if landmark == 0:
        return False
    return bool(rows.column("landmarks", "kind", landmark - 1, landmark)[0] == ContactKind.CONTACT_LOST)
