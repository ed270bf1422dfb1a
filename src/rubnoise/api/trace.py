"""Measurements of the user's own, from files, arrays and tables: records that are uniform in time or distance."""

import os
from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from math import isfinite
from numbers import Real
from typing import Any, Final, Self, overload

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.records import BINS, Histogram, histogram
from rubnoise.api import keywords
from rubnoise.api.columns import Column, Columns, Table, with_units
from rubnoise.api.estimates import Autocovariance, PowerSpectrum, power_spectrum
from rubnoise.api.keywords import shown
from rubnoise.arrays import Doubles, check_unit, real_numbers
from rubnoise.errors import Refused, refusing_files
from rubnoise.inference.signal import autocovariance, clipped, digits
from rubnoise.storage.foreign import opened
from rubnoise.storage.measured import Asked, Head, Source, head_of, measured
from rubnoise.units import (
    AREA,
    FORCE,
    KINDS,
    LENGTH,
    MASS,
    NONE,
    SPEED,
    STRESS,
    TIME,
    is_of_pint,
    spelled,
    unit_name,
    unit_or_one,
)

_NANOSECONDS: Final = 1e-9
_PLACES: Final = ("s", "um")


def sampled(given: Any, asked: Asked, name: str = "trace", *, unit: Any = "", every: bool = False) -> Source:
    """Return a column of what is given and its places, or ``every`` column, cut and checked (see `measured`).

    ``unit`` is that of an array. The first column of a table places its samples, if no other is said to.
    """
    if isinstance(given, str | os.PathLike):
        with refusing_files(given):
            return measured(opened(given, asked.column), asked, every=every)
    # Beside a rate, which says how often samples were taken, a column of a run is an array like any other.
    source = _table_of(given.values if asked.rate is not None and isinstance(given, Column) else given, name)
    if source is None:
        return measured(_array_of(given, name, asked, unit), asked, every=every)
    if (asked.place, asked.time, asked.rate) == (None, None, None) and (every or source.heads[0].along(named=True)):
        asked = replace(asked, place="1")
    return measured(source, asked, every=every)


def _array_of(values: Any, name: str, asked: Asked, unit: Any) -> Source:
    for key in ("place", "time", "column"):
        if (value := getattr(asked, key)) is not None:
            raise Refused(f"{key}=: {shown(value)}: has no effect on a trace of an array, whose place is time")
    found, own = with_unit(values, name, unit)
    if found.ndim != 1 or not found.size:
        raise Refused(f"{name}: has the shape {found.shape}; one row of finite numbers is needed")
    return Source(path="", heads=[Head(name, spelled(str(own)), name)], arrays={0: found})


def with_unit(values: Any, what: str, unit: Any) -> tuple[Doubles, str]:
    """Return values as doubles, and their unit; quantities of pint are converted to ``unit``, or have their own.

    ``unit`` is a text, empty if none is known, or a unit of pint. Raises Refused as `real_numbers` does.
    """
    unit = unit_name(unit)
    first = values[0] if isinstance(values, list | tuple) and values else values
    if not is_of_pint(first):
        return real_numbers(values, what), unit
    own = unit or unit_name(first.units)
    return real_numbers(values, what, own), own


def _table_of(given: Any, name: str) -> Source | None:
    """Return a table as a source of samples, time or distance first; None if it is no table.

    A table is a DataFrame, a Series whose index has a name or holds times, a DataArray or Dataset of one dimension, a
    group of columns of a run or one of its columns, a run, which means its trace, an object with ``columns``,
    ``units``, ``place`` and ``step``, or a dict of arrays by headers with units. Quantities of pint are converted to
    the unit of their header, or have their own if it names none.
    """
    if (columns := _columns_of(given)) is None:
        return None
    heads, arrays = [head_of(str(header)) for header in columns], {}
    for number, (header, values) in enumerate(columns.items()):
        arrays[number], unit = with_unit(values, f"{name}: {header}", heads[number].unit)
        heads[number] = replace(heads[number], unit=unit)
    if not arrays or any(each.shape != (arrays[0].size,) for each in arrays.values()):
        raise Refused(f"{name}: a trace needs columns of equal length, each of one dimension")
    notes = given.notes if hasattr(given, "step") and hasattr(given, "notes") else ()
    return Source(path=name, heads=heads, arrays=arrays, notes=notes)


