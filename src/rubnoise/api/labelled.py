"""Columns as xarray objects: labelled, with units, read when they are needed. Imported only with xarray."""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from rubnoise.api.columns import Column


class ColumnArray(BackendArray):
    """A column as one of xarray's lazy arrays; copies of it read the same file."""

    def __init__(self, column: Column) -> None:
        """Take a column."""
        self.shape = column.shape
        self.dtype = column.dtype
        self._column = column

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        """Return the rows that xarray needs."""
        support = indexing.IndexingSupport.OUTER_1VECTOR
        return indexing.explicit_indexing_adapter(key, self.shape, support, lambda rows: self._column[rows[0]])

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self


def dataset(columns: Mapping[str, Column], *, index: bool) -> xr.Dataset:
    """Return a Dataset over the first column, which is read only if ``index`` is true."""
    scale = next(iter(columns))
    variables = {name: _variable(scale, column) for name, column in columns.items()}
    coordinate = variables.pop(scale)
    if not index:
        return xr.Dataset(variables, coords=xr.Coordinates({scale: coordinate}, indexes={}))
    if np.issubdtype(coordinate.dtype, np.integer):
        return xr.Dataset(variables, coords=_numbered(scale, columns[scale]))
    return xr.Dataset(variables, coords={scale: coordinate})


def tree(groups: Mapping[str, xr.Dataset], attributes: Mapping[str, Any]) -> xr.DataTree:
    """Return the groups of a result as one tree."""
    found = xr.DataTree.from_dict({f"/{name}": group for name, group in groups.items()})
    found.attrs.update(attributes)
    return found


def _variable(scale: str, column: Column) -> xr.Variable:
    data = indexing.LazilyIndexedArray(ColumnArray(column))
    return xr.Variable((scale,), data, column.attributes)


def _numbered(scale: str, column: Column) -> xr.Coordinates:
    """Return the coordinate of row numbers; only those of chosen rows must be read."""
    import pandas as pd  # type: ignore[import-untyped]

    numbers = pd.Index(column[:], name=scale) if column.is_chosen else pd.RangeIndex(len(column), name=scale)
    return xr.Coordinates({scale: xr.Variable((scale,), numbers, column.attributes)})
