"""Columns: numpy arrays that know their name, unit and meaning, and tables of them: groups of results and others."""

from collections.abc import Callable, ItemsView, Iterable, Iterator, Mapping, Sequence, ValuesView
from functools import partial
from typing import Any, Final, Self

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rubnoise.api.keywords import shown
from rubnoise.api.notebook import DataFrame, Dataset, Displayed, Overview
from rubnoise.arrays import CHUNK_ROWS, slices
from rubnoise.errors import Refused, needing
from rubnoise.figures import Axes, Figure
from rubnoise.record.rows import Rows
from rubnoise.storage import schema

SHOWN_WHOLE = 4  # rows of a column that are all shown; of a longer one, the first three and the last
Place = Callable[[], "Column"]  # returns the column over which another one is drawn


def _said(what: str, meaning: str) -> Any:
    """Return a property that says what is known of a column."""

    def say(column: "Column") -> str:
        if column.about is None:
            raise AttributeError(f"an array that was computed from a column has no {what}", name=what, obj=column)
        return str(getattr(column.about, what))

    return property(say, doc=meaning)


class Column(np.ndarray[Any, np.dtype[Any]]):
    """One column of a result: a numpy array with ``name``, ``units``, ``long_name`` and ``symbol``.

    Slices, chosen rows, sorted and other copies, and pickles of it have them, too; anything else that is computed from
    it, such as ``2 * column`` or ``column.argsort()``, has none. ``run.trace["distance"]`` reads the column each time,
    or maps it if it has more than 64 MB, so keep it for a loop. It may be changed: the run remains as it is.
    """

    about: schema.Dataset | None = None
    _place: Place | None = None

    def __new__(cls, values: NDArray[Any], about: schema.Dataset, place: Place | None = None) -> Self:
        """Take an array, its description, and what returns the column over which it is drawn."""
        self = np.asarray(values).view(cls)
        self.about, self._place = about, place
        return self

    def _described(self, values: NDArray[Any], place: Place | None) -> "Column":
        return values if self.about is None else Column(values, self.about, place)  # type: ignore[return-value]

    def __getitem__(self, index: Any) -> Any:
        """Return a number, or rows with their unit."""
        found = super().__getitem__(index)
        if not isinstance(found, np.ndarray):
            return found
        place = self._place if found.ndim == self.ndim else None
        return self._described(found, None if place is None else lambda: place()[index])

    def copy(self, order: Any = "C") -> "Column":
        """Return a copy with its unit."""
        return self._described(super().copy(order), self._place)

    def __deepcopy__(self, *_memo: Any) -> "Column":
        return self.copy()

    __copy__ = __deepcopy__

    def __reduce__(self) -> tuple[Any, ...]:
        values = np.asarray(self)
        return (np.asarray, (values,)) if self.about is None else (Column, (values, self.about))

    def sort(self, *given: Any, **named: Any) -> None:
        """Sort the rows in place, which then belong to no place any more."""
        super().sort(*given, **named)
        self._place = None

    def __array_wrap__(self, found: Any, context: Any = None, return_scalar: bool = False) -> Any:  # noqa: FBT001, FBT002
        """Return what is computed as a plain array or number (numpy's protocol)."""
        return found[()] if return_scalar else np.asarray(found)

    name: str = _said("name", "The name in its group; raises AttributeError, as the ones below, for what was computed.")
    units: str = _said("units", 'The unit, such as "um^2".')
    long_name: str = _said("long_name", "The meaning in words.")
    symbol: str = _said("symbol", "The symbol in equations.")

    @property
    def label(self) -> str:
        """Meaning and unit, for an axis."""
        return f"{self.long_name or self.name} ({self.units})"

    @property
    def beside(self) -> "Column | None":
        """The same rows of the first column of its group, over which it is drawn; None if it has none."""
        return None if self._place is None else self._place()

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit, meaning, symbol and flags, as the dataset in the file has them."""
        said = {} if self.about is None else self.about.attributes
        return {name: value for name, value in said.items() if not isinstance(value, str) or value}

    @property
    def values(self) -> NDArray[Any]:
        """The rows as a plain array, under the name that pandas and xarray use."""
        return np.asarray(self)

    def to_numpy(self, dtype: DTypeLike | None = None, *, copy: bool = True) -> NDArray[Any]:  # noqa: ARG002
        """Return a plain array, of another type if one is given (``copy`` is always true)."""
        return np.array(self, dtype=dtype)

    def chunks(self, rows: int = CHUNK_ROWS) -> Iterator["Column"]:
        """Yield the column as arrays of ``rows`` rows, the last one shorter."""
        for part in slices(0, self.shape[0], rows):
            yield self[part]

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the column over the first one of its group, or over its rows, and return the figure, that of ``ax``."""
        from rubnoise.api.pictures import drawn_columns

        place = self.beside
        along = (np.arange(self.size), "row") if place is None else (place.values, place.label)
        return drawn_columns(along, [(self.values, self.label)], ax)

    def __repr__(self) -> str:
        if self.about is None or self.ndim != 1:
            return repr(np.asarray(self))
        unit = f" ({self.units})" if self.units else ""
        text = f"{self.name}{unit}, {self.size:,} rows of {'text' if self.dtype.kind == 'U' else self.dtype}"
        rows = [f"{each:.40}" if isinstance(each, str) else f"{each:.6g}" for each in (*self[:3], *self[3:][-1:])]
        return f"<{text}: {' '.join([*rows[:3], *(['...'] if self.size > SHOWN_WHOLE else []), *rows[3:]])}>"


