"""A table as Parquet, with units at its fields. Imported only where pyarrow is."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import pyarrow as pa
import pyarrow.parquet as pq

from rubnoise.storage.schema import Column, Scalar
from rubnoise.storage.table import Table

CHUNK_ROWS: Final = 262_144


def write(path: Path, tables: Sequence[Table], origin: dict[str, Scalar], between: Callable[[], None]) -> None:
    """Write one table, a chunk to a row group; its origin goes into the metadata of the schema."""
    (table,) = tables
    about = {"group": table.group.name, "long_name": table.group.long_name} | origin
    schema = pa.schema(map(_field, table.columns), metadata={name: str(value) for name, value in about.items()})
    with pq.ParquetWriter(path, schema, compression="zstd", use_dictionary=False) as writer:
        for _, chunk in table.chunks(CHUNK_ROWS):
            writer.write_table(pa.table(list(map(pa.array, chunk)), schema=schema))
            between()


def _field(column: Column) -> pa.Field:
    about = {"units": column.units, "long_name": column.long_name, "symbol": column.symbol}
    _, codes = column.coded
    if codes:
        about["flags"] = " ".join(f"{number}:{meaning}" for number, meaning in codes)
    return pa.field(column.name, pa.from_numpy_dtype(column.dtype), nullable=False, metadata=about)
