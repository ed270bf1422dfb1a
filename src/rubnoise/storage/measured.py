"""Measured traces: heads with units as laboratories write them, the columns and the part that are used, and checks.

The part is cut first, and checked then. The caller must give a unit or rate that the file does not have.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, NoReturn

import numpy as np

from rubnoise.arrays import Doubles, check_unit
from rubnoise.errors import NoColumn, Refused
from rubnoise.units import FORCE, LENGTH, TIME, USUAL_UNITS, Quantity, is_unit, spelled, unit_or_one

LARGEST_VALUE: Final = 1e60  # size of a value at most: fourth powers of values are numbers
UNEVEN: Final = 0.01
"""How far one step between samples may be from the usual one, in parts of it, beyond the digits that are written."""

_BRACKETS: Final = re.compile(r"([^()\[\]]+)[(\[]([^()\[\]]*)[)\]]")
_PARTING: Final = re.compile(r"/|\sin\s|,\s|_(?!per_)")
_LETTER: Final = r"[^\W\d_]"
_TRAVELLED: Final = re.compile(r"distance|dist|position|pos|[a-z]*weg|strecke|path|travel|track|s|x")
_UNITS: Final = {"time": "s", "t": "s", "zeit": "s", "distance": "um", "position": "um", "weg": "mm"}
_BACKWARD: Final = 0.1  # of the steps of what grows: a stage that goes to and fro has half of them
_FAR: Final = 20.0  # times the reach of 99 % of the values from the median: where one alone is no part of a trace
_SEEN: Final = 1 << 20
_SHOWN: Final = 40


@dataclass(frozen=True, slots=True)
class Head:
    """The name of a column, its unit or an empty text, the cell as ``written``, and what nan stands for."""

    name: str
    unit: str
    written: str
    missing: str = ""

    @property
    def size(self) -> float:
        """Size of the unit in working units; 1 for none, and for an unknown one."""
        return float(unit_or_one(self.unit).size)

    def along(self, *, named: bool = False) -> str:
        """Return "time" or "distance" for what places samples: a length by its name, or if it is ``named``; else ""."""
        dimension = unit_or_one(self.unit).dimension
        last = re.split(r"[\s_]+", self.name.lower().strip(" ."))[-1].strip(".")
        travelled = dimension == LENGTH.dimension and (named or _TRAVELLED.fullmatch(last))
        return "time" if dimension == TIME.dimension else "distance" if travelled else ""


def head_of(cell: str) -> Head:
    """Return name and unit of a column: `Force (N)`, `Force [N]`; after `/`, `in`, comma and `_` a known unit."""
    text = cell.strip()
    if (found := _BRACKETS.fullmatch(text)) and re.search(_LETTER, found[1]):
        return Head(found[1].strip(), spelled(found[2]), text)
    for found in _PARTING.finditer(text):
        name, unit = text[: found.start()].strip(), spelled(text[found.end() :][:_SHOWN])
        if re.search(_LETTER, name) and (unit in (*USUAL_UNITS, "V", "mV") or (found[0] != "_" and is_unit(unit))):
            return Head(name, unit, text)
    return Head(text, "", text)


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What a caller says of a file, with its part: samples from 1 on, or times or distances from the first one."""

    column: str | None = None
    place: str | None = None
    time: str | None = None
    rate: float | None = None
    begin: int | Quantity | None = None
    end: int | Quantity | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Columns: all heads, and the ``arrays`` of those that have numbers or times, nan where no number stands.

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
    def head(self) -> Head:
        """Name and unit of the first column of a trace."""
        return self.heads[self.used[0]]

    @property
    def values(self) -> Doubles:
        """The first column of a trace."""
        return self.arrays[self.used[0]]

    def place(self, row: int) -> str:
        """Return the words for a row."""
        return f"sample {self.begin + row + 1:,}"

    def wrong(self, row: int, number: int) -> str:
        """Say why a value cannot be used."""
        head, value = self.heads[number], self.arrays[number][row]
        limit = f"up to {LARGEST_VALUE:g} is read" if np.isfinite(value) else "every sample needs a number"
        meant = f"[{self.begin + row}] is {head.missing}" if head.missing and np.isnan(value) else f" is {value:g}"
        return f"{head.name}{meant}; {limit}"

    def refuse(self, row: int, said: str) -> NoReturn:
        """Raise Refused, which names the file and a row, and says how a file is read up to it."""
        hint = f'; to="{self.begin + row}" ends before it' if self.of_file and row > 1 else ""
        where = f"{self.path}: {self.place(row)}:" if self.path else f"{self.place(row)} of"
        raise Refused(f"{where} {said}{hint}")


