"""The columns of one group of a result, by name."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.api.columns import Column, Table
from rubnoise.api.keywords import shown
from rubnoise.arrays import slices
from rubnoise.errors import Refused
from rubnoise.record.reader import Rows
from rubnoise.storage import schema

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]


Read = Callable[..., NDArray[Any]]
"""Returns rows of a column by its name, all of them or from a first one to a last one, as an array of their own."""


def _chosen(read: Read, numbers: NDArray[np.int64], name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
    """Return rows of a column that were chosen, in ascending order, from the stretch that has them."""
    numbers = numbers[start:stop]
    first, last = (int(numbers[0]), int(numbers[-1]) + 1) if numbers.size else (0, 0)
    rows: NDArray[Any] = read(name, first, last)[numbers - first]
    return rows


class Columns(Table, dict[str, Column]):
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
        self.name = about.name
        self.long_name = about.long_name
        self._about = about
        self._columns = dict(columns)
        self._length, self._read = rows, read

    _titled = False
    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return Columns, (self._about, self._columns, self._length, self._read)

    def __getitem__(self, name: str) -> Column:
        """Read one column; raises KeyError, which lists the names."""
        if not isinstance(name, str):
            raise KeyError(f"/{self.name} has columns by name, {', '.join(self.names)}; {self._instead_of(name)}")
        if name not in self._columns:
            homes = [group.name for group in schema.GROUPS if any(each.name == name for each in group.columns)]
            other = f"; run.{homes[0]}[{name!r}] has it, if the run has it" if homes else ""
            raise KeyError(f"/{self.name} has no column {name!r}; it has {', '.join(self.names)}{other}")
        place = None if name == self.names[0] else partial(self.__getitem__, self.names[0])
        return Column(self._read(name), self._columns[name], place)

    def _described(self, name: str) -> Column:
        return self[name]

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
        raise AttributeError(f"/{self.__dict__.get('name', '')} has no column {name!r}; {known}")

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

    # Those of a dict would know nothing of columns that are read when they are needed.
    values, items, get = Mapping.values, Mapping.items, Mapping.get  # type: ignore[assignment]

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
        from rubnoise.analysis.where import ConditionRefused
        from rubnoise.analysis.where import condition as understood

        if not isinstance(condition, str):
            raise Refused(f'where: {shown(condition)}: is no text; right form: where("diameter > 6 um")')
        try:
            node = understood(condition, list(self._columns.values()))
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
        return f"/{self.name}: {self.long_name}, {len(self):,} rows"

    def _rows(self) -> list[tuple[str, str, str]]:
        """Return name, unit and meaning of each column, without reading it."""
        return [(name, each.units, each.long_name) for name, each in self._columns.items()]


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
