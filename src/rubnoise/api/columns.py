"""The columns of one group of a result, by name, and what xarray and pandas make of them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from rubnoise.api.column import Column
from rubnoise.errors import needing
from rubnoise.storage import schema

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    import xarray as xr


class Columns:
    """The columns of one group of a result, by name: ``run.trace["real_contact_area"]``.

    ``len`` is the number of rows; iteration gives the names, the column first on which the others depend.
    """

    def __init__(self, about: schema.Group, columns: Mapping[str, Column]) -> None:
        """Stand for the columns of a group that a result has."""
        self.name = about.name
        self.long_name = about.long_name
        self._columns = dict(columns)

    def __getitem__(self, name: str) -> Column:
        """Return one column, unread; raises KeyError with the names there are."""
        if name not in self._columns:
            raise KeyError(f"/{self.name} has no column {name!r}; it has {', '.join(self.names)}")
        return self._columns[name]

    def __len__(self) -> int:
        return len(next(iter(self._columns.values())))

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, the one that the others depend on first."""
        return tuple(self._columns)

    def keys(self) -> Iterable[str]:
        """Return the names, so that ``dict(run.trace)`` is a dictionary of columns."""
        return self.names

    def to_xarray(self, *, index: bool = True) -> "xr.Dataset":
        """Return the group as an xarray Dataset with units, its variables read when they are asked for.

        The first column becomes the coordinate. With ``index`` that one is read now (8 bytes a row; row numbers need
        no reading), so that ``.sel`` finds rows by it; without, nothing is. Raises ExtraMissing without xarray.
        """
        with needing("analysis", "to_xarray"):
            from rubnoise.api import labelled
        return labelled.dataset(self._columns, index=index)

    def to_pandas(self, names: Sequence[str] | None = None) -> "pd.DataFrame":
        """Read the group, or the columns named, into a pandas DataFrame whose index is the first column.

        Units are in ``frame.attrs["units"]``, by name. Raises KeyError for a name that is none, ExtraMissing without
        pandas.
        """
        with needing("analysis", "to_pandas"):
            import pandas as pd
        scale, *rest = self.names
        chosen = [name for name in (rest if names is None else names) if name != scale]
        frame = pd.DataFrame({name: self[name][:] for name in chosen}, index=pd.Index(self[scale][:], name=scale))
        frame.attrs["units"] = {name: self[name].units for name in (scale, *chosen)}
        return frame

    def __repr__(self) -> str:
        width = max(map(len, self.names))
        lines = [f"  {name:<{width}}  {each.units:<5}  {each.long_name}" for name, each in self._columns.items()]
        return "\n".join([f"/{self.name}: {self.long_name}, {len(self):,} rows", *lines])
