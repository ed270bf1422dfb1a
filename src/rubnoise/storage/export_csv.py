"""A table as CSV: one line of names with units, then one line a row, every number to its last bit."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, TextIO

from rubnoise.storage.schema import Column, Scalar
from rubnoise.storage.table import Table

CHUNK_ROWS: Final = 65_536


def heading(column: Column) -> str:
    """Return a column's name with its unit, in letters that every tool takes for a name: max_area_um2.

    A power loses its ^, a slash reads per, and what is a plain number has no unit: velocity_um_per_s, state.
    """
    unit = column.units.replace("^", "").replace("/", "_per_").replace("*", "_")
    return column.name if unit == "1" else f"{column.name}_{unit}"


def write(path: Path, tables: Sequence[Table], origin: dict[str, Scalar], between: Callable[[], None]) -> None:
    """Write one table; CSV has no place for its origin."""
    del origin
    (table,) = tables
    with path.open("w", encoding="ascii", newline="") as stream:
        write_lines(stream, table, between)


def write_lines(stream: TextIO, table: Table, between: Callable[[], None]) -> None:
    """Write the lines of one table to an open text stream, a chunk of rows at a time."""
    row = ",".join(["%r"] * len(table.columns)) + "\n"
    stream.write(",".join(map(heading, table.columns)) + "\n")
    for _, chunk in table.chunks(CHUNK_ROWS):
        stream.write("".join(map(row.__mod__, zip(*(values.tolist() for values in chunk), strict=True))))
        between()
