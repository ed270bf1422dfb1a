"""Measurements of the user's own: records that are uniform in time or distance, read from a file and checked."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from math import isfinite
from numbers import Real
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Self, overload

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.covariance import autocovariance
from rubnoise.analysis.histogram import BINS, Histogram, histogram
from rubnoise.analysis.records import RecordTooShort
from rubnoise.api import keywords
from rubnoise.api.columns import Column, with_units
from rubnoise.api.estimates import Autocovariance, PowerSpectrum, power_spectrum
from rubnoise.api.given_columns import given_columns
from rubnoise.api.table import Table
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.real_numbers import with_unit
from rubnoise.regular_file import is_hdf5
from rubnoise.storage.measured import refusing_files
from rubnoise.storage.measured_text import TextTable
from rubnoise.storage.samples import EvenSteps, check_values, chosen_column, even_step
from rubnoise.storage.text_heads import NONE, OTHERS, Head, check_unit, head_of
from rubnoise.units import AREA, FORCE, FREQUENCY, KINDS, LENGTH, MASS, SPEED, STRESS, TIME, parse_unit

if TYPE_CHECKING:
    pass

CONVERTED: Final = (LENGTH, AREA, SPEED, FORCE, STRESS, MASS, TIME)
"""Kinds whose units are converted to the working unit."""


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Trace(Table):
    """Columns over a uniform ``place``, such as a time in s or a sliding distance in um.

    ``columns`` are arrays by name and ``units`` their units, the place among them; ``step`` is the spacing of places.
    Lengths, areas, speeds, forces, stresses, masses and times are converted to um, um^2, um/s, uN, MPa, kg and s; other
    units, such as V, stay as they are. ``Trace("trace.csv")`` reads a file as `from_csv` does, and ``Trace(values,
    rate="10 kHz", unit="N")`` takes one array as `from_array` does; `from_arrays` takes several. A table of pandas or
    xarray and the trace of a run are taken with their places and units.

    >>> import rubnoise
    >>> measured = rubnoise.Trace.from_arrays({"time (s)": [0.0, 0.1, 0.2], "velocity (mm/s)": [1.0, 2.0, 1.5]})
    >>> measured["velocity"], measured.units["velocity"]
    (array([1000., 2000., 1500.]), 'um/s')
    """

    name: str
    place: str
    step: float
    columns: Mapping[str, Doubles] = field(repr=False)
    units: Mapping[str, str] = field(repr=False)

    def __init__(
        self,
        source: Any,
        *,
        rate: Any = None,
        unit: str | None = None,
        place: str | None = None,
        name: str | None = None,
    ) -> None:
        """Read a file, or take an array with a ``rate`` and a ``unit``; raises Refused as `from_csv` does."""
        if isinstance(source, str | os.PathLike):
            _refuse(f"of a file, which says it: {source}", unit=unit, name=name)
            made = type(self).from_csv(source, place=place, rate=rate)
        elif (columns := given_columns(source, sampled=rate is not None)) is not None or isinstance(source, Mapping):
            _refuse("of columns, which say it by their place and their names", rate=rate, unit=unit)
            made = type(self).from_arrays(columns or source, place=place, name=name or "trace")
        else:
            _refuse("of an array, whose place is time", place=place)
            made = type(self).from_array(source, rate=rate, unit=unit, name=name or "trace")
        for each in fields(self):
            object.__setattr__(self, each.name, getattr(made, each.name))

    @classmethod
    def from_array(cls, values: ArrayLike, *, rate: Any = None, unit: str | None = None, name: str = "trace") -> Self:
        """Make a trace of one array that was sampled at a ``rate`` such as "10 kHz", in a ``unit`` such as "N".

        Its columns are `time` and ``name``. Quantities of pint have their unit, or are converted to ``unit``. Raises
        Refused without a rate or a unit.
        """
        often = keywords.quantity("rate", rate, FREQUENCY)
        kept, own = with_unit(values, name, unit or "")
        if often is None or (unit is None and not own):
            raise Refused('an array needs rate= and unit=; right form: rate="10 kHz", unit="N"')
        return cls.from_arrays({"time (s)": np.arange(kept.size) / often, f"{name} ({own})": kept}, name=name)

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str], *, place: str | None = None, rate: Any = None) -> Self:
        """Read a table of text: a line of names with units, then a row of numbers per line.

        A name is ``NAME (UNIT)``, ``NAME [UNIT]``, ``NAME/UNIT`` or ``NAME_UNIT``, or a line of units follows; a column
        without a unit is plain numbers. Commas, semicolons or tabs separate the cells; a preamble may come before, and
        lines that begin with # are comments. ``place`` names the column of times or distances, which must be uniform;
        the default is the first column. ``rate``, such as "10 kHz", is for times that are rounded to too few digits.
        Raises Refused, with line and column, for a cell that is not a finite number, for an unknown unit, for a file
        without names, and for gaps and uneven steps. Source: docs/your-data.md.
        """
        with refusing_files(path):
            if is_hdf5(path):
                raise Refused(f'{path}: is no text; of a result, Trace(rubnoise.open("{path}")) takes the trace')
            table = TextTable(Path(path))
            if not table.layout.head_line:
                raise Refused(
                    f'{path}: has no line of names above its numbers; write one, such as "time (s),force (mN)"'
                )
            names = [head.name for head in table.heads]
            number = 0 if place is None else chosen_column(str(path), names, place, None, keyword="place")
            head = table.heads[number]
            check_unit(head.unit, f"{table.where}: {head.written}")
            even = EvenSteps(head.name, head.unit, str(path), keywords.quantity("rate", rate, FREQUENCY))
            kept: list[list[Doubles]] = [[] for _ in names]
            for piece in table.pieces():
                even.add(piece.values[:, number], piece.numbers, piece.resolution(number))
                for column, parts in enumerate(kept):
                    parts.append(piece.column(column))
            found = cls._of(
                str(path), table.heads, [np.concatenate(parts) for parts in kept], number, where=table.where
            )
            if rate is None:
                return found
            return cls._made(found.name, found.place, even.step(), found.columns, found.units)

    @classmethod
    def from_arrays(cls, columns: Mapping[str, ArrayLike], *, place: str | None = None, name: str = "<python>") -> Self:
        """Make a trace of arrays of equal length, with headers as names; raises Refused as `from_csv` does.

        Quantities of pint are converted to the unit of their header, or have their own if it names none.
        """
        heads = [head_of(str(header)) for header in columns]
        read = [with_unit(columns[key], f"{name}: {key}", head.unit) for key, head in zip(columns, heads, strict=True)]
        arrays = [values for values, _ in read]
        if not arrays or any(each.shape != (arrays[0].size,) for each in arrays):
            raise Refused(f"{name}: a trace needs columns of equal length, each of one dimension")
        heads = [replace(head, unit=unit) for head, (_, unit) in zip(heads, read, strict=True)]
        for head, each in zip(heads, arrays, strict=True):
            check_values(each, f"{name}: {head.written}", lambda row: f"row {row}")
        number = (
            0 if place is None else chosen_column(name, [head.name for head in heads], place, None, keyword="place")
        )
        even_step(arrays[number], heads[number].name, heads[number].unit, name, first=0)
        return cls._of(name, heads, arrays, number, where=name)

    @classmethod
    def _of(cls, source: str, heads: Sequence[Head], arrays: Iterable[Doubles], place: int, *, where: str) -> Self:
        columns: dict[str, Doubles] = {}
        units: dict[str, str] = {}
        for head, values in zip(heads, arrays, strict=True):
            if head.name in columns:
                raise Refused(f"{where}: two columns are named {head.name}")
            units[head.name], factor = _in_working_units(head.unit, f"{where}: {head.written}")
            columns[head.name] = factor * np.ascontiguousarray(values)
        chosen = heads[place].name
        places = columns[chosen]
        step = float(places[-1] - places[0]) / (places.size - 1)
        return cls._made(source, chosen, step, columns, units)

    @classmethod
    def _made(
        cls, name: str, place: str, step: float, columns: Mapping[str, Doubles], units: Mapping[str, str]
    ) -> Self:
        made = object.__new__(cls)
        given = (name, place, step, MappingProxyType(dict(columns)), MappingProxyType(dict(units)))
        for each, value in zip(fields(cls), given, strict=True):
            object.__setattr__(made, each.name, value)
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return self._made, (self.name, self.place, self.step, dict(self.columns), dict(self.units))

    @overload
    def __getitem__(self, name: str) -> Doubles: ...
    @overload
    def __getitem__(self, name: slice) -> Self: ...
    def __getitem__(self, name: str | slice) -> "Doubles | Self":
        """Return a column by its name, or the rows of a slice as a trace; raises KeyError with the names there are."""
        if isinstance(name, slice):
            if (name.step or 1) < 0:
                raise Refused(f"{self.name}: a slice with a step of {name.step}: {self.place} grows from row to row")
            if len(range(len(self))[name]) < 2:
                raise Refused(f"{self.name}: a trace needs two rows or more")
            rows = {each: values[name] for each, values in self.columns.items()}
            return self._made(self.name, self.place, self.step * (name.step or 1), rows, self.units)
        if name not in self.columns:
            raise KeyError(f"{self.name} has no column {name!r}; it has {', '.join(self.columns)}")
        return self.columns[name]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.columns)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return int(self.columns[self.place].size)

    def psd(self, name: str | None = None, *, segment: Any = None) -> PowerSpectrum:
        """Return Welch's estimate of the spectrum of a column; see PowerSpectrum.

        ``segment`` is the length of a segment with its unit, such as "0.5 s"; by default there are some 64 segments. Of
        a trace with one column beside the place, that one is meant. Raises Refused for a length without a unit, and for
        a record or a segment of fewer than 8 rows.
        """
        chosen = self._column(name)
        return power_spectrum(
            chosen,
            self.units[chosen],
            [self.columns[chosen]],
            rows=len(self),
            step=self.step,
            place_units=self.units[self.place],
            segment=self._length("segment", segment),
        )

    def acf(self, name: str | None = None, *, longest: Any = None) -> Autocovariance:
        """Return the autocovariance of a column at lags up to ``longest``, such as "0.1 s"; by default a tenth of it.

        R_j = (1/n) sum of (x_i - mean)(x_(i+j) - mean). Raises Refused for a lag that the record does not have, and for
        one without a unit.
        """
        chosen, units = self._column(name), self.units[self.place]
        lag = self._length("longest", longest)
        reach = max(1, len(self) // 10) if lag is None else round(lag / self.step)
        if not 0 < reach < len(self):
            most = (len(self) - 1) * self.step
            raise Refused(
                f"{self.name}: longest=: {keywords.shown(longest)}: the record has lags up to {most:.6g} {units}"
            )
        return Autocovariance(
            name=chosen,
            lag=self.step * np.arange(reach + 1, dtype=np.float64),
            lag_units=units,
            covariance=autocovariance(self.columns[chosen], reach),
            units=f"({self.units[chosen]})^2",
        )

    def histogram(self, name: str | None = None, *, bins: ArrayLike | int = BINS) -> Histogram:
        """Return the density of a column over bins: their number or their edges, in the unit of the column.

        Its ``standard_error`` knows that neighbouring rows are not independent; it is inf for a record too short to
        tell. Raises ValueError for edges that do not rise.
        """
        values = self.columns[self._column(name)]
        try:
            return histogram(values, self.step, bins)
        except RecordTooShort as short:
            if isinstance(short.estimate, Histogram):
                return short.estimate
            raise

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, first the place."""
        return (self.place, *(name for name in self.columns if name != self.place))

    def _described(self, name: str) -> Column:
        return with_units(self[name], name, self.units[name])

    @property
    def _title(self) -> str:
        return self.name

    def _length(self, keyword: str, value: Any) -> float | None:
        """Return a length along the place; a number if the place has no known unit."""
        kind = next((each for each in KINDS if each.unit == self.units[self.place]), None)
        if kind is not None:
            return keywords.quantity(keyword, value, kind)
        if value is not None and (isinstance(value, bool) or not isinstance(value, Real) or not isfinite(value)):
            raise Refused(f"{keyword}=: {keywords.shown(value)}: a number is needed, {self.place} has no unit")
        return None if value is None else float(value)

    def _column(self, name: str | None) -> str:
        others = [each for each in self.columns if each != self.place]
        if name is None and len(others) == 1:
            return others[0]
        if name in others and name is not None:
            return name
        raise Refused(f"{self.name}: say which column: {', '.join(others)}" + (f", not {name}" if name else ""))

    @property
    def _heading(self) -> str:
        return f"{self.name}: {len(self):,} rows, every {self.step:.6g} {self.units[self.place]}"


def _refuse(source: str, **keys: Any) -> None:
    """Raise Refused for a keyword that would have no effect."""
    for name, value in keys.items():
        if value is not None:
            raise Refused(f"{name}=: {keywords.shown(value)}: has no effect on a trace {source}")


def _in_working_units(unit: str, what: str) -> tuple[str, float]:
    """Return the working unit of a unit, and the unit's size in it; a known unit of another kind stays as it is.

    Raises Refused for an unknown unit.
    """
    check_unit(unit, what)
    if unit in NONE:
        return "1", 1.0
    if unit in OTHERS:
        return unit, 1.0
    read = parse_unit(unit)
    kind = next((each for each in CONVERTED if each.dimension == read.dimension), None)
    return (unit, 1.0) if kind is None else (kind.unit, float(read.size))
