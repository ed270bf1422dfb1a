"""The columns of one group of a result, by name."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.api.columns import Column
from rubnoise.api.keywords import shown
from rubnoise.arrays import slices
from rubnoise.errors import Refused, needing
from rubnoise.record.reader import Rows
from rubnoise.storage import schema
from rubnoise.tables import as_html, shortened

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    import xarray as xr
    from matplotlib.figure import Figure


Read = Callable[..., NDArray[Any]]
"""Returns rows of a column by its name, all of them or from a first one to a last one, as an array of their own."""


def _chosen(read: Read, numbers: NDArray[np.int64], name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
    """Return rows of a column that were chosen, in ascending order, from the stretch that has them."""
    numbers = numbers[start:stop]
    first, last = (int(numbers[0]), int(numbers[-1]) + 1) if numbers.size else (0, 0)
    rows: NDArray[Any] = read(name, first, last)[numbers - first]
    return rows


class Columns(dict[str, Column]):
    """The columns of one group of a result, by name: ``run.trace["real_contact_area"]``, each read when it is needed.

    ``len`` is the number of rows; iteration gives the names, the column first on which the others depend. It is a dict
    for pandas, of which ``pd.DataFrame(run.trace)`` makes a table.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     run.trace.names, len(run.trace)
    (('distance', 'real_contact_area', 'junction_count', 'friction_force'), 200001)
    """

    def __init__(self, about: schema.Group, columns: Mapping[str, schema.Dataset], rows: int, read: Read) -> None:
        """Take descriptions of the columns of a group, the number of their rows, and what reads some of them."""
        self.name, self.long_name = about.name, about.long_name
        self._about, self._called = about, f"/{about.name}" if about.long_name else about.name
        self._columns = dict(columns)
        self._length, self._read = rows, read

    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _unread, (type(self), self.__dict__)

    def __getitem__(self, name: str) -> Column:
        """Read one column; raises KeyError, which lists the names."""
        if not isinstance(name, str):
            raise KeyError(f"{self._called} has columns by name, {', '.join(self.names)}; {self._instead_of(name)}")
        if name not in self._columns:
            homes = [group.name for group in schema.GROUPS if any(each.name == name for each in group.columns)]
            other = f"; run.{homes[0]}[{name!r}] has it, if the run has it" if homes else ""
            raise KeyError(f"{self._called} has no column {name!r}; it has {', '.join(self.names)}{other}")
        place = None if name == self.names[0] else partial(self.__getitem__, self.names[0])
        return Column(self._read(name), self._columns[name], place)

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

    def values(self) -> Iterable[Column]:  # type: ignore[override]
        """Return the columns, each read when its turn comes."""
        return (self[name] for name in self.names)

    def items(self) -> Iterable[tuple[str, Column]]:  # type: ignore[override]
        """Return names and columns."""
        return ((name, self[name]) for name in self.names)

    def get(self, name: str, default: Any = None) -> Any:
        """Return a column, or the default if there is none of that name."""
        return self[name] if name in self else default  # noqa: SIM401  (get is what is defined here)

    def head(self, rows: int = 5) -> "pd.DataFrame":
        """Return the first rows as a pandas DataFrame; raises ExtraMissing without pandas."""
        first = np.arange(min(max(rows, 0), len(self)))
        return Columns(self._about, self._columns, first.size, partial(_chosen, self._read, first)).to_pandas()

    @property
    def iloc(self) -> Any:
        """Rows by their numbers, as pandas has them: ``run.junctions.iloc[17]``; reads the whole group."""
        return self.to_pandas().iloc

    @property
    def units(self) -> dict[str, str]:
        """The unit of each column by its name."""
        return {name: about.units for name, about in self._columns.items()}

    def row(self, number: int) -> dict[str, Any]:
        """Read one row, from 0 on: its numbers by the names of their columns."""
        return {name: self._read(name, number, number + 1)[0].item() for name in self.names}

    def where(self, condition: str) -> "Columns":
        """Return the rows for which a condition holds: ``run.junctions.where("diameter > 6 um and not alive_at_end")``.

        A condition compares columns with numbers, with units if you like; ``and``, ``or``, ``not`` and parentheses join
        conditions, and a state of a junction, such as ``ended_early``, is one by itself. Reads the columns of the
        condition now, in pieces, and the others when they are needed. Raises Refused, with a mark below what is
        wrong, for a condition that cannot be understood.

        >>> import rubnoise
        >>> with rubnoise.open("fig5.h5") as run:
        ...     large = run.junctions.where("diameter > 6 um and not alive_at_end")
        ...     len(large) < len(run.junctions), bool(large["diameter"].min() > 6.0)
        (True, True)
        """
        from rubnoise.analysis.where import Condition, ConditionRefused

        if not isinstance(condition, str):
            raise Refused(f'where: {shown(condition)}: is no text; right form: where("diameter > 6 um")')
        try:
            node = Condition(condition, list(self._columns.values()))
        except ConditionRefused as refused:
            raise ConditionRefused(str(refused).replace("--where", "where", 1)) from None
        rows = [np.zeros(0, dtype=np.int64)]
        for part in slices(0, len(self)):
            right = node.chosen({name: self._read(name, part.start, part.stop) for name in node.columns})
            rows.append(part.start + np.flatnonzero(right))
        chosen = np.concatenate(rows)
        return Columns(self._about, self._columns, chosen.size, partial(_chosen, self._read, chosen))

    @property
    def _heading(self) -> str:
        """The first line of the table as it is shown."""
        return f"{self._called}: {f'{self.long_name}, ' if self.long_name else ''}{len(self):,} rows"

    def _rows(self) -> list[tuple[str, str, str]]:
        """Return name and unit of each column, and its meaning, or its range if that is not known."""
        return [(name, each.units, each.long_name or self._range(name)) for name, each in self._columns.items()]

    def _range(self, name: str) -> str:
        column = self[name]
        return f"{column.min():.6g} to {column.max():.6g}"

    def __repr__(self) -> str:
        rows = self._rows()
        width = max(len(name) for name, _, _ in rows)
        return shortened([self._heading, *(f"  {name:<{width}}  {unit:<5}  {text}" for name, unit, text in rows)])

    def _repr_html_(self) -> str:
        return as_html(self._heading, ("column", "unit", ""), self._rows())

    def plot(self, name: str | None = None) -> "Figure":
        """Draw a column over the first one, all of them without a name, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        place, *columns = (self[each] for each in (self.names if name is None else (self.names[0], name)))
        return drawn_columns((place.values, place.label), [(each.values, each.label) for each in columns])

    def to_pandas(self, names: Sequence[str] | None = None) -> "pd.DataFrame":
        """Return all columns, or those (or the one) named, as a pandas DataFrame whose index is the first column.

        Units are in ``frame.attrs["units"]``, by name. Raises KeyError for an unknown name, ExtraMissing without
        pandas.
        """
        with needing("analysis", "to_pandas"):
            import pandas as pd
        scale, *rest = self.names
        asked = rest if names is None else [names] if isinstance(names, str) else names
        columns = {name: self[name] for name in (scale, *asked)}
        units = {name: column.units for name, column in columns.items()}
        place = pd.Index(columns.pop(scale).values, name=scale)
        frame = pd.DataFrame({name: column.values for name, column in columns.items()}, index=place)
        frame.attrs["units"] = units
        return frame

    def to_xarray(self, *, index: bool = True) -> "xr.Dataset":
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


