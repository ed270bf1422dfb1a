"""Flights and impacts of a slider that may leave its contact, from its landmarks."""

from dataclasses import dataclass
from typing import Self

from rubnoise.analysis.landmarks import Landmarks
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
