"""The findings of a verification: each check with the number of its values, and the first wrong place.

Notes are taken from chunks of columns: the number of values, how many differ, and the place of the first one.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.answer import Answer, LeftOut


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """A wrong value in a file: its place, the value, and the right one, in words or with all digits.

    ``row`` is None for an attribute, or for a column as a whole.
    """

    place: str
    row: int | None
    found: str
    expected: str

    def __str__(self) -> str:
        """Return the place with both values, on one line."""
        row = "" if self.row is None else f" row {self.row}"
        verb = "" if self.found.startswith(("is ", "has ")) else "is "  # which reasons of a refusal begin with
        return f"{self.place}{row} {verb}{self.found}, should be {self.expected}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One check, which every correct file passes: how many values it compared, and how many differ."""

    name: str
    values: int
    different: int = 0
    first: Difference | None = None

    @property
    def holds(self) -> bool:
        """Whether no value differs."""
        return self.different == 0


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Verification(Answer):
    """A result checked against its own hashes, rows and scenario, one row per check, in the order of ``checks``.

    ``passed`` is true if every value is right; ``left_out`` names the checks that could not be made, with the reason;
    ``remark`` says what may explain a difference.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     answer = run.verify()
    >>> answer.passed, answer.rows[0]["check"], answer.rows[0]["different"]
    (True, 'hashes', 0)
    """

    names: ClassVar = ("check", "values", "different", "first_difference")
    checks: tuple[Check, ...]
    omitted: tuple[LeftOut, ...] = ()
    remark: str = ""
    heading: str = ""

    @property
    def different(self) -> list[Check]:
        """The checks with differences."""
        return [check for check in self.checks if not check.holds]

    @property
    def failing(self) -> tuple[str, ...]:
        """Names of the checks with differences."""
        return tuple(check.name for check in self.different)

    @property
    def values(self) -> int:
        """Number of values of all checks together."""
        return sum(check.values for check in self.checks)

    @property
    def rows(self) -> tuple[Mapping[str, Any], ...]:
        """One row per check: the number of its values, how many differ, and the first of these."""
        rows = ((each.name, each.values, each.different, str(each.first or "")) for each in self.checks)
        return tuple(dict(zip(self.names, row, strict=True)) for row in rows)

    @property
    def _counts(self) -> str:
        return f"{len(self.checks)} checks of {self.values:,} values"


Mask = NDArray[np.bool_]


class Notes:
    """The notes of one check. Rows of several columns may come in any order; the first different row is kept."""

    def __init__(self, name: str, of: str = "") -> None:
        """Start a check; ``of`` is the file of its places, if there are several files."""
        self._name = name
        self._of = f"{of} " if of else ""
        self._values = 0
        self._different = 0
        self._first: Difference | None = None

    def equal(self, place: str, first_row: int, found: NDArray[Any], expected: ArrayLike) -> None:
        """Note rows of a column that differ in any bit: -0 differs from 0, and nan equals nan."""
        right = np.broadcast_to(np.asarray(expected).astype(found.dtype, copy=False), found.shape)
        self._note(place, first_row, bits(found) == bits(right), found, lambda row: shown(right[row]))

    def near(self, place: str, first_row: int, found: NDArray[Any], expected: NDArray[Any], allowed: ArrayLike) -> None:
        """Note rows of a column that are farther than allowed from their right values."""
        limit = np.broadcast_to(np.asarray(allowed, dtype=np.float64), found.shape)
        with np.errstate(invalid="ignore", over="ignore"):
            right = np.abs(found - expected) <= limit
        self._note(
            place, first_row, right, found, lambda row: f"{shown(expected[row])}, give or take {float(limit[row]):.2g}"
        )

    def holds(self, place: str, first_row: int, found: NDArray[Any], right: Mask, expected: str) -> None:
        """Note rows of a column for which a sentence is not true."""
        self._note(place, first_row, right, found, lambda _: expected)

    def say(self, place: str, *, found: object, expected: object) -> None:
        """Note one value without a row; it differs unless both are equal."""
        self._values += 1
        if found != expected:
            self._different += 1
            self._keep(Difference(place=f"{self._of}{place}", row=None, found=str(found), expected=str(expected)))

    def check(self) -> Check:
        """Return the check with all notes."""
        return Check(name=self._name, values=self._values, different=self._different, first=self._first)

    def _note(self, place: str, first_row: int, right: Mask, found: NDArray[Any], expected: Any) -> None:
        self._values += found.size
        if right.all():
            return
        row = int(np.argmin(right))
        self._different += int(found.size - np.count_nonzero(right))
        self._keep(
            Difference(
                place=f"{self._of}{place}", row=first_row + row, found=shown(found[row]), expected=expected(row)
            ),
        )

    def _keep(self, difference: Difference) -> None:
        kept = self._first
        if kept is None or _row(difference) < _row(kept):
            self._first = difference


def bits(values: NDArray[Any]) -> NDArray[np.unsignedinteger[Any]]:
    """Return the bits of numbers as unsigned integers of their width."""
    return np.ascontiguousarray(values).view(f"u{values.dtype.itemsize}")


def shown(value: Any) -> str:
    """Return a number with all of its digits."""
    return repr(value.item())


def _row(difference: Difference) -> int:
    return -1 if difference.row is None else difference.row
