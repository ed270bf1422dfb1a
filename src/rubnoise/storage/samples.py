"""Columns of samples, and the checks of what is used of them: even steps, possible values."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, NoReturn

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.storage.text_heads import Head
from rubnoise.units import LENGTH, TIME, unit_or_one

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
class Source:
    """Columns by number, in memory, or read when they are needed (`TextTable`).

    ``step`` and what it is ``along`` say how samples lie where no column does; ``word`` and ``first`` how rows are
    called, ``missing`` what nan means in a column, ``unnamed`` in which line columns without names begin.
    """

    path: Any
    heads: Sequence[Head]
    arrays: Sequence[Doubles] = ()
    step: float | None = None
    along: str = "time"
    notes: tuple[str, ...] = ()
    word: str = "row"
    first: int = 1
    missing: Mapping[int, str] = field(default_factory=dict)
    of_file: bool = False
    unnamed: str = ""

    @property
    def where(self) -> str:
        """The file, and where the names stand in it."""
        return str(self.path)

    @property
    def usable(self) -> Sequence[int]:
        """The columns that have numbers."""
        return range(len(self.heads))

    def columns(self, numbers: Sequence[int]) -> list[Doubles]:
        """Return columns, nan where no number stands."""
        return [self.arrays[number] for number in numbers]

    def place(self, row: int) -> str:
        """Return the words for a row."""
        return f"{self.word} {row + self.first:,}"

    def wrong(self, row: int, number: int) -> str:
        """Say why a value is nan."""
        meant = f"[{row}] is {self.missing[number]}" if number in self.missing else " is nan"
        return f"{self.heads[number].name}{meant}; every sample needs a number"


def even_step(source: Source, number: int, places: Doubles, first: int = 0) -> float:
    """Return the mean step in s or um; raises Refused, with the line, if a step is not the usual one.

    A step may be 1 % off, and one digit of the places, since they are rounded. If the step is one digit, and nearly all
    steps are equal, a longer one is a missing row and not rounding.
    """
    head, steps = source.heads[number], np.diff(places)
    usual = float(np.median(steps))
    if usual <= 0.0:
        hint = 'if it is rounded, rate="10 kHz" says how often it was sampled'
        raise Refused(f"{source.path}: {head.name} does not grow from line to line; {hint}")
    digit, uneven = _digit(places), UNEVEN * usual
    few = np.count_nonzero(np.abs(steps - usual) > uneven) <= max(3, 0.01 * steps.size)
    allowed = uneven if digit > 0.5 * usual and few else uneven + 1.01 * digit
    wrong = ~(np.abs(steps - usual) <= allowed)
    if wrong.any():
        row = first + int(np.argmax(wrong)) + 1
        grown = f"{head.name} grows by {steps[row - first - 1]:g} {head.unit} where the usual step is {usual:g}"
        _refuse(source, row, f'{grown}; samples have to be evenly spaced; to="{row}" ends before it')
    return float(places[-1] - places[0]) / steps.size * float(unit_or_one(head.unit).size)


def _digit(places: Doubles) -> float:
    """Return the last decimal with which places are written, from both ends; 0 if they have no last one."""
    digits = 10.0 ** np.arange(3.0, -13.0, -1.0)
    found = []
    for part in (places[:50], places[-50:]):
        in_digits = part / digits[:, None]
        error = 4.0 * np.finfo(np.float64).eps * float(np.abs(part).max()) / digits
        fits = np.abs(in_digits - np.rint(in_digits)).max(axis=1) <= 1e-6 + error
        found.append(digits[fits & (digits <= np.ptp(part))].max(initial=0.0))
    return float(max(found))


def check_values(source: Source, number: int, values: Doubles, first: int = 0) -> None:
    """Raise Refused with the first value that is not finite, or too large to be squared."""
    wrong = ~(np.abs(values) <= LARGEST_VALUE)
    if not wrong.any():
        return
    row = int(np.argmax(wrong))
    limit = "every sample needs a number" if np.isinf(values[row]) else f"up to {LARGEST_VALUE:g} is read"
    said = f"{source.heads[number].name} is {values[row]:g}; {limit}"
    said = source.wrong(first + row, number) if np.isnan(values[row]) else said
    _refuse(source, first + row, said + (f'; to="{first + row}" ends before it' if source.of_file and row > 1 else ""))


def check_reach(source: Source, number: int, values: Doubles, first: int = 0) -> None:
    """Raise Refused with the first value that is far from the others and alone: a filled gap, an overload.

    Junctions pass over several samples, so that one or two that leap are not theirs, nor are more of one value.
    """
    away = np.abs(values - np.median(values))
    reach = float(np.quantile(away[:: away.size // _SEEN + 1], 0.99))
    far = np.flatnonzero(away > _FAR * reach)
    if reach == 0.0 or not far.size:
        return
    for run in np.split(far, np.flatnonzero(np.diff(far) > 1) + 1):
        if run.size <= 2 or np.ptp(values[run]) == 0.0:
            head, others = source.heads[number], values[away <= _FAR * reach]
            usual = f"{others.min():.4g} to {others.max():.4g} {head.unit}"
            said = f"{head.name} is {values[run[0]]:g}, far outside of the other values, {usual}"
            _refuse(source, first + int(run[0]), f"{said}; mend or remove that row, or from_= and to= leave it out")


def _refuse(source: Source, row: int, said: str) -> NoReturn:
    raise Refused(f"{source.path}: {source.place(row)}: {said}" if source.path else f"{source.place(row)} of {said}")


def along_of(head: Head, *, named: bool = False) -> str:
    """Return "time" or "distance" for what places samples; empty for other columns.

    A length places samples by its name, such as `Weg`, or if it is ``named`` by the caller.
    """
    dimension = unit_or_one(head.unit).dimension
    last = re.split(r"[\s_]+", head.name.lower().strip(" ."))[-1].strip(".")
    travelled = dimension == LENGTH.dimension and (named or _TRAVELLED.fullmatch(last))
    return "time" if dimension == TIME.dimension else "distance" if travelled else ""


def column_of(source: Source, wanted: str, keyword: str) -> int:
    """Return the number of a column by its name, its name as written, or its number from 1 on; raises NoColumn."""
    names = [head.name for head in source.heads]
    for each in (names, [head.written for head in source.heads]):
        if each.count(wanted) == 1:
            return each.index(wanted)
    if re.fullmatch("[0-9]{1,9}", wanted) and 0 < int(wanted) <= len(names):
        return int(wanted) - 1
    what = "the name of several" if wanted in names else "none"
    raise NoColumn(f"{source.path}: {keyword}=: {wanted[:_SHOWN]} is {what} of the columns {listed(names)}")


def listed(names: Sequence[str]) -> str:
    """Return some names, each cut short, and the number of further ones."""
    more = f" and {len(names) - 20:,} more" if len(names) > 20 else ""
    return ", ".join(name[:_SHOWN] for name in names[:20]) + more
