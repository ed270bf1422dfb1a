"""Measured traces: which columns are used, which part of them, whether their steps are even and their values possible.

The part is cut first, and checked then. The caller must give a unit or rate that the file does not have.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, floor
from numbers import Integral
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.storage.samples import UNEVEN, Source, along_of, check_reach, check_values, column_of, even_step, listed
from rubnoise.storage.text_heads import Head, check_unit
from rubnoise.units import FORCE, LENGTH, TIME, QuantityError, quantity_of, unit_or_one

_PLACES: Final = {"time": "s", "t": "s", "zeit": "s", "distance": "um", "position": "um", "weg": "mm"}
_MOST_DIGITS: Final = 15
_ROUNDING: Final = 1e-12
_BACKWARD: Final = 0.1
"""Part of the steps that may be negative in a column that grows: a stage that goes to and fro has half of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What a caller says of a file: its columns, its rate in Hz, and the part from ``begin`` to ``end``."""

    column: str | None = None
    place: str | None = None
    time: str | None = None
    rate: float | None = None
    begin: Any = None
    end: Any = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """Columns at even steps: ``step`` in s, or in um if ``along`` is "distance"; None if unknown.

    ``columns`` are those of the source that are used, by number; ``chosen`` and ``place_at`` are the numbers of the
    trace and of the places, None where there is not one. ``first`` is the row of the source with which the part begins,
    ``left_out`` says what was cut.
    """

    source: Source
    columns: Mapping[int, Doubles] = field(repr=False)
    chosen: int | None
    place_at: int | None
    step: float | None
    along: str
    first: int = 0
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    @property
    def head(self) -> Head:
        """Name and unit of the chosen column, or of the first one."""
        return self.source.heads[next(iter(self.columns)) if self.chosen is None else self.chosen]

    @property
    def values(self) -> Doubles:
        """The chosen column, or the first one."""
        return next(iter(self.columns.values())) if self.chosen is None else self.columns[self.chosen]

    def place(self, sample: int) -> str:
        """Return the words for a sample of the part."""
        return self.source.place(self.first + sample)


def measured(source: Source, asked: Asked, *, every: bool = False) -> Measured:
    """Return a column of a source and its places, or ``every`` column, cut and checked; raises Refused with the line.

    With a rate, times are left out: they are known.
    """
    wanted = None if asked.column is None else column_of(source, asked.column, "column")
    places = _places(source, asked, wanted, every=every)
    used = [wanted] if wanted is not None else _used(source, places, every=every)
    numbers = sorted({*used, *places})
    arrays = dict(zip(numbers, source.columns(numbers), strict=True))
    if (rows := arrays[numbers[0]].size) < 2:
        raise Refused(f"{source.where}: {rows} rows below the names; a row for each sample is needed, two or more")
    first, last = _part(source, asked, arrays, places, rows)
    arrays = {number: values[first:last] for number, values in arrays.items()}
    step, along, place, notes = source.step, source.along, None, source.notes
    if asked.rate is not None:
        step, along, notes = 1.0 / asked.rate, "time", notes + _outranked(source, asked.rate, arrays, places)
        used = [n for n in used if n == wanted or along_of(source.heads[n]) != "time"] or used[-1:]
    else:
        said = asked.place is not None or asked.time is not None
        place = _place(source, arrays, places, certain=said or step is not None)
    columns = [n for n in used if n != place]
    chosen = columns[0] if len(columns) == 1 else None
    for number in [*([] if place is None else [place]), *columns]:
        check_values(source, number, arrays[number], first)
    if place is not None:
        step, along = even_step(source, place, arrays[place], first), along_of(source.heads[place], named=said)
    if chosen is not None and (source.of_file or not every):
        check_reach(source, chosen, arrays[chosen], first)
    cut = f"left out: all but samples {first + 1:,} to {last:,} of {rows:,}"
    return Measured(
        source=source,
        columns={n: arrays[n] for n in numbers if n in used or n == place},
        chosen=chosen,
        place_at=place,
        step=step,
        along=along,
        first=first,
        notes=notes,
        left_out=() if (first, last) == (0, rows) else (cut,),
    )


def _places(source: Source, asked: Asked, wanted: int | None, *, every: bool) -> list[int]:
    """Return the columns that may place the samples: the chosen one, or those of times, then those of distances."""
    for keyword, given, needed in (("place", asked.place, "of length or time"), ("time", asked.time, "of time")):
        if given is not None:
            found = column_of(source, given, keyword)
            along = along_of(source.heads[found], named=True)
            if (not every and not along) or (keyword == "time" and along != "time"):
                has = f"{source.heads[found].name} has {source.heads[found].unit or 'no unit'}"
                raise Refused(f"{source.where}: {keyword}=: {has}; a unit {needed} is needed")
            return [found]
    others = [n for n in source.usable if n != wanted]
    natural = [n for kind in ("time", "distance") for n in others if along_of(source.heads[n]) == kind]
    if natural or asked.rate is not None or source.step is not None:
        return natural
    if every and len(others) > 1 and wanted is None:
        return others[:1]
    for head in source.heads if wanted is None else ():
        if (right := _PLACES.get(head.name.lower())) is not None:
            check_unit(head.unit, f"{source.where}: {head.written}")
            if not head.unit:
                right = f'write "{head.name} ({right})", or whichever unit it has'
                raise Refused(f"{source.where}: {head.name} has no unit; {right}")
    return []


def _used(source: Source, places: Sequence[int], *, every: bool) -> Sequence[int]:
    """Return the columns of a trace without a chosen one: the only one or the only force, or every one."""
    if source.unnamed and len(source.usable) > 1:
        what = 'column=2, rate="10 kHz" and unit="N" say what is in it'
        raise Refused(f"{source.path}: {source.unnamed}: has no line of names above its numbers; {what}")
    if every:
        return source.usable
    others = [n for n in source.usable if n not in places] or list(places[1:])
    forces = [n for n in others if unit_or_one(source.heads[n].unit).dimension == FORCE.dimension]
    others = forces if len(forces) == 1 else others
    if len(others) != 1:
        names = listed([source.heads[n].name for n in others]) or "none but the place"
        raise NoColumn(f"{source.path}: which column? column= takes one of: {names}")
    return others


def _place(source: Source, arrays: Mapping[int, Doubles], places: Sequence[int], *, certain: bool) -> int | None:
    """Return the first column that grows; of times that do not grow the first one, which `even_step` refuses."""
    for number in places:
        steps = np.diff(arrays[number])
        steps = steps[np.isfinite(steps)]
        if certain or (steps.size and np.median(steps) > 0.0 and np.mean(steps < 0.0) <= _BACKWARD):
            return number
    return next((n for n in places if along_of(source.heads[n]) != "distance" and source.step is None), None)


def _outranked(source: Source, rate: float, arrays: Mapping[int, Doubles], places: Sequence[int]) -> tuple[str, ...]:
    """Return what is said if times of the file have another rate than the given one."""
    times = next((n for n in places if along_of(source.heads[n]) == "time"), None)
    if times is None or not np.isfinite(ends := arrays[times][[0, -1]]).all() or ends[1] <= ends[0]:
        return ()
    own = (arrays[times].size - 1) / (float(ends[1] - ends[0]) * float(unit_or_one(source.heads[times].unit).size))
    said = f"the rate is {rate:g} Hz as given; by {source.heads[times].name} of {source.path} it is {own:.6g} Hz"
    return () if abs(own / rate - 1.0) <= UNEVEN else (said,)


def _part(
    source: Source, asked: Asked, arrays: Mapping[int, Doubles], places: Sequence[int], rows: int
) -> tuple[int, int]:
    """Return the first row of the part and the row behind it."""
    step, along = source.step, source.along
    if asked.rate is not None:
        step, along = 1.0 / asked.rate, "time"
    elif step is None and places and (asked.begin, asked.end) != (None, None):
        steps, head = np.diff(arrays[places[0]]), source.heads[places[0]]
        usual = float(np.median(steps[np.isfinite(steps)])) if np.isfinite(steps).any() else 0.0
        step, along = usual * float(unit_or_one(head.unit).size), along_of(head)
    first = 1 if asked.begin is None else _sample("from_", asked.begin, step, along, ceil)
    last = rows if asked.end is None else _sample("to", asked.end, step, along, floor)
    if not 1 <= first < last:
        raise Refused(f"from_=: samples {first:,} to {last:,} are no part of the trace, which has {rows:,}")
    if last > rows:
        raise Refused(f"to=: sample {last:,} is beyond the last of the trace, which has {rows:,}")
    return first - 1, last


def _sample(keyword: str, value: Any, step: float | None, along: str, rounded: Callable[[float], int]) -> int:
    """Return the number of a sample from 1 on, given as such or by the time or distance since the first one."""
    is_number = isinstance(value, Integral) and not isinstance(value, bool)
    if is_number or (isinstance(value, str) and value.strip().isdecimal() and len(value) <= _MOST_DIGITS):
        return int(value)
    kind = LENGTH if along == "distance" else TIME
    try:
        number = float(quantity_of(value, kind))
    except QuantityError as problem:
        form = f'right form: {keyword}="7201" for a sample, {keyword}="{kind.example}"'
        raise Refused(f"{keyword}=: {value!s:.80}: {problem}; {form}") from problem
    if step is None or not step > 0.0:
        raise Refused(f'{keyword}=: {value!s:.80}: the trace has no times; {keyword}="7201" names a sample')
    return int(rounded(number / step * (1.0 + _ROUNDING * (1.0 if rounded is floor else -1.0)))) + 1