class Table(Columns):
    """Columns in memory, the first of which is the place of the others."""

    def __init__(self, name: str, columns: Mapping[str, Column], long_name: str = "") -> None:
        """Take columns of equal length by their names, and what they are in words."""
        about = {each: column.about for each, column in columns.items() if column.about is not None}
        arrays = {each: column.values for each, column in columns.items()}
        group = schema.Group(name=name, long_name=long_name, columns=(), plotted="")
        super().__init__(group, about, len(next(iter(arrays.values()))), partial(_kept_rows, arrays))


def _unread(kind: type[Columns], state: dict[str, Any]) -> Columns:
    """Return columns that were pickled or copied without their rows."""
    found = kind.__new__(kind)
    found.__dict__.update(state)
    return found


def _kept_rows(arrays: Mapping[str, NDArray[Any]], name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
    """Return rows of an array in memory, which a user may change."""
    return arrays[name][start:stop].copy()


def columns_by_group(rows: Rows) -> dict[str, Columns]:
    """Return the columns of every group that a run has, in a file or in memory, each read when it is needed."""
    features = schema.motion_of(rows.columns["junctions"])
    return {group.name: _columns(rows, group.as_in(features)) for group in schema.GROUPS if group.name in rows.columns}


def _columns(rows: Rows, group: schema.Group) -> Columns:
    found = {about.name: about for about in group.columns if about.name in rows.columns[group.name]}
    return Columns(group, found, rows.rows(group.name), partial(_own_rows, rows, group.name))


def _own_rows(rows: Rows, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
    """Return rows that a user may change, also if they are those of a run in memory."""
    found = rows.column(group, name, start, stop)
    return found.copy() if isinstance(found.base, np.ndarray) or not found.flags.writeable else found


SHORT: Final[Mapping[str, str]] = {
    "area": "real_contact_area",
    "force": "friction_force",
    "count": "junction_count",
}
"""Columns by the words that pictures have for them."""

_OF_THE_TRACE: Final = ("real_contact_area", "junction_count", "distance")
_OF_THE_MOTION: Final = ("friction_force", "time", "displacement", "velocity")
"""Columns that need no group, though others have columns of that name: of /trace, and of /slider where there is one."""

_MAIN: Final = ("junctions", "trace", "slider", "load")
"""The groups in which a name is looked for first: their rows are the run, those of others are about it."""


def homes_of(groups: Mapping[str, Columns], name: str) -> list[str]:
    """Return the groups whose column a run may mean by a name alone: one, if the name needs no group."""
    name = SHORT.get(name, name)
    homes = [group for group in groups if name in groups[group]]
    if name in (*_OF_THE_TRACE, *_OF_THE_MOTION):
        first = ("slider", "trace") if name in _OF_THE_MOTION else ("trace",)
        return [group for group in first if group in homes][:1]
    return [group for group in homes if group in _MAIN] or homes


def names_alone(groups: Mapping[str, Columns]) -> set[str]:
    """Return the names by which a run has a column without its group."""
    names = {*SHORT, *(name for columns in groups.values() for name in columns)}
    return {name for name in names if len(homes_of(groups, name)) == 1}


def group_rows(groups: Mapping[str, Columns]) -> list[tuple[str, str, str]]:
    """Return name, number of rows and columns of each group, as texts."""
    return [(f".{name}", f"{len(group):,}", ", ".join(group)) for name, group in groups.items()]