def measured(source: Source, asked: Asked, *, every: bool = False) -> Source:
    """Return a column and its places, or ``every`` column, cut and checked; with a rate without times."""
    if asked.rate is not None:
        source = replace(source, step=1.0 / asked.rate, along="time")
    wanted = None if asked.column is None else column_of(source, asked.column, "column")
    places, chosen = _places(source, asked, wanted, every=every), (asked.place, asked.time) != (None, None)
    used = [wanted] if wanted is not None else _used(source, places, every=every)
    found, at = _part(source, asked, places), None
    if asked.rate is not None:
        found = _outranked(found, places[0]) if places else found
        used = [n for n in used if n == wanted or source.heads[n].along() != "time"] or used[-1:]
    elif chosen or not source.step:
        times = [n for n in places if chosen or source.heads[n].along() == "time"]
        growing = (n for n in places if np.mean(np.diff(found.arrays[n]) < 0.0) <= _BACKWARD)
        at = next(iter(times), next(growing, None))
    used = [n for n in used if n != at]
    for number in used if at is None else [at, *used]:
        check_values(found, number)
    if at is not None:
        found = replace(found, placed=at, along=source.heads[at].along(named=True), step=_even_step(found, at))
    if len(used) == 1 and (source.of_file or not every):
        _check_reach(found, used[0])
    if not found.step:
        has = f"{source.where}: has" if source.path else "the trace has"
        raise Refused(f'{has} no time and no distance; rate="20 kHz" says how often it was sampled')
    return replace(found, used=used)


def _places(source: Source, asked: Asked, wanted: int | None, *, every: bool) -> list[int]:
    """Return the columns that may place the samples: the chosen one, or those of times, then those of distances."""
    keyword, given = ("time", asked.time) if asked.place is None else ("place", asked.place)
    if given is not None:
        head = source.heads[number := column_of(source, given, keyword)]
        along = head.along(named=True)
        if along != "time" and (keyword == "time" or not (along or every)):
            has = f"{source.where}: {keyword}=: {head.name} has {head.unit or 'no unit'}"
            raise Refused(f"{has}; a unit {'of time' if keyword == 'time' else 'of length or time'} is needed")
        return [number]
    others = [n for n in source.arrays if n != wanted]
    natural = [n for kind in ("time", "distance") for n in others if source.heads[n].along() == kind]
    for head in source.heads if not natural and not source.step else ():
        if (right := _UNITS.get(head.name.lower())) is not None:
            check_unit(head.unit, f"{source.where}: {head.written}")
            right = f'write "{head.name} ({right})", or whichever unit it has'
            raise Refused(f"{source.where}: {head.name} has {head.unit or 'no unit'}; {right}")
    return natural


def _used(source: Source, places: Sequence[int], *, every: bool) -> Sequence[int]:
    """Return the columns of a trace without a chosen one: the only one or the only force, or every one."""
    if not any(head.written for head in source.heads) and len(source.arrays) > 1:
        what = 'has no line of names above its numbers; column=2, rate="10 kHz" and unit="N" say what is in it'
        raise Refused(f"{source.path}: {source.place(0)}: {what}")
    if every:
        return list(source.arrays)
    others = [n for n in source.arrays if n not in places] or list(places[1:])
    forces = [n for n in others if unit_or_one(source.heads[n].unit).dimension == FORCE.dimension]
    others = forces if len(forces) == 1 else others
    if len(others) != 1:
        names = ", ".join(source.heads[n].name for n in others) or "none but the place"
        raise NoColumn(f"{source.path}: which column? column= takes one of: {names}")
    return others


def _part(source: Source, asked: Asked, places: Sequence[int]) -> Source:
    """Return the part of a source that is asked for; raises Refused for one that it does not have."""
    rows = min(values.size for values in source.arrays.values())
    if rows < 2:
        raise Refused(f"{source.where}: {rows} rows below the names; a row for each sample is needed, two or more")
    step, along, ends = source.step, source.along, [1, rows]
    if not step and places and Quantity in (type(asked.begin), type(asked.end)):
        head, steps = source.heads[places[0]], np.diff(source.arrays[places[0]])
        step, along = float(np.nanmedian(steps)) * head.size, head.along(named=True)
    for end, keyword, given in ((0, "from_", asked.begin), (1, "to", asked.end)):
        if isinstance(given, Quantity) and not (step > 0.0 and given.kind is (LENGTH if along == "distance" else TIME)):
            lies = f"the trace is over {along}" if step > 0.0 else "the trace has no times"
            raise Refused(f'{keyword}=: {given.written}: {lies}; {keyword}="7201" names a sample')
        if given is not None:
            ends[end] = round(given / step) + 1 if isinstance(given, Quantity) else given
    first, last = ends
    if not 1 <= first < last <= rows:
        beyond = "to" if last > rows else "from_"
        raise Refused(f"{beyond}=: samples {first:,} to {last:,} are no part of the trace, which has {rows:,}")
    arrays = {number: values[first - 1 : last] for number, values in source.arrays.items()}
    cut = f"left out: all but samples {first:,} to {last:,} of {rows:,}"
    return replace(source, arrays=arrays, begin=first - 1, left_out=() if (first, last) == (1, rows) else (cut,))


