"""A column of samples at even steps, which every reader of measured traces returns, and the checks that they share."""

import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NoReturn

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.units import LENGTH, TIME, QuantityError, parse_unit

UNEVEN: Final = 0.01
"""How far one step between samples may be from the mean step, in parts of it, beyond the digits that are written."""

_LISTED: Final = 20
_SHOWN: Final = 40
LARGEST_VALUE: Final = 1e60
"""Size of a value at most: fourth powers of values are numbers."""

_FEW: Final = 3
_ROUNDED: Final = 0.01
"""Part of the steps that differ from the usual one, above which they differ by rounding, not by some missing rows."""


class Lines:
    """The line of a file for each row of a column: kept only for rows at which the difference of both changes."""

    def __init__(self) -> None:
        """Start without rows."""
        self.count = 0
        self._first: list[int] = []
        self._ahead: list[int] = []

    def add(self, numbers: list[int]) -> None:
        """Add the line numbers of the next rows."""
        ahead = np.array(numbers) - np.arange(self.count, self.count + len(numbers))
        before = self._ahead[-1] if self._ahead else None
        changed = np.flatnonzero(np.diff(ahead)) + 1
        for row in ([0] if before != ahead[0] else []) + changed.tolist():
            self._first.append(self.count + row)
            self._ahead.append(int(ahead[row]))
        self.count += len(numbers)

    def of(self, row: int) -> int:
        """Return the line of a row."""
        return row + self._ahead[bisect_right(self._first, row) - 1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """One column of values at even steps: ``step`` in s, or in um if ``along`` is "distance"; None if unknown.

    ``unit`` is as written, empty if the file has none; ``where`` names the file, and the line of the names;
    ``lines`` says which line each value is from, None if values have none.
    """

    name: str
    values: Doubles = field(repr=False)
    unit: str
    step: float | None
    along: str
    where: str = ""
    lines: "Lines | None" = field(default=None, repr=False)

    def place(self, sample: int) -> str:
        """Return the file and line of a sample."""
        return f"sample {sample + 1:,}" if self.lines is None else f"line {self.lines.of(sample)}"


def along_of(name: str, unit: str) -> str:
    """Return "time" or "distance" for what places samples; empty for other columns."""
    try:
        dimension = parse_unit(unit).dimension if name and unit else None
    except QuantityError:
        return ""
    if dimension is None:
        return ""
    if dimension == TIME.dimension:
        return "time"
    travelled = name.lower().split()[-1].split("_")[-1] in {"distance", "position", "s"}
    return "distance" if dimension == LENGTH.dimension and travelled else ""


def chosen_column(
    path: str | Path, names: list[str], wanted: str | None, place: int | None, *, keyword: str = "column"
) -> int:
    """Return the number of the wanted column, or of the only one beside time or distance; raises NoColumn otherwise.

    ``wanted`` is a name, or a number from 1 on if no column has that name.
    """
    if wanted is not None:
        if names.count(wanted) == 1:
            return names.index(wanted)
        if re.fullmatch("[0-9]{1,9}", wanted) and 0 < int(wanted) <= len(names):
            return int(wanted) - 1
        what = "the name of several" if wanted in names else "none"
        raise NoColumn(f"{path}: {keyword}=: {wanted[:_SHOWN]} is {what} of the columns {_listed(names)}")
    others = [name for number, name in enumerate(names) if number != place]
    if len(others) != 1:
        raise NoColumn(f"{path}: which column? column= takes one of: {_listed(others) or 'none but the place'}")
    return next(number for number in range(len(names)) if number != place)


def _listed(names: list[str]) -> str:
    """Return some names, each cut short, and the number of further ones."""
    more = f" and {len(names) - _LISTED:,} more" if len(names) > _LISTED else ""
    return ", ".join(name[:_SHOWN] for name in names[:_LISTED]) + more


class EvenSteps:
    """Times or distances of samples, taken in pieces; those not at even steps are refused with their line.

    With a ``rate`` in Hz, with which they must agree, times may be written with too few digits to differ.
    """

    def __init__(self, name: str, unit: str, path: str, rate: float | None = None, *, word: str = "line") -> None:
        """Take the column's name, its unit, its file, and what the numbers mean: lines or rows."""
        self._name, self._unit, self._path, self._word = name, unit, path, word
        self._size = _size_of(unit)
        if rate is not None and along_of(name, unit) != "time":
            raise Refused(f"rate=: the trace is over {name}, which says how its samples lie")
        self._given = None if rate is None else 1.0 / (rate * self._size)
        self._usual = self._tolerance = 0.0
        self._first = self._last = 0.0
        self._count = 0

    def add(self, places: Doubles, numbers: Sequence[int], resolution: float = 0.0) -> None:
        """Add the next places, the line of each, and their last decimal; the usual step is that of the first piece."""
        check_values(places, f"{self._path}: {self._name}", lambda row: f"{self._word} {numbers[row]}")
        steps = np.diff(places, prepend=self._last if self._count else places[0])
        own = steps[1:] if self._count == 0 else steps
        if self._usual == 0.0 and own.size:
            self._begin(own, resolution)
        off = np.abs(own - self._usual) > self._tolerance
        if off.any():
            row = int(np.argmax(off))
            raise Refused(
                f"{self._path}: {self._word} {numbers[row + steps.size - own.size]}: {self._name} grows by {own[row]:g}"
                f" {self._unit} where the usual step is {self._usual:g}; samples have to be evenly spaced"
            )
        if self._count == 0:
            self._first = float(places[0])
        self._last = float(places[-1])
        self._count += places.size

    def _begin(self, steps: Doubles, resolution: float) -> None:
        self._usual = float(np.median(steps))
        if self._given is not None:
            self._tolerance = UNEVEN * self._given + 1.01 * resolution
            if abs(self._usual - self._given) > self._tolerance:
                self._refuse_rate(self._usual)
            self._usual = self._given
            return
        if self._usual <= 0.0:
            rounded = '; if it is rounded, rate="10 kHz" says how often it was sampled' if self._usual == 0.0 else ""
            raise Refused(f"{self._path}: {self._name} does not grow from {self._word} to {self._word}{rounded}")
        self._tolerance = self._allowed(steps, resolution)

    def _allowed(self, steps: Doubles, resolution: float) -> float:
        """Return how far a step may be from the usual one: 1 %, and one digit of the places, since they are rounded.

        If the step is one digit, and nearly all steps are equal, a longer one is a missing row and not rounding.
        """
        uneven = UNEVEN * self._usual
        rounded = np.count_nonzero(np.abs(steps - self._usual) > uneven) > max(_FEW, _ROUNDED * steps.size)
        return uneven if resolution > 0.5 * self._usual and not rounded else uneven + 1.01 * resolution

    def step(self) -> float:
        """Return the mean step in s or um (or in the unit of the places); it agrees with a given rate within 1 %."""
        if self._count < 2:
            raise Refused(f"{self._path}: {self._name} has {self._count} rows; a trace has two or more")
        mean = (self._last - self._first) / (self._count - 1)
        if self._given is None:
            return mean * self._size
        if abs(mean - self._given) > UNEVEN * self._given + 2.0 * self._tolerance / (self._count - 1):
            self._refuse_rate(mean)
        return self._given * self._size

    def _refuse_rate(self, step: float) -> NoReturn:
        says = f"{1.0 / (step * self._size):.6g} Hz" if step > 0.0 else "none"
        raise Refused(
            f"rate=: {self._path}: by its {self._name} the rate is {says}; leave rate= out, or mend the column"
        )


def _size_of(unit: str) -> float:
    """Return the size of a unit in s or um; 1 for an unknown unit."""
    try:
        return float(parse_unit(unit).size)
    except QuantityError:
        return 1.0


def even_step(places: Doubles, name: str, unit: str, path: str, *, first: int = 1) -> float:
    """Return the step in s or um; raises Refused, with rows counted from ``first``, if places are not at even steps."""
    steps = EvenSteps(name, unit, path, word="row")
    if places.size > 1:
        steps.add(places, range(first, first + places.size))
    return steps.step()


def check_values(values: Doubles, what: str, place: Callable[[int], str] | None = None) -> None:
    """Raise Refused with the first value that is not finite, or too large to be squared.

    ``place`` returns the words for a value, by default its number.
    """
    wrong = ~(np.abs(values) <= LARGEST_VALUE)
    if wrong.any():
        row = int(np.argmax(wrong))
        where = f"value {row + 1:,}" if place is None else place(row)
        which = "every sample needs a number" if not np.isfinite(values[row]) else f"up to {LARGEST_VALUE:g} is read"
        path, _, name = what.rpartition(": ")
        raise Refused(
            f"{path}: {where}: {name} is {values[row]:g}; {which}"
            if path
            else f"{where} of {name} is {values[row]:g}; {which}"
        )
