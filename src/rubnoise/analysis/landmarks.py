"""The landmarks of a run between two times, and the sticks, slips, flights and impacts that follow from them."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from rubnoise.analysis.selection import first_row
from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows
from rubnoise.record.rows import ContactKind, LandmarkKind
from rubnoise.record.sink import Columns


@dataclass(frozen=True, slots=True, kw_only=True)
class Spells:
    """What a slider does for a while, again and again, between two times of a run.

    begin, end: of each spell in s, cut off at the two times; times: the durations in s of those that begin and end
    between them; rows: the landmarks between them by column, of those that ``columns`` names.
    """

    begins: ClassVar[int]
    ends: ClassVar[int]
    columns: ClassVar[tuple[str, ...]]
    begin: Doubles
    end: Doubles
    times: Doubles
    rows: Columns

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the spells between two times in s; of more than ``most`` landmarks, up to the time of the next one.

        If the first landmark of a run ends a spell, this began with the run.
        """
        first, last = (first_row(rows, "landmarks", "time", each) for each in (begin, end))
        if most is not None and last - first > most:
            last = first + most
            end = float(rows.column("landmarks", "time", last, last + 1)[0])
        kind, time = (rows.column("landmarks", name, max(first - 1, 0), last) for name in ("kind", "time"))
        if first == 0:
            before = cls.begins if kind.size and kind[0] == cls.ends else -1
            kind, time = np.append(before, kind), np.append(begin, time)
        at = np.flatnonzero(kind == cls.begins)
        whole = at[(at > 0) & (at + 1 < kind.size)]
        return cls(
            begin=np.maximum(time[at], begin),
            end=np.append(time, end)[at + 1],
            times=time[whole + 1] - time[whole],
            rows={name: rows.column("landmarks", name, first, last) for name in cls.columns},
        )


class Flights(Spells):
    """Flights of a slider that may leave its contact, from contact lost to contact made, and its impacts."""

    __slots__ = ()
    begins, ends = ContactKind.CONTACT_LOST, ContactKind.CONTACT_MADE
    columns = ("kind", "time", "impact_speed")

    @property
    def impacts(self) -> Doubles:
        """The times in s when contact is made."""
        return np.asarray(self.rows["time"][self.rows["kind"] == self.ends])

    @property
    def speeds(self) -> Doubles:
        """The speeds in um/s at which the overlap then grows, by sliding and by falling."""
        return np.asarray(self.rows["impact_speed"][self.rows["kind"] == self.ends])

    def share(self, begin: float, end: float) -> float:
        """Return the share of the time from one to the other, in s, that the slider is off the surface."""
        return float((self.end - self.begin).sum()) / (end - begin)


class Sticks(Spells):
    """Sticks of a two-way slider, and the slips between them."""

    __slots__ = ()
    begins, ends = LandmarkKind.STICK, LandmarkKind.SLIP
    columns = ("kind", "time", "distance", "displacement")

    @property
    def slip_lengths(self) -> Doubles:
        """The distances in um from a breakaway to the next stick or turn."""
        slipped = np.flatnonzero(self.rows["kind"][:-1] == self.ends)
        return np.diff(self.rows["distance"])[slipped]
