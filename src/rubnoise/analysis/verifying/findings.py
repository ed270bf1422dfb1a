"""What a verification finds: each check with what it looked at, and the first place that is not as it should be."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """A place in a file that is not what it should be: what stands there and what should, in words or all digits.

    ``row`` is None for what has no rows, such as an attribute or a column as a whole.
    """

    place: str
    row: int | None
    found: str
    expected: str

    def __str__(self) -> str:
        """Return the place with both values, on one line."""
        row = "" if self.row is None else f" row {self.row}"
        return f"{self.place}{row} is {self.found}, should be {self.expected}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One thing that holds in every right file: how many values it was asked of, and of how many it does not hold."""

    name: str
    values: int
    different: int = 0
    first: Difference | None = None

    @property
    def holds(self) -> bool:
        """Whether nothing is different."""
        return self.different == 0


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOut:
    """A check that could not be made, or only in part, and why."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """Everything that a file was asked, in the order in which it was asked, and what was left out."""

    checks: tuple[Check, ...]
    left_out: tuple[LeftOut, ...] = ()

    @property
    def different(self) -> list[Check]:
        """The checks that do not hold."""
        return [check for check in self.checks if not check.holds]

    @property
    def values(self) -> int:
        """How many values checked in all checks together."""
        return sum(check.values for check in self.checks)