def _outranked(source: Source, number: int) -> Source:
    """Return a source with a note if a column has other times than those of the given rate."""
    head, times = source.heads[number], source.arrays[number]
    took = float(times[-1] - times[0]) * head.size
    if head.along() != "time" or not took > 0.0 or abs((times.size - 1) * source.step / took - 1.0) <= UNEVEN:
        return source
    by = f"by {head.name} of {source.path} it is {(times.size - 1) / took:.6g} Hz"
    return replace(source, notes=(*source.notes, f"the rate is {1.0 / source.step:g} Hz as given; {by}"))


def _even_step(source: Source, number: int) -> float:
    """Return the mean step in s or um; raises Refused, with the line, if a step is not the usual one.

    A step may be 1 % off, and one digit of the places, since they are rounded. If the step is one digit, and nearly all
    steps are equal, a longer one is a missing row and not rounding.
    """
    head, places = source.heads[number], source.arrays[number]
    steps = np.diff(places)
    usual = float(np.median(steps))
    if usual <= 0.0:
        hint = 'if it is rounded, rate="10 kHz" says how often it was sampled'
        raise Refused(f"{source.path}: {head.name} does not grow from line to line; {hint}")
    written = [f"{each:.12f}".rstrip("0").partition(".")[2] for each in (*places[:50], *places[-50:])]
    digit, uneven, off = 10.0 ** -max(map(len, written)), UNEVEN * usual, np.abs(steps - usual)
    few = np.count_nonzero(off > uneven) <= max(3, 0.01 * steps.size)
    wrong = off > (uneven if digit > 0.5 * usual and few else uneven + 1.01 * digit)
    if wrong.any():
        row = int(np.argmax(wrong)) + 1
        grown = f"{head.name} grows by {steps[row - 1]:g} {head.unit} where the usual step is {usual:g}"
        source.refuse(row, f"{grown}; samples have to be evenly spaced")
    return float(places[-1] - places[0]) / steps.size * head.size


def check_values(source: Source, number: int) -> None:
    """Raise Refused with the first value that is not finite, or too large to be squared."""
    wrong = ~(np.abs(source.arrays[number]) <= LARGEST_VALUE)
    if wrong.any():
        source.refuse(row := int(np.argmax(wrong)), source.wrong(row, number))


def _check_reach(source: Source, number: int) -> None:
    """Raise Refused with the first value that is far from the others and alone: a filled gap, an overload.

    Junctions pass over several samples, so that one or two that leap are not theirs, nor are more of one value.
    """
    head, values = source.heads[number], source.arrays[number]
    away = np.abs(values - np.median(values))
    reach = _FAR * float(np.quantile(away[:: away.size // _SEEN + 1], 0.99))
    far = np.flatnonzero(away > reach)
    for run in np.split(far, np.flatnonzero(np.diff(far) > 1) + 1) if reach > 0.0 and far.size else ():
        if run.size <= 2 or np.ptp(values[run]) == 0.0:
            others = values[away <= reach]
            usual = f"far outside of the other values, {others.min():.4g} to {others.max():.4g} {head.unit}"
            source.refuse(int(run[0]), f"{head.name} is {values[run[0]]:g}, {usual}; mend or remove that row")


def column_of(source: Source, wanted: str, keyword: str) -> int:
    """Return the number of a column by its name, its name as written, or its number from 1 on; raises NoColumn."""
    names, written = [head.name for head in source.heads], [head.written for head in source.heads]
    numbers = [each.index(wanted) for each in (names, written) if each.count(wanted) == 1]
    if not numbers and re.fullmatch("[0-9]{1,9}", wanted) and 0 < int(wanted) <= len(names):
        numbers = [int(wanted) - 1]
    if numbers and numbers[0] in source.arrays:
        return numbers[0]
    what = "a column without numbers, one" if numbers else "the name of several" if wanted in names else "none"
    raise NoColumn(f"{source.path}: {keyword}=: {wanted} is {what} of the columns {', '.join(names)}")
