"""Measured traces: which columns are used, which part of them, whether their steps are even and their values possible.

The part is cut first, and checked then. The caller must give a unit or rate that the file does not have.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, floor
from typing import Any, Final, NoReturn, Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.storage.text_heads import Head, check_unit
from rubnoise.units import FORCE, LENGTH, TIME, Quantity, unit_or_one

LARGEST_VALUE: Final = 1e60
"""Size of a value at most: fourth powers of values are numbers."""

UNEVEN: Final = 0.01
"""How far one step between samples may be from the usual one, in parts of it, beyond the digits that are written."""

_TRAVELLED: Final = re.compile(r"distance|dist|position|pos|[a-z]*weg|strecke|path|travel|track|s|x")
_UNITS: Final = {"time": "s", "t": "s", "zeit": "s", "distance": "um", "position": "um", "weg": "mm"}
_BACKWARD: Final = 0.1  # of the steps of what grows: a stage that goes to and fro has half of them
_FAR: Final = 20.0  # times the reach of 99 % of the values from the median: where one alone is no part of a trace
_SEEN: Final = 1 << 20
_SHOWN: Final = 40
_ROUNDING: Final = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What a caller says of a file: its columns, its rate in Hz, and the part from ``begin`` to ``end``.

    These are samples, from 1 on, or times or distances from the first one.
    """

    column: str | None = None
    place: str | None = None
    time: str | None = None
    rate: float | None = None
    begin: int | Quantity | None = None
    end: int | Quantity | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Columns by number, in memory, or read when they are needed (`TextTable`).

    ``step`` and what it is ``along`` say how samples lie, in s or, along a "distance", in um; 0 if unknown. Of a trace,
    see `measured`, ``used`` are its columns, ``placed`` is that of its places, ``begin`` the first row of its part.
    """

    path: Any
    heads: Sequence[Head]
    arrays: Mapping[int, Doubles] = field(default_factory=dict, repr=False)
    step: float = 0.0
    along: str = "time"
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    of_file: bool = False
    head_line: int = 0
    begin: int = 0
    used: Sequence[int] = ()
    placed: int | None = None

    @property
    def where(self) -> str:
        """The file, and the line of the names in it."""
        return f"{self.path}: line {self.head_line}" if self.head_line else str(self.path)

    @property
    def usable(self) -> Sequence[int]:
        """The columns that have numbers or times."""
        return [number for number, head in enumerate(self.heads) if head.kind]

    @property
    def head(self) -> Head:
        """Name and unit of the first column of a trace."""
        return self.heads[self.used[0]]

    @property
    def values(self) -> Doubles:
        """The first column of a trace."""
        return self.arrays[self.used[0]]

    def with_columns(self, numbers: Sequence[int]) -> Self:
        """Return a source that has some columns in memory, nan where no number stands."""
        return replace(self, arrays={number: self.arrays[number] for number in numbers})

    def place(self, row: int) -> str:
        """Return the words for a row."""
        return f"sample {self.begin + row + 1:,}"

    def wrong(self, row: int, number: int) -> str:
        """Say why a value is nan."""
        head = self.heads[number]
        meant = f"[{self.begin + row}] is {head.missing}" if head.missing else " is nan"
        return f"{head.name}{meant}; every sample needs a number"

    def refuse(self, row: int, said: str) -> NoReturn:
        """Raise Refused, which names the file and a row."""
        raise Refused(f"{self.path}: {self.place(row)}: {said}" if self.path else f"{self.place(row)} of {said}")


def measured(source: Source, asked: Asked, *, every: bool = False) -> Source:
    """Return a column of a source and its places, or ``every`` column, cut and checked; raises Refused with the line.

    With a rate, times are left out: they are known.
    """
    wanted = None if asked.column is None else column_of(source, asked.column, "column")
    places = _places(source, asked, wanted, every=every)
    used = [wanted] if wanted is not None else _used(source, places, every=every)
    found = _part(source.with_columns(sorted({*used, *places})), asked, places)
    if asked.rate is not None:
        found = replace(found, step=1.0 / asked.rate, along="time", notes=_outranked(found, asked.rate, places))
        used = [n for n in used if n == wanted or along_of(source.heads[n]) != "time"] or used[-1:]
    elif (asked.place, asked.time) != (None, None) or not source.step:
        at = places[0] if asked.place or asked.time else _growing(found, places)
        used = [n for n in used if n != at]
        found = found if at is None else replace(found, placed=at, along=along_of(source.heads[at], named=True))
    for number in used if found.placed is None else [found.placed, *used]:
        check_values(found, number)
    if found.placed is not None:
        found = replace(found, step=_even_step(found, found.placed))
    if len(used) == 1 and (source.of_file or not every):
        _check_reach(found, used[0])
    if not found.step:
        has = f"{source.where}: has" if source.path else "the trace has"
        raise Refused(f'{has} no time and no distance; rate="20 kHz" says how often it was sampled')
    return replace(found, used=used)


def _places(source: Source, asked: Asked, wanted: int | None, *, every: bool) -> list[int]:
    """Return the columns that may place the samples: the chosen one, or those of times, then those of distances."""
    for keyword, given in (("place", asked.place), ("time", asked.time)):
        if given is not None:
            head = source.heads[found := column_of(source, given, keyword)]
            along = along_of(head, named=True)
            if along != "time" and (keyword == "time" or not (along or every)):
                has = f"{source.where}: {keyword}=: {head.name} has {head.unit or 'no unit'}"
                raise Refused(f"{has}; a unit {'of time' if keyword == 'time' else 'of length or time'} is needed")
            return [found]
    others = [n for n in source.usable if n != wanted]
    natural = [n for kind in ("time", "distance") for n in others if along_of(source.heads[n]) == kind]
    for head in source.heads if not natural and asked.rate is None and not source.step else ():
        if (right := _UNITS.get(head.name.lower())) is not None:
            check_unit(head.unit, f"{source.where}: {head.written}")
            right = f'write "{head.name} ({right})", or whichever unit it has'
            raise Refused(f"{source.where}: {head.name} has {head.unit or 'no unit'}; {right}")
    return natural


def _used(source: Source, places: Sequence[int], *, every: bool) -> Sequence[int]:
    """Return the columns of a trace without a chosen one: the only one or the only force, or every one."""
    if not any(head.written for head in source.heads) and len(source.usable) > 1:
        what = 'has no line of names above its numbers; column=2, rate="10 kHz" and unit="N" say what is in it'
        raise Refused(f"{source.path}: {source.place(0)}: {what}")
    if every:
        return source.usable
    others = [n for n in source.usable if n not in places] or list(places[1:])
    forces = [n for n in others if unit_or_one(source.heads[n].unit).dimension == FORCE.dimension]
    others = forces if len(forces) == 1 else others
    if len(others) != 1:
        names = listed([source.heads[n].name for n in others]) or "none but the place"
        raise NoColumn(f"{source.path}: which column? column= takes one of: {names}")
    return others


def _part(source: Source, asked: Asked, places: Sequence[int]) -> Source:
    """Return the part of a source that is asked for; raises Refused for one that it does not have."""
    rows = min(values.size for values in source.arrays.values())
    if rows < 2:
        raise Refused(f"{source.where}: {rows} rows below the names; a row for each sample is needed, two or more")
    step, along = (source.step, source.along) if asked.rate is None else (1.0 / asked.rate, "time")
    if not step and places:
        step, along = _usual_step(source, places[0]), along_of(source.heads[places[0]], named=True)
    ends = [1, rows]
    for end, keyword, given in ((0, "from_", asked.begin), (1, "to", asked.end)):
        if isinstance(given, Quantity):
            if not step > 0.0 or given.kind is not (LENGTH if along == "distance" else TIME):
                lies = f"the trace is over {along}" if step > 0.0 else "the trace has no times"
                raise Refused(f'{keyword}=: {given.written}: {lies}; {keyword}="7201" names a sample')
            ends[end] = (floor if end else ceil)(given / step * (1.0 + _ROUNDING * (1 if end else -1))) + 1
        elif given is not None:
            ends[end] = given
    first, last = ends
    if not 1 <= first < last:
        raise Refused(f"from_=: samples {first:,} to {last:,} are no part of the trace, which has {rows:,}")
    if last > rows:
        raise Refused(f"to=: sample {last:,} is beyond the last of the trace, which has {rows:,}")
    arrays = {number: values[first - 1 : last] for number, values in source.arrays.items()}
    cut = f"left out: all but samples {first:,} to {last:,} of {rows:,}"
    return replace(source, arrays=arrays, begin=first - 1, left_out=() if (first, last) == (1, rows) else (cut,))


def _usual_step(source: Source, number: int) -> float:
    """Return the median step between the numbers of a column in s or um, 0 without one."""
    steps = np.diff(source.arrays[number])
    steps = steps[np.isfinite(steps)]
    return float(np.median(steps)) * float(unit_or_one(source.heads[number].unit).size) if steps.size else 0.0


def _growing(source: Source, places: Sequence[int]) -> int | None:
    """Return the first column that grows; of times that do not grow the first one, which is refused then."""
    for number in places:
        steps = np.diff(source.arrays[number])
        if _usual_step(source, number) > 0.0 and np.mean(steps[np.isfinite(steps)] < 0.0) <= _BACKWARD:
            return number
    return next((n for n in places if along_of(source.heads[n]) == "time"), None)


def _outranked(source: Source, rate: float, places: Sequence[int]) -> tuple[str, ...]:
    """Return the notes, with one if times of the file have another rate than the given one."""
    for number in [n for n in places if along_of(source.heads[n]) == "time"][:1]:
        head, times = source.heads[number], source.arrays[number]
        step = float(times[-1] - times[0]) / (times.size - 1) * float(unit_or_one(head.unit).size)
        if step > 0.0 and abs(1.0 / (step * rate) - 1.0) > UNEVEN:
            said = f"the rate is {rate:g} Hz as given; by {head.name} of {source.path} it is {1.0 / step:.6g} Hz"
            return (*source.notes, said)
    return source.notes


def _even_step(source: Source, number: int) -> float:
    """Return the mean step in s or um; raises Refused, with the line, if a step is not the usual one.

    A step may be 1 % off, and one digit of the places, since they are rounded. If the step is one digit, and nearly all
    steps are equal, a longer one is a missing row and not rounding.
    """
    head, places = source.heads[number], source.arrays[number]
    steps, size = np.diff(places), float(unit_or_one(head.unit).size)
    usual = float(np.median(steps))
    if usual <= 0.0:
        hint = 'if it is rounded, rate="10 kHz" says how often it was sampled'
        raise Refused(f"{source.path}: {head.name} does not grow from line to line; {hint}")
    written = [f"{each:.12f}".rstrip("0").partition(".")[2] for each in (*places[:50], *places[-50:])]
    digit, uneven = 10.0 ** -max(map(len, written)), UNEVEN * usual
    few = np.count_nonzero(np.abs(steps - usual) > uneven) <= max(3, 0.01 * steps.size)
    allowed = uneven if digit > 0.5 * usual and few else uneven + 1.01 * digit
    wrong = ~(np.abs(steps - usual) <= allowed)
    if wrong.any():
        row = int(np.argmax(wrong)) + 1
        grown = f"{head.name} grows by {steps[row - 1]:g} {head.unit} where the usual step is {usual:g}"
        source.refuse(row, f'{grown}; samples have to be evenly spaced; to="{source.begin + row}" ends before it')
    return float(places[-1] - places[0]) / steps.size * size


def check_values(source: Source, number: int) -> None:
    """Raise Refused with the first value that is not finite, or too large to be squared."""
    values = source.arrays[number]
    wrong = ~(np.abs(values) <= LARGEST_VALUE)
    if wrong.any():
        row = int(np.argmax(wrong))
        limit = "every sample needs a number" if np.isinf(values[row]) else f"up to {LARGEST_VALUE:g} is read"
        said = f"{source.heads[number].name} is {values[row]:g}; {limit}"
        said = source.wrong(row, number) if np.isnan(values[row]) else said
        source.refuse(row, said + (f'; to="{source.begin + row}" ends before it' if source.of_file and row > 1 else ""))


def _check_reach(source: Source, number: int) -> None:
    """Raise Refused with the first value that is far from the others and alone: a filled gap, an overload.

    Junctions pass over several samples, so that one or two that leap are not theirs, nor are more of one value.
    """
    head, values = source.heads[number], source.arrays[number]
    away = np.abs(values - np.median(values))
    reach = float(np.quantile(away[:: away.size // _SEEN + 1], 0.99))
    far = np.flatnonzero(away > _FAR * reach)
    for run in np.split(far, np.flatnonzero(np.diff(far) > 1) + 1) if reach > 0.0 and far.size else ():
        if run.size <= 2 or np.ptp(values[run]) == 0.0:
            others = values[away <= _FAR * reach]
            usual = f"{others.min():.4g} to {others.max():.4g} {head.unit}"
            said = f"{head.name} is {values[run[0]]:g}, far outside of the other values, {usual}"
            source.refuse(int(run[0]), f"{said}; mend or remove that row, or from_= and to= leave it out")


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
