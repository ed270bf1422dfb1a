"""Columns of samples, in memory or in a text, and the checks of what is used: even steps, possible values."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Final, NoReturn

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.storage.text_heads import Head
from rubnoise.storage.text_table import TextTable
from rubnoise.units import LENGTH, TIME, QuantityError, Unit, parse_unit

LARGEST_VALUE: Final = 1e60
"""Size of a value at most: fourth powers of values are numbers."""

UNEVEN: Final = 0.01
"""How far one step between samples may be from the usual one, in parts of it, beyond the digits that are written."""

_TRAVELLED: Final = re.compile(r"distance|dist|position|pos|[a-z]*weg|strecke|path|travel|track|s|x")
_SHOWN: Final = 40
_SEEN: Final = 1 << 20
_FAR: Final = 20.0
"""Times the reach of 99 % of the values from the median, above which one value is no part of a trace."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """Columns in memory; ``word`` and ``first`` say how rows are called, ``missing`` what nan means in a column."""

    path: Any
    heads: Sequence[Head]
    arrays: Sequence[Doubles]
    step: float | None = None
    along: str = "time"
    notes: tuple[str, ...] = ()
    word: str = "row"
    first: int = 1
    missing: dict[int, str] = field(default_factory=dict)
    of_file: bool = False

    @property
    def where(self) -> str:
        """The file."""
        return str(self.path)

    @property
    def usable(self) -> list[bool]:
        """All columns have numbers."""
        return [True] * len(self.heads)

    def columns(self, numbers: Sequence[int], most: int | None = None) -> list[Doubles]:  # noqa: ARG002
        """Return columns."""
        return [self.arrays[number] for number in numbers]

    def place(self, row: int) -> str:
        """Return the words for a row."""
        return f"{self.word} {row + self.first:,}"

    def wrong(self, row: int, number: int) -> str:
        """Say why a value is nan."""
        if number in self.missing:
            return f"{self.heads[number].name}[{row}] is {self.missing[number]}; every sample needs a number"
        return f"{self.heads[number].name} is nan; every sample needs a number"


Source = Held | TextTable
"""What has columns by number: those of a file of text are read when they are needed."""


def even_step(source: Source, number: int, places: Doubles, first: int = 0) -> float:
    """Return the mean step in s or um; raises Refused, with the line, if a step is not the usual one.

    A step may be 1 % off, and one digit of the places, since they are rounded. If the step is one digit, and nearly all
    steps are equal, a longer one is a missing row and not rounding.
    """
    head, path = source.heads[number], source.path
    steps = np.diff(places)
    usual = float(np.median(steps))
    if usual <= 0.0:
        hint = 'if it is rounded, rate="10 kHz" says how often it was sampled'
        raise Refused(f"{path}: {head.name} does not grow from line to line; {hint}")
    digit, uneven = _digit(places), UNEVEN * usual
    few = np.count_nonzero(np.abs(steps - usual) > uneven) <= max(3, 0.01 * steps.size)
    allowed = uneven if digit > 0.5 * usual and few else uneven + 1.01 * digit
    if (wrong := ~(np.abs(steps - usual) <= allowed)).any():
        row = int(np.argmax(wrong))
        raise Refused(
            f"{path}: {source.place(first + row + 1)}: {head.name} grows by {steps[row]:g} {head.unit} where the usual"
            f' step is {usual:g}; samples have to be evenly spaced; to="{first + row + 1}" ends before it'
        )
    return float(places[-1] - places[0]) / steps.size * float(unit_of(head.unit).size)


def _digit(places: Doubles) -> float:
    """Return the last decimal with which places are written, from both ends; 0 if they have no last one."""
    found = []
    for part in (places[:50], places[-50:]):
        error = 4.0 * np.finfo(np.float64).eps * float(np.abs(part).max())
        powers = [10.0**-power for power in range(-3, 13) if np.ptp(part) >= 10.0**-power]
        off = [float(np.abs(part - digit * np.rint(part / digit)).max()) for digit in powers]
        found.append(
            next((digit for digit, each in zip(powers, off, strict=True) if each <= 1e-6 * digit + error), 0.0)
        )
    return max(found)


def check_values(source: Source, number: int, values: Doubles, first: int = 0) -> None:
    """Raise Refused with the first value that is not finite, or too large to be squared."""
    wrong = ~(np.abs(values) <= LARGEST_VALUE)
    if not wrong.any():
        return
    row = int(np.argmax(wrong))
    name, value = source.heads[number].name, values[row]
    limit = "every sample needs a number" if np.isinf(value) else f"up to {LARGEST_VALUE:g} is read"
    said = source.wrong(first + row, number) if np.isnan(value) else f"{name} is {value:g}; {limit}"
    _refuse(source, first + row, said)


def check_reach(source: Source, number: int, values: Doubles, first: int = 0) -> None:
    """Raise Refused with the first value that is far from the others and alone: a filled gap, an overload.

    Junctions pass over several samples, so that one or two that leap are not theirs, nor are more of one value.
    """
    median = float(np.median(values))
    away = np.abs(values - median)
    reach = float(np.quantile(away[:: away.size // _SEEN + 1], 0.99))
    far = np.flatnonzero(away > _FAR * reach)
    if reach == 0.0 or not far.size:
        return
    for run in np.split(far, np.flatnonzero(np.diff(far) > 1) + 1):
        if run.size <= 2 or np.ptp(values[run]) == 0.0:
            head, row = source.heads[number], int(run[0])
            others = values[away <= _FAR * reach]
            said = (
                f"{head.name} is {values[row]:g}, far outside of the other values, {others.min():.4g} to"
                f" {others.max():.4g} {head.unit}; mend or remove that row, or from_= and to= leave it out"
            )
            _refuse(source, first + row, said)


def _refuse(source: Source, row: int, said: str) -> NoReturn:
    raise Refused(f"{source.path}: {source.place(row)}: {said}" if source.path else f"{source.place(row)} of {said}")


def along_of(head: Head, *, named: bool = False) -> str:
    """Return "time" or "distance" for what places samples; empty for other columns.

    A length places samples by its name, such as `Weg`, or if it is ``named`` by the caller.
    """
    dimension = unit_of(head.unit).dimension
    last = re.split(r"[\s_]+", head.name.lower().strip(" ."))[-1].strip(".")
    travelled = dimension == LENGTH.dimension and (named or _TRAVELLED.fullmatch(last))
    return "time" if dimension == TIME.dimension else "distance" if travelled else ""


def unit_of(text: str) -> Unit:
    """Return a unit in s, um and so on; one of size 1 without a dimension for none, and for an unknown one."""
    with suppress(QuantityError):
        return parse_unit(text)
    return Unit(Fraction(1), ())


def column_of(source: Source, wanted: str, keyword: str) -> int:
    """Return the number of a column by its name, its name as written, or its number from 1 on; raises NoColumn."""
    for names in ([head.name for head in source.heads], [head.written for head in source.heads]):
        if names.count(wanted) == 1:
            return names.index(wanted)
    names = [head.name for head in source.heads]
    if re.fullmatch("[0-9]{1,9}", wanted) and 0 < int(wanted) <= len(names):
        return int(wanted) - 1
    what = "the name of several" if wanted in names else "none"
    raise NoColumn(f"{source.path}: {keyword}=: {wanted[:_SHOWN]} is {what} of the columns {listed(names)}")


def listed(names: list[str]) -> str:
    """Return some names, each cut short, and the number of further ones."""
    more = f" and {len(names) - 20:,} more" if len(names) > 20 else ""
    return ", ".join(name[:_SHOWN] for name in names[:20]) + more


@contextmanager
def refusing_files(path: object) -> Iterator[None]:
    """Turn an OSError about a file into a refusal that names the file."""
    try:
        yield
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise Refused(f"{path}: {reason[:1].lower()}{reason[1:]}") from problem