def _columns_of(given: Any) -> Mapping[str, Any] | None:
    """Return columns by headers with units."""
    if all(hasattr(given, name) for name in ("columns", "units", "place", "step")):
        names = (given.place, *(name for name in given.columns if name != given.place))
        return {_header(name, given.units[name]): given.columns[name] for name in names}
    given = given.trace if hasattr(given, "provenance") else given
    if isinstance(given, Column):
        place = given.beside
        if place is None or place.name == given.name or place.units not in _PLACES:
            return None
        return {_header(each.name, each.units): each.values for each in (place, given)}
    if isinstance(given, Columns):
        return {_header(name, column.units): column.values for name, column in given.items()}
    if hasattr(given, "dims") and hasattr(given, "coords"):
        return _of_xarray(given)
    is_of_pandas = hasattr(given, "index") and hasattr(given, "to_numpy")
    return _of_pandas(given) if is_of_pandas else given if isinstance(given, Mapping) else None


def _of_xarray(source: Any) -> dict[str, Any] | None:
    whole = source if hasattr(source, "data_vars") else source.to_dataset(name=source.name or "trace")
    place = next(iter(whole.dims), None)
    if len(whole.dims) != 1 or place not in whole.coords:
        return None
    columns = {name: whole[name] for name in (place, *whole.data_vars)}
    return {_header(str(name), str(each.attrs.get("units", ""))): each.to_numpy() for name, each in columns.items()}


def _of_pandas(source: Any) -> dict[str, Any] | None:
    """Return the columns of a frame, or the one of a series, after the index if that has a name or times."""
    units = getattr(source, "attrs", {}).get("units", {})
    units = units if isinstance(units, dict) else {}
    frame = source if hasattr(source, "columns") else source.to_frame(source.name or "trace")
    columns = {_header(str(name), units.get(name, "")): frame[name].to_numpy() for name in frame.columns}
    index = frame.index
    if index.dtype.kind in "mM":
        times = np.asarray(index, dtype=f"{index.dtype.kind}8[ns]").astype(np.int64)
        return {"time (s)": (times - times[:1]) * _NANOSECONDS, **columns}
    if index.name and str(index.name) not in columns:
        return {_header(str(index.name), units.get(index.name, "")): index.to_numpy(), **columns}
    return columns if hasattr(source, "columns") else None


def _header(name: str, unit: str) -> str:
    """Return a name with its unit, which is added if the name has none."""
    return name if unit in NONE or head_of(name).unit else f"{name} ({unit})"


# The trace.
CONVERTED: Final = (LENGTH, AREA, SPEED, FORCE, STRESS, MASS, TIME)
"""Kinds whose units are converted to the working unit."""


