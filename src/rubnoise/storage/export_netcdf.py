"""Tables as netCDF-4: one at the root, several in groups. Imported only where h5netcdf is."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import h5netcdf
import numpy as np

from rubnoise.storage.pages import unfailing
from rubnoise.storage.schema import Column, Scalar
from rubnoise.storage.table import Table

CHUNK_ROWS: Final = 65_536


def write(path: Path, tables: Sequence[Table], origin: dict[str, Scalar], between: Callable[[], None]) -> None:
    """Write tables with units at their variables and their origin at the root."""
    with unfailing(path) as target, h5netcdf.File(target, "w") as file:
        file.attrs.update(origin)
        for table in tables:
            _write_table(file.create_group(table.group.name) if len(tables) > 1 else file, table, between)


def _write_table(owner: Any, table: Table, between: Callable[[], None]) -> None:
    dimension = table.columns[0].name
    owner.attrs["long_name"] = table.group.long_name
    owner.dimensions = {dimension: table.rows}
    variables = [_variable(owner, column, dimension) for column in table.columns]
    for first, chunk in table.chunks(CHUNK_ROWS):
        for variable, values in zip(variables, chunk, strict=True):
            variable[first : first + values.size] = values
        between()


def _variable(owner: Any, column: Column, dimension: str) -> Any:
    variable = owner.create_variable(column.name, (dimension,), np.dtype(column.dtype))
    variable.attrs.update({"units": column.units, "long_name": column.long_name, "symbol": column.symbol})
    attribute, codes = column.coded
    if codes:
        variable.attrs[attribute] = np.array([number for number, _ in codes], dtype=column.dtype)
        variable.attrs["flag_meanings"] = " ".join(meaning for _, meaning in codes)
    return variable