def with_units(values: NDArray[Any], name: str, units: str, long_name: str = "") -> Column:
    """Return an array as a column of which no more is known than its name, its unit and perhaps its meaning."""
    return Column(values, schema.Dataset(name=name, units=units, symbol="", long_name=long_name))


# Groups of columns.
Read = Callable[..., NDArray[Any]]
"""Returns rows of a column by its name, all of them or from a first one to a last one."""


class Columns(Displayed, dict[str, Column]):
    """The columns of one group of a result, by name: ``run.trace["real_contact_area"]``, each read when it is needed.

    ``len`` is the number of rows; iteration gives the names, the column first on which the others depend. It is a dict
    for pandas, of which ``pd.DataFrame(run.trace)`` makes a table.
    """

    def __init__(self, name: str, long_name: str, columns: Mapping[str, schema.Dataset], rows: int, read: Read) -> None:
        """Take descriptions of the columns of a group, the number of their rows, and what reads some of them."""
        self.name, self.long_name = name, long_name
        self._columns, self._length, self._read = dict(columns), rows, read

    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return dict.__new__, (type(self),), self.__dict__

    def __getitem__(self, name: str) -> Column:
        """Read one column; raises KeyError, which lists the names."""
        if not isinstance(name, str):
            raise KeyError(f"{self._called} has columns by name, {', '.join(self.names)}; {self._instead_of(name)}")
        if name not in self._columns:
            homes = [group.name for group in schema.GROUPS if any(each.name == name for each in group.columns)]
            other = f"; run.{homes[0]}[{name!r}] has it, if the run has it" if homes else ""
            raise KeyError(f"{self._called} has no column {name!r}; it has {', '.join(self.names)}{other}")
        place = None if name == self.names[0] else partial(self.__getitem__, self.names[0])
        rows = self._read(name)
        is_shared = isinstance(rows.base, np.ndarray) or not rows.flags.writeable
        return Column(rows.copy() if is_shared else rows, self._columns[name], place)

    @property
    def _called(self) -> str:
        return f"/{self.name}" if self.long_name else self.name

    def _instead_of(self, index: Any) -> str:
        if isinstance(index, list | tuple) and all(isinstance(each, str) for each in index):
            return f"to_pandas({list(index)!r}) has several"
        return f"a column has the rows: [{self.names[-1]!r}][{shown(index)}], and run.junction(17) is one junction"

    def __getattr__(self, name: str) -> Column:
        """Return a column by its name, as `[name]` does; use that for a column with the name of a method."""
        columns = self.__dict__.get("_columns", {})
        if name in columns:
            return self[name]
        hint = "; .names lists the columns, len() counts the rows" if name in ("columns", "shape", "size") else ""
        known = f"it has {', '.join(columns)}{hint}"
        raise AttributeError(f"{self._called if columns else type(self)} has no column {name!r}; {known}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._columns]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.names)

    def __len__(self) -> int:
        return self._length

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, first the one that the others depend on."""
        return tuple(self._columns)

    def keys(self) -> Iterable[str]:  # type: ignore[override]
        """Return the names, so that ``dict(run.trace)`` is a dictionary of columns."""
        return self.names

    def values(self) -> ValuesView[Column]:  # type: ignore[override]
        """Return the columns, each read when its turn comes."""
        return ValuesView(self)

    def items(self) -> ItemsView[str, Column]:  # type: ignore[override]
        """Return names and columns."""
        return ItemsView(self)

    def get(self, name: str, default: Any = None) -> Any:
        """Return a column, or the default if there is none of that name."""
        return Mapping.get(self, name, default)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each column by its name."""
        return {name: about.units for name, about in self._columns.items()}

    def head(self, rows: int = 5) -> "DataFrame":
        """Return the first rows as a pandas DataFrame; raises ExtraMissing without pandas."""
        return self._chosen(np.arange(min(max(rows, 0), len(self)))).to_pandas()

    @property
    def iloc(self) -> Any:
        """Rows by their numbers, as pandas has them: ``run.junctions.iloc[17]``; reads the whole group."""
        return self.to_pandas().iloc

    def where(self, condition: str) -> "Columns":
        """Return the rows for which a condition holds: ``run.junctions.where("diameter > 6 um and not alive_at_end")``.

        A condition compares columns with numbers, with units if you like; ``and``, ``or``, ``not`` and parentheses join
        conditions, and a state of a junction, such as ``ended_early``, is one by itself. Only the columns of the
        condition are read now. Raises Refused, with a mark below what is wrong.

        >>> import rubnoise
        >>> with rubnoise.open("fig5.h5") as run:
        ...     large = run.junctions.where("diameter > 6 um and not alive_at_end")
        ...     len(large) < len(run.junctions), bool(large["diameter"].min() > 6.0)
        (True, True)
        """
        from rubnoise.analysis.where import Condition

        if not isinstance(condition, str):
            raise Refused(f'where: {shown(condition)}: is no text; right form: where("diameter > 6 um")')
        node = Condition(condition, list(self._columns.values()), "where")
        rows = [np.zeros(0, dtype=np.int64)]
        for part in slices(0, len(self)):
            right = node.chosen({name: self._read(name, part.start, part.stop) for name in node.columns})
            rows.append(part.start + np.flatnonzero(right))
        return self._chosen(np.concatenate(rows))

    def _chosen(self, numbers: NDArray[np.int64]) -> "Columns":
        """Return rows by their numbers, which ascend."""
        return Columns(self.name, self.long_name, self._columns, numbers.size, partial(_rows_of, self._read, numbers))

    @property
    def _heading(self) -> str:
        """The first line of the table as it is shown."""
        return f"{self._called}: {f'{self.long_name}, ' if self.long_name else ''}{len(self):,} rows"

    def _overview(self) -> Overview:
        """Return name and unit of each column, and its meaning, or its range if that is not known."""
        rows = [(name, each.units, each.long_name or self._range(name)) for name, each in self._columns.items()]
        return self._heading, ("column", "unit", ""), rows, ()

    def _range(self, name: str) -> str:
        column = self[name]
        return f"{column.min():.6g} to {column.max():.6g}"

    def plot(self, name: str | None = None) -> "Figure":
        """Draw a column over the first one, all of them without a name, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        place, *columns = (self[each] for each in (self.names if name is None else (self.names[0], name)))
        return drawn_columns((place.values, place.label), [(each.values, each.label) for each in columns])

    def to_pandas(self, names: Sequence[str] | None = None) -> "DataFrame":
        """Return all columns, or those (or the one) named, as a pandas DataFrame whose index is the first column.

        Units are in ``frame.attrs["units"]``, by name. Raises KeyError for an unknown name, ExtraMissing without
        pandas.
        """
        with needing("analysis", "to_pandas"):
            import pandas as pd  # type: ignore[import-untyped]
        scale, *rest = self.names
        asked = rest if names is None else [names] if isinstance(names, str) else names
        columns = {name: self[name] for name in (scale, *asked)}
        frame = pd.DataFrame({name: column.values for name, column in columns.items()}).set_index(scale)
        frame.attrs["units"] = {name: column.units for name, column in columns.items()}
        return frame

    def to_xarray(self, *, index: bool = True) -> "Dataset":
        """Return all columns as an xarray Dataset with units; a column of a file above 64 MB is read when it is needed.

        The first column becomes the coordinate: with ``index`` ``.sel`` finds rows by it. Raises ExtraMissing without
        xarray.
        """
        with needing("analysis", "to_xarray"):
            import xarray as xr
        scale = self.names[0]
        variables = {name: xr.Variable((scale,), each.values, each.attributes) for name, each in self.items()}
        place = {scale: variables.pop(scale)}
        coordinates = place if index else xr.Coordinates(place, indexes={})
        return xr.Dataset(variables, coords=coordinates, attrs={"title": self.name})


def _rows_of(
    read: Read, numbers: NDArray[np.int64], name: str, start: int = 0, stop: int | None = None
) -> NDArray[Any]:
    """Return rows of a column that were chosen, in ascending order, from the stretch that has them."""
    numbers = numbers[start:stop]
    first, last = (int(numbers[0]), int(numbers[-1]) + 1) if numbers.size else (0, 0)
    rows: NDArray[Any] = read(name, first, last)[numbers - first]
    return rows


class Table(Columns):
    """Columns in memory, the first of which is the place of the others."""

    def __init__(self, name: str, columns: Sequence[Column], long_name: str = "") -> None:
        """Take columns of equal length, and what they are in words."""
        arrays = {column.name: column.values for column in columns}
        about = {column.name: column.about for column in columns if column.about is not None}
        super().__init__(name, long_name, about, len(next(iter(arrays.values()))), partial(_kept, arrays))


def _kept(arrays: Mapping[str, NDArray[Any]], name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
    return arrays[name][start:stop]


def columns_by_group(rows: Rows) -> dict[str, Columns]:
    """Return the columns of every group that a run has, in a file or in memory, each read when it is needed."""
    features, groups = schema.motion_of(rows.columns["junctions"]), {}
    for group in (each.as_in(features) for each in schema.GROUPS if each.name in rows.columns):
        found = {about.name: about for about in group.columns if about.name in rows.columns[group.name]}
        read = partial(rows.column, group.name)
        groups[group.name] = Columns(group.name, group.long_name, found, rows.rows(group.name), read)
    return groups


SHORT: Final = {"area": "real_contact_area", "force": "friction_force", "count": "junction_count"}
"""Columns by the words that pictures have for them."""

_FIRST: Final = dict.fromkeys(("real_contact_area", "junction_count", "distance"), ("trace",)) | dict.fromkeys(
    ("friction_force", "time", "displacement", "velocity"), ("slider", "trace")
)
"""Columns that need no group, though others have columns of that name, and whose they are: of the first that has it."""

_MAIN: Final = ("junctions", "trace", "slider", "load")
"""The groups in which a name is looked for first: their rows are the run, those of others are about it."""


def homes_of(groups: Mapping[str, Columns], name: str) -> list[str]:
    """Return the groups whose column a run may mean by a name alone: one, if the name needs no group."""
    name = SHORT.get(name, name)
    homes = [group for group in groups if name in groups[group]]
    if name in _FIRST:
        return [group for group in _FIRST[name] if group in homes][:1]
    return [group for group in homes if group in _MAIN] or homes
