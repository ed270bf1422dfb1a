"""A table as CSV: one line of names with units, then one line a row, every number to its last bit."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from rubnoise.storage.schema import Column, Scalar
from rubnoise.storage.table import Table

PANEL_ROWS: Final = 65_536


def heading(column: Column) -> str:
    """Return a column's name with its unit, in letters that every tool takes for a name: max_area_um2.

    A power loses its ^, a slash reads per, and what is a plain number has no unit: velocity_um_per_s, state.
    """
    unit = column.units.replace("^", "").replace("/", "_per_").replace("*", "_")
    return column.name if unit == "1" else f"{column.name}_{unit}"


def write(path: Path, tables: Sequence[Table], origin: dict[str, Scalar], between: Callable[[], None]) -> None:
    """Write one table; of its origin CSV has no place to tell."""
    del origin
    (table,) = tables
    row = ",".join(["%r"] * len(table.columns)) + "\n"
    with path.open("w", encoding="ascii", newline="") as stream:
        stream.write(",".join(map(heading, table.columns)) + "\n")
        for _, panel in table.panels(PANEL_ROWS):
            stream.writelines(map(row.__mod__, zip(*(values.tolist() for values in panel), strict=True)))
            between()
