"""The columns of one group of a result, by name."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

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


class Columns:
    """The columns of one group of a result, by name: ``run.trace["real_contact_area"]``.

    ``len`` is the number of rows; iteration gives the names, the column first on which the others depend.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     run.trace.names, len(run.trace)
    (('distance', 'real_contact_area', 'junction_count', 'friction_force'), 200001)
    """

    def __init__(self, about: schema.Group, columns: Mapping[str, Column]) -> None:
        """Take the columns of a group of a result."""
        self.name = about.name
        self.long_name = about.long_name
        self._about = about
        self._columns = dict(columns)
        for each in self._columns.values():
            each.beside = self._columns[next(iter(self._columns))]

    def __getitem__(self, name: str) -> Column:
        """Return one column without reading it; raises KeyError, which lists the names."""
        if not isinstance(name, str):
            raise KeyError(f"/{self.name} has columns by name, {', '.join(self.names)}; {self._instead_of(name)}")
        if name not in self._columns:
            homes = [group.name for group in schema.GROUPS if any(each.name == name for each in group.columns)]
            other = f"; run.{homes[0]}[{name!r}] has it, if the run has it" if homes else ""
            raise KeyError(f"/{self.name} has no column {name!r}; it has {', '.join(self.names)}{other}")
        return self._columns[name]

    def _instead_of(self, index: Any) -> str:
        if isinstance(index, list | tuple) and all(isinstance(each, str) for each in index):
            return f"to_pandas({list(index)!r}) has several"
        return f"a column has the rows: [{self.names[-1]!r}][{shown(index)}], and run.junction(17) is one junction"

    def __getattr__(self, name: str) -> Column:
        """Return a column by its name, as `[name]` does; use that for a column with the name of a method."""
        columns = self.__dict__.get("_columns", {})
        if name in columns:
            return columns[name]
        hint = "; .names lists the columns, len() counts the rows" if name in ("columns", "shape", "size") else ""
        known = f"it has {', '.join(columns)}{hint}"
        raise AttributeError(f"/{self.__dict__.get('name', '')} has no column {name!r}; {known}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._columns]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.names)

    def __len__(self) -> int:
        return len(next(iter(self._columns.values())))

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, first the one that the others depend on."""
        return tuple(self._columns)

    def keys(self) -> Iterable[str]:
        """Return the names, so that ``dict(run.trace)`` is a dictionary of columns."""
        return self.names

    def items(self) -> Iterable[tuple[str, Column]]:
        """Return names and columns."""
        return self._columns.items()

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
            node = understood(condition, [each.about for each in self._columns.values()])
        except ConditionRefused as refused:
            raise ConditionRefused(str(refused).replace("--where", "where", 1)) from None
        rows = [np.zeros(0, dtype=np.int64)]
        for part in slices(0, len(self)):
            right = node.chosen({name: self[name][part] for name in node.columns})
            rows.append(part.start + np.flatnonzero(right))
        chosen = np.concatenate(rows)
        return Columns(self._about, {name: each.taken(chosen) for name, each in self._columns.items()})

    def plot(self, name: str) -> "Figure":
        """Draw a column over the first one, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        first = self[self.names[0]]
        labels = [f"{each.long_name} ({each.units})" for each in (first, self[name])]
        return drawn_columns((first[:], labels[0]), [(self[name][:], labels[1])])

    def to_xarray(self, *, index: bool = True) -> "xr.Dataset":
        """Return the group as an xarray Dataset with units, its variables read when they are needed.

        The first column becomes the coordinate. With ``index`` that one is read now (8 bytes a row; row numbers need
        no reading), so that ``.sel`` finds rows by it; without, nothing is. Raises ExtraMissing without xarray.
        """
        with needing("analysis", "to_xarray"):
            from rubnoise.api import labelled
        return labelled.dataset(self._columns, index=index)

    def to_pandas(self, names: Sequence[str] | None = None) -> "pd.DataFrame":
        """Read the group, or the columns (or the one) named, into a pandas DataFrame whose index is the first column.

        Units are in ``frame.attrs["units"]``, by name. Raises KeyError for an unknown name, ExtraMissing without
        pandas.
        """
        with needing("analysis", "to_pandas"):
            import pandas as pd
        scale, *rest = self.names
        asked = rest if names is None else [names] if isinstance(names, str) else names
        chosen = [name for name in asked if name != scale]
        frame = pd.DataFrame({name: self[name][:] for name in chosen}, index=pd.Index(self[scale][:], name=scale))
        frame.attrs["units"] = {name: self[name].units for name in (scale, *chosen)}
        return frame

    def __repr__(self) -> str:
        width = max(map(len, self.names))
        lines = [f"  {name:<{width}}  {each.units:<5}  {each.long_name}" for name, each in self._columns.items()]
        return shortened([f"/{self.name}: {self.long_name}, {len(self):,} rows", *lines])

    def _repr_html_(self) -> str:
        rows = [(name, each.units, each.long_name) for name, each in self._columns.items()]
        return as_html(f"/{self.name}: {self.long_name}, {len(self):,} rows", ("column", "unit", "meaning"), rows)


def columns_by_group(rows: Rows) -> dict[str, Columns]:
    """Return the columns of every group that a run has, in a file or in memory, each read when it is needed."""
    features = schema.motion_of(rows.columns["junctions"])
    return {group.name: _columns(rows, group.as_in(features)) for group in schema.GROUPS if group.name in rows.columns}


def _columns(rows: Rows, group: schema.Group) -> Columns:
    found = {
        about.name: Column(about, rows.rows(group.name), partial(rows.column, group.name, about.name))
        for about in group.columns
        if about.name in rows.columns[group.name]
    }
    return Columns(group, found)


GROUP_HEADS: Final = ("group", "rows", "columns")


def group_rows(groups: Mapping[str, Columns]) -> list[tuple[str, str, str]]:
    """Return name, number of rows and columns of each group, as texts."""
    return [(f".{name}", f"{len(group):,}", ", ".join(group)) for name, group in groups.items()]


def listed(groups: Mapping[str, Columns]) -> list[str]:
    """Return the groups as lines of a text."""
    return [f"  {name:<12} {rows:>12} rows: {columns}" for name, rows, columns in group_rows(groups)]
