"""One column of samples at even steps, as every reader of measured traces returns it, and the checks they share."""

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.units import LENGTH, TIME, QuantityError, parse_unit

UNEVEN: Final = 0.01
"""How far one step between samples may be from the mean step, in parts of it, beyond the digits that are written."""

_LISTED: Final = 20
_SHOWN: Final = 40
_ROUNDED: Final = 0.01
"""Part of the steps that differ from the usual one, above which they differ by rounding."""


class Lines:
    """Which line of a file each row of a column is from: kept where the two part, not for each row."""

    def __init__(self) -> None:
        """Begin with no rows."""
        self.count = 0
        self._first: list[int] = []
        self._ahead: list[int] = []

    def add(self, numbers: list[int]) -> None:
        """Take the line numbers of the next rows."""
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
    """One column of values at even steps: ``step`` in s, or in um where ``along`` is "distance"; None where unknown.

    ``unit`` is as written, empty where the file has none; ``where`` names the file, and the line of the names;
    ``lines`` says which line each value is from, None where values have none.
    """

    name: str
    values: Doubles = field(repr=False)
    unit: str
    step: float | None
    along: str
    where: str = ""
    lines: "Lines | None" = field(default=None, repr=False)

    def place(self, sample: int) -> str:
        """Return where a sample stands in its file."""
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


def chosen_column(path: str | Path, names: list[str], wanted: str | None, place: int | None) -> int:
    """Return the number of the wanted column, or of the only one beside the place; raises Refused where it is open.

    ``wanted`` is a name, or where no column has that name a number from 1 on.
    """
    if wanted is not None:
        if names.count(wanted) == 1:
            return names.index(wanted)
        if re.fullmatch("[0-9]{1,9}", wanted) and 0 < int(wanted) <= len(names):
            return int(wanted) - 1
        what = "the name of several" if wanted in names else "none"
        raise Refused(f"{path}: column=: {wanted[:_SHOWN]} is {what} of the columns {_listed(names)}")
    others = [name for number, name in enumerate(names) if number != place]
    if len(others) != 1:
        raise Refused(f"{path}: which column? column= takes one of: {_listed(others) or 'none but the place'}")
    return next(number for number in range(len(names)) if number != place)


def _listed(names: list[str]) -> str:
    """Return names, each cut short, and how many more there are."""
    more = f" and {len(names) - _LISTED:,} more" if len(names) > _LISTED else ""
    return ", ".join(name[:_SHOWN] for name in names[:_LISTED]) + more


class EvenSteps:
    """Places of samples, taken in pieces and refused with the line where they are not even."""

    def __init__(self, head: tuple[str, str], path: Path, resolution: float) -> None:
        """Name the column, its file and the last decimal with which places are written."""
        self._head, self._path, self._resolution = head, path, resolution
        self._usual = self._tolerance = 0.0
        self._first = self._last = 0.0
        self._count = 0

    def add(self, places: Doubles, lines: Sequence[int]) -> None:
        """Take the next places, and the line of each; the usual step is that of the first piece."""
        name, unit = self._head
        if not np.isfinite(places).all():
            raise Refused(f"{self._path}: line {lines[int(np.argmin(np.isfinite(places)))]}: {name} is no number")
        steps = np.diff(places, prepend=self._last if self._count else places[0])
        own = steps[1:] if self._count == 0 else steps
        if self._usual == 0.0 and own.size:
            self._usual = float(np.median(own))
            if self._usual <= 0.0:
                raise Refused(f"{self._path}: {name} does not grow from row to row")
            self._tolerance = self._allowed(own)
        off = np.abs(own - self._usual) > self._tolerance
        if off.any():
            row = int(np.argmax(off))
            raise Refused(
                f"{self._path}: line {lines[row + steps.size - own.size]}: {name} grows by {own[row]:g} {unit} where"
                f" the usual step is {self._usual:g}; samples have to be evenly spaced"
            )
        if self._count == 0:
            self._first = float(places[0])
        self._last = float(places[-1])
        self._count += places.size

    def _allowed(self, steps: Doubles) -> float:
        """Return how far a step may be from the usual one: 1 %, and a digit of the places, by which they are rounded.

        Where a step is a digit, and nearly all are equal, a longer one is a row that is missing and no rounding.
        """
        uneven = UNEVEN * self._usual
        rounded = float(np.mean(np.abs(steps - self._usual) > uneven)) > _ROUNDED
        return uneven if self._resolution > 0.5 * self._usual and not rounded else uneven + 1.01 * self._resolution

    def step(self) -> float:
        """Return the mean step in s or um."""
        return (self._last - self._first) / (self._count - 1) * float(parse_unit(self._head[1]).size)


def even_step(places: Doubles, head: tuple[str, str], path: Path) -> float:
    """Return the step in s or um; raises Refused where places are not even, as if each value had a line."""
    steps = EvenSteps(head, path, 0.0)
    steps.add(places, range(1, places.size + 1))
    return steps.step()


def check_finite(values: Doubles, what: str) -> None:
    """Raise Refused with the first value that is no number."""
    if not np.isfinite(values).all():
        raise Refused(f"{what}: value {int(np.argmin(np.isfinite(values))) + 1} is no number")
