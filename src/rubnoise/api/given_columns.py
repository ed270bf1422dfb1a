"""Take what a caller has sampled: a file, an array, or a table of pandas, of xarray or our own."""

import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from rubnoise.api.column_group import Columns
from rubnoise.api.columns import Column
from rubnoise.api.keywords import shown
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused, refusing_files
from rubnoise.real_numbers import real_numbers
from rubnoise.storage.foreign import opened
from rubnoise.storage.measured import Asked, Head, Source, head_of, measured
from rubnoise.units import NONE, is_of_pint, spelled, unit_name

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
