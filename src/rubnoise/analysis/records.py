"""Figures taken from a record, each with its standard error, or a refusal that says how long the record should be."""

from dataclasses import dataclass
from math import isfinite

from rubnoise.errors import Refused


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A number taken from a record and its standard error, both in the unit of the quantity."""

    value: float
    standard_error: float


class RecordTooShort(Refused):
    """A record from which a number can be taken, but not defended; the number is in ``estimate`` all the same.

    ``length`` and ``needed`` are sliding distances in um; needed is inf where no length would do.
    """

    def __init__(self, what: str, estimate: object, *, length: float, needed: float) -> None:
        """Keep the number, and how long the record is and should be."""
        super().__init__(what, estimate, length, needed)
        self.what = what
        self.estimate = estimate
        self.length = length
        self.needed = needed

    def __str__(self) -> str:
        """Say what cannot be defended, and from which length on it can."""
        told = f"{self.what}: {self.length:.6g} um of sliding are too short for it"
        return f"{told}; it needs about {self.needed:.3g} um" if isfinite(self.needed) else told


def longer(length: float, error: float, largest_error: float) -> float:
    """Return the length in um at which a standard error falls to another: it falls as 1/sqrt(length)."""
    return length * (error / largest_error) ** 2