class Trace(Table):
    """Columns over a uniform ``place``, such as a time in s or a sliding distance in um.

    ``trace["force"]`` is a column with its unit, ``units`` are those of all; ``step`` is the spacing of places.
    Lengths, areas, speeds, forces, stresses, masses and times are converted to um, um^2, um/s, uN, MPa, kg and s; other
    units, such as V, stay as they are. ``notes`` say what is remarkable in a file.

    >>> import rubnoise
    >>> measured = rubnoise.Trace.from_arrays({"time (s)": [0.0, 0.1, 0.2], "velocity (mm/s)": [1.0, 2.0, 1.5]})
    >>> measured["velocity"]
    <velocity (um/s), 3 rows of float64: 1000 2000 1500>
    """

    def __init__(
        self,
        source: Any,
        *,
        column: str | int | None = None,
        place: str | int | None = None,
        time: str | int | None = None,
        rate: Any = None,
        unit: Any = None,
        from_: Any = None,
        to: Any = None,
        name: str | None = None,
        **unknown: Any,
    ) -> None:
        """Read a file, take a table of pandas or xarray, a run's trace, or one array with a ``rate`` and a ``unit``.

        Of a file or a table all columns of numbers are kept, or ``column`` and its places alone; ``unit`` replaces the
        unit that a file gives it.
        ``time`` and ``place`` name the column of times or distances, which must be even; without them it is the first
        one of times, or of distances that grow, or the first one. ``rate``, such as "10 kHz", stands for the times.
        ``from_`` and ``to`` are the first and last sample, from 1 on, or times. Raises Refused, with line and column,
        for a cell that is not a number, for an unknown unit of the one column, for a file without names, and for gaps
        and uneven steps. Source: docs/your-data.md.
        """
        keywords.refuse_unknown(unknown, tuple(Trace.__init__.__kwdefaults__ or ()))
        asked = keywords.asked(column=column, place=place, time=time, rate=rate, from_=from_, to=to)
        of_file = isinstance(source, str | os.PathLike)
        if of_file and name is not None:
            raise Refused(f"name=: {keywords.shown(name)}: has no effect on a trace of a file, which says it: {source}")
        name = str(source) if of_file else name or "trace"
        found = sampled(source, asked, name, unit=unit or "", every=True)
        if not found.path and not found.head.unit:
            raise Refused('an array needs rate= and unit=; right form: rate="10 kHz", unit="N"')
        columns, notes = _in_working_units(found, unit if found.path else None)
        super().__init__(name, columns)
        self.step, self.notes, self.place = found.step, notes, self.names[0]

    @classmethod
    def from_array(cls, values: ArrayLike, *, rate: Any = None, unit: str | None = None, name: str = "trace") -> Self:
        """Make a trace of one array, with the columns `time` and ``name``; raises Refused without a rate or a unit.

        Quantities of pint have their unit, or are converted to ``unit``.
        """
        return cls(values, rate=rate, unit=unit, name=name)

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str], **options: Any) -> Self:
        """Read a file as ``Trace(path)`` does, with its options."""
        return cls(os.fspath(path), **options)

    @classmethod
    def from_arrays(
        cls, columns: Mapping[str, ArrayLike], *, place: str | int | None = None, name: str = "<python>"
    ) -> Self:
        """Make a trace of arrays of equal length, with headers such as "force (N)" as names.

        Quantities of pint are converted to the unit of their header, or have their own if it names none. ``place`` is
        the column of places, by default the first.
        """
        return cls(columns, place=place, name=name)

    @property
    def columns(self) -> dict[str, Doubles]:
        """The columns as plain arrays."""
        return {name: column.values for name, column in self.items()}

    @overload
    def __getitem__(self, name: str) -> Column: ...
    @overload
    def __getitem__(self, name: slice) -> Self: ...
    def __getitem__(self, name: str | slice) -> "Column | Self":
        """Return a column by its name, or the rows of a slice as a trace; raises KeyError with the names there are."""
        if not isinstance(name, slice):
            return super().__getitem__(name)
        if (name.step or 1) < 0:
            raise Refused(f"{self.name}: a slice with a step of {name.step}: {self.place} grows from row to row")
        if len(range(len(self))[name]) < 2:
            raise Refused(f"{self.name}: a trace needs two rows or more")
        part = copy(self)
        super(Trace, part).__init__(self.name, [rows[name] for rows in self.values()])
        part.step = self.step * (name.step or 1)
        return part

    def psd(self, name: str | None = None, *, segment: Any = None) -> PowerSpectrum:
        """Return Welch's estimate of the spectrum of a column; see PowerSpectrum.

        ``segment`` is the length of a segment, such as "0.5 s"; by default there are some 64. Of a trace with one
        column beside the place, that one is meant. Raises Refused for a record or a segment of fewer than 8 rows.
        """
        length = self._along("segment", segment)
        return power_spectrum(self._column(name), self.step, self.units[self.place], length)

    def acf(self, name: str | None = None, *, longest: Any = None) -> Autocovariance:
        """Return the autocovariance of a column at lags up to ``longest``, such as "0.1 s"; by default a tenth of it.

        R_j = (1/n) sum of (x_i - mean)(x_(i+j) - mean). Raises Refused for a lag that the record does not have.
        """
        column, units, lag = self._column(name), self.units[self.place], self._along("longest", longest)
        reach = max(1, len(self) // 10) if lag is None else round(lag / self.step)
        if not 0 < reach < len(self):
            most = f"the record has lags up to {(len(self) - 1) * self.step:.6g} {units}"
            raise Refused(f"{self.name}: longest=: {keywords.shown(longest)}: {most}")
        covariance = autocovariance(column.values, reach)
        columns = [
            with_units(self.step * np.arange(reach + 1), "lag", units),
            with_units(covariance, "covariance", f"({column.units})^2"),
            with_units(covariance / covariance[0], "correlation", "1"),
        ]
        return Autocovariance(column.name, columns)

    def histogram(self, name: str | None = None, *, bins: ArrayLike | int = BINS) -> Histogram:
        """Return the density of a column over bins: their number or their edges, in the unit of the column.

        Its ``standard_error`` knows that neighbouring rows are not independent; it is inf for a record too short to
        tell. Raises ValueError for edges that do not rise.
        """
        return histogram(self._column(name).values, bins)

    def _along(self, keyword: str, value: Any) -> float | None:
        """Return a length along the place; a number if the place has no known unit."""
        kind = next((each for each in KINDS if each.unit == self.units[self.place]), None)
        if kind is not None:
            return keywords.quantity(keyword, value, kind)
        if value is not None and (isinstance(value, bool) or not isinstance(value, Real) or not isfinite(value)):
            raise Refused(f"{keyword}=: {keywords.shown(value)}: a number is needed, {self.place} has no unit")
        return None if value is None else float(value)

    def _column(self, name: str | None) -> Column:
        others = [each for each in self if each != self.place]
        if name is None and len(others) == 1:
            return self[others[0]]
        if name in others and name is not None:
            return self[name]
        raise Refused(f"{self.name}: say which column: {', '.join(others)}" + (f", not {name}" if name else ""))

    @property
    def _heading(self) -> str:
        heading = f"{self.name}: {len(self):,} rows, every {self.step:.6g} {self.units[self.place]}"
        return "\n  ".join([heading, *self.notes])


def _in_working_units(found: Source, unit: Any) -> tuple[list[Column], tuple[str, ...]]:
    """Return the columns of a trace, places first, and its notes; further units that are unknown stay, and are noted.

    ``unit`` replaces that of the one column.
    """
    columns, notes, alone = dict[str, Column](), list(found.notes), len(found.used) == 1
    if unit is not None:
        if not alone:
            raise Refused(f"unit=: {keywords.shown(unit)}: of which column? column= names it")
        keywords.check_own_unit(found, unit)
    if found.placed is None:
        step = np.arange(found.values.size) / (1.0 / found.step)
        columns[found.along] = with_units(step, found.along, "s" if found.along == "time" else "um")
    for number in found.used if found.placed is None else (found.placed, *found.used):
        head, values = found.heads[number], found.arrays[number]
        if head.name in columns:
            own = f"the column {head.name} has no unit of its own; column= leaves it out"
            several = f"two columns are named {head.name}; column= takes one by its number"
            raise Refused(f"{found.where}: {own if found.placed is None and head.name == found.along else several}")
        if unit is not None and number != found.placed:
            units, factor = _given_unit(unit)
        else:
            noted = None if alone or number == found.placed else notes
            units, factor = _working_unit(head.unit, f"{found.where}: {head.written}", noted)
        columns[head.name] = with_units(values if factor == 1.0 else factor * values, head.name, units)
    if alone and found.of_file:
        notes += digits(found.values, found.head.unit)
        notes += [f"{found.head.name}: {said}" for said in (clipped(found.values, found.place),) if said]
    return list(columns.values()), tuple(notes)


def _given_unit(unit: Any) -> tuple[str, float]:
    """Return the working unit of a given unit, and what a value of 1 is in it; volts stay as they are written."""
    scale, is_area, sign = keywords.scale_of(unit, "unit=")
    if scale is None:
        return str(keywords.unit_text(unit)).lstrip("-+ "), sign
    return AREA.unit if is_area else FORCE.unit, sign * scale


def _working_unit(unit: str, what: str, notes: list[str] | None) -> tuple[str, float]:
    """Return the working unit of a unit, and the unit's size in it; a known unit of another kind stays as it is.

    So does an unknown one, which is noted; without ``notes`` it is refused.
    """
    try:
        check_unit(unit, what)
    except Refused as refused:
        if notes is None:
            raise
        notes.append(f"{refused}; it stays as it is")
    read = unit_or_one(unit)
    kind = next((each for each in CONVERTED if each.dimension == read.dimension), None)
    if kind is not None:
        return kind.unit, float(read.size)
    return "1" if unit in NONE else unit, 1.0
