"""Columns with units over the first one of them: of groups, traces and spectra, as pandas and xarray have them."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rubnoise.api.columns import Column
from rubnoise.errors import needing
from rubnoise.tables import as_html, shortened

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    import xarray as xr
    from matplotlib.figure import Figure


class Table(ABC):
    """What has columns of equal length, by name."""

    __slots__ = ()

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the columns, first the one that the others depend on."""

    @abstractmethod
    def _described(self, name: str) -> Column:
        """Return a column with its unit; raises KeyError for an unknown name."""

    @property
    @abstractmethod
    def _heading(self) -> str:
        """The first line of the table as it is shown."""

    @property
    def _title(self) -> str:
        """What xarray has as the title of all of it; empty for none."""
        return ""

    def _rows(self) -> list[tuple[str, str, str]]:
        """Return name, unit and range of each column, as texts."""
        columns = {name: self._described(name) for name in self.names}
        return [(name, each.units, f"{each.min():.6g} to {each.max():.6g}") for name, each in columns.items()]

    def __repr__(self) -> str:
        rows = self._rows()
        width = max(len(name) for name, _, _ in rows)
        return shortened([self._heading, *(f"  {name:<{width}}  {unit:<5}  {text}" for name, unit, text in rows)])

    def _repr_html_(self) -> str:
        return as_html(self._heading, ("column", "unit", ""), self._rows())

    def plot(self, name: str | None = None) -> "Figure":
        """Draw a column over the first one, all of them without a name, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        place, *columns = (self._described(each) for each in (self.names if name is None else (self.names[0], name)))
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
        columns = {name: self._described(name) for name in (scale, *asked)}
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
        columns = {name: self._described(name) for name in self.names}
        variables = {name: xr.Variable((scale,), each.values, each.attributes) for name, each in columns.items()}
        place = {scale: variables.pop(scale)}
        coordinates = place if index else xr.Coordinates(place, indexes={})
        return xr.Dataset(variables, coords=coordinates, attrs={"title": self._title} if self._title else {})
