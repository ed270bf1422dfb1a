"""Export of results as CSV, Parquet or netCDF: a group is a table, written chunk by chunk."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import disk_usage
from typing import Any, Final, Literal, Self, TextIO

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import OutputRefused, Refused, needing
from rubnoise.record.reader import chunks
from rubnoise.storage.layout import stored_groups
from rubnoise.storage.output import check_output, naming_file, whole_files
from rubnoise.storage.pages import unfailing
from rubnoise.storage.reader import RunFile
from rubnoise.storage.schema import CONVENTIONS, Dataset, Group, Scalar

Kind = Literal["csv", "parquet", "netcdf"]
ENDINGS: Final[dict[Kind, str]] = {"csv": ".csv", "parquet": ".parquet", "netcdf": ".nc"}
TABLES_TOGETHER: Final = frozenset({"netcdf"})
"""Formats of which one file holds several tables."""
ROW_GROUP: Final = 262_144
"""Rows of a row group of a Parquet file."""

TABLES: Final = ("junctions", "trace", "slider", "load", "landmarks")
"""The groups that are exported; the life curve is the same in every run of one pulse."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportTable:
    """One group of an open run file: its columns in order, the one on which the others depend first."""

    file: RunFile
    group: Group
    rows: int

    @classmethod
    def of(cls, file: RunFile, name: str) -> Self:
        """Return a group of the file as a table."""
        group = next(group for group in stored_groups(file.features) if group.name == name)
        return cls(file=file, group=group, rows=file.rows(name))

    @property
    def columns(self) -> tuple[Dataset, ...]:
        """Its columns."""
        return self.group.columns

    def chunks(self, rows: int | None = None) -> Iterator[tuple[int, list[NDArray[Any]]]]:
        """Yield the first row and the columns of each chunk of at most ``size`` rows."""
        for chunk in chunks(self.file, self.group.name, rows):
            yield chunk.first, [chunk[column.name] for column in self.columns]

    @property
    def bytes(self) -> int:
        """Uncompressed size of the columns in bytes."""
        return self.rows * sum(np.dtype(column.dtype).itemsize for column in self.columns)


def origin(file: RunFile) -> dict[str, Scalar]:
    """Return what every export keeps beside the rows: the run that made them, and the scenario to make them again."""
    attributes, provenance = file.attributes, file.provenance
    return {
        "Conventions": CONVENTIONS,
        "title": attributes["title"],
        "source": attributes["source"],
        "history": f"{provenance['finished']} {provenance['command']}",
        "junction_area_formula": attributes["junction_area_formula"],
        "scenario_toml": provenance["scenario_toml"],
        "scenario_resolved": provenance["scenario_resolved"],
        "seed": provenance["seed"],
    }


def heading(column: Dataset) -> str:
    """Return a column's name with its unit, in characters that every tool accepts in a name: max_area_um2.

    A power loses its ^, a slash becomes per, and a pure number has no unit: velocity_um_per_s, state.
    """
    unit = column.units.replace("^", "").replace("/", "_per_").replace("*", "_")
    return column.name if unit == "1" else f"{column.name}_{unit}"


def write_csv(
    path: Path, tables: Sequence[ExportTable], origin: dict[str, Scalar], between: Callable[[], None]
) -> None:
    """Write one table as CSV, which has no place for its origin."""
    del origin
    (table,) = tables
    with path.open("w", encoding="ascii", newline="") as stream:
        write_lines(stream, table, between)


def write_lines(stream: TextIO, table: ExportTable, between: Callable[[], None]) -> None:
    """Write the lines of one table to an open text stream, a chunk of rows at a time."""
    row = ",".join(["%r"] * len(table.columns)) + "\n"
    stream.write(",".join(map(heading, table.columns)) + "\n")
    for _, chunk in table.chunks():
        stream.write("".join(map(row.__mod__, zip(*(values.tolist() for values in chunk), strict=True))))
        between()


def write_netcdf(
    path: Path, tables: Sequence[ExportTable], origin: dict[str, Scalar], between: Callable[[], None]
) -> None:
    """Write tables as netCDF, with units as attributes of variables and the origin as attributes of the root.

    One table is written into the root, several into groups.
    """
    with needing("analysis", "export --to netcdf"):
        import h5netcdf
    with unfailing(path) as target, h5netcdf.File(target, "w") as file:
        file.attrs.update(origin)
        for table in tables:
            _write_table(file.create_group(table.group.name) if len(tables) > 1 else file, table, between)


def _write_table(owner: Any, table: ExportTable, between: Callable[[], None]) -> None:
    dimension = table.columns[0].name
    owner.attrs["long_name"] = table.group.long_name
    owner.dimensions = {dimension: table.rows}
    variables = [_variable(owner, column, dimension) for column in table.columns]
    for first, chunk in table.chunks():
        for variable, values in zip(variables, chunk, strict=True):
            variable[first : first + values.size] = values
        between()


def _variable(owner: Any, column: Dataset, dimension: str) -> Any:
    variable = owner.create_variable(column.name, (dimension,), np.dtype(column.dtype))
    variable.attrs.update({"units": column.units, "long_name": column.long_name, "symbol": column.symbol})
    attribute, codes = column.coded
    if codes:
        variable.attrs[attribute] = np.array([number for number, _ in codes], dtype=column.dtype)
        variable.attrs["flag_meanings"] = " ".join(meaning for _, meaning in codes)
    return variable


def write_parquet(
    path: Path, tables: Sequence[ExportTable], origin: dict[str, Scalar], between: Callable[[], None]
) -> None:
    """Write one table, a chunk to a row group; its origin goes into the metadata of the schema."""
    with needing("tables", "export --to parquet"):
        import pyarrow as pa
        import pyarrow.parquet as pq
    (table,) = tables
    about = {"group": table.group.name, "long_name": table.group.long_name} | origin
    schema = pa.schema(map(_field, table.columns), metadata={name: str(value) for name, value in about.items()})
    with pq.ParquetWriter(path, schema, compression="zstd", use_dictionary=False) as writer:
        for _, chunk in table.chunks(ROW_GROUP):
            writer.write_table(pa.table(list(map(pa.array, chunk)), schema=schema))
            between()


def _field(column: Dataset) -> Any:
    import pyarrow as pa

    about = {"units": column.units, "long_name": column.long_name, "symbol": column.symbol}
    _, codes = column.coded
    if codes:
        about["flags"] = " ".join(f"{number}:{meaning}" for number, meaning in codes)
    return pa.field(column.name, pa.from_numpy_dtype(column.dtype), nullable=False, metadata=about)


Write = Callable[[Path, Sequence[ExportTable], dict[str, Scalar], Callable[[], None]], None]
WRITERS: Final[Mapping[Kind, Write]] = {"csv": write_csv, "parquet": write_parquet, "netcdf": write_netcdf}


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """A file to be written: its path, its format, and the groups of the run."""

    path: Path
    kind: Kind
    groups: tuple[str, ...]


def plan(file: RunFile, kind: Kind, *, group: str | None = None, output: Path | None = None) -> list[Export]:
    """Return the files that an export writes: of one group or of all, to ``output`` or into the current folder.

    Raises Refused for a group that the run does not have, and if ``output`` is given for several files.
    """
    there = tuple(name for name in TABLES if name in file.columns)
    if group is not None and group not in there:
        raise Refused(f"{file.path}: the run has no {group}; it has {', '.join(there)}")
    groups = there if group is None else (group,)
    stem, ending = file.path.stem, ENDINGS[kind]
    if kind in TABLES_TOGETHER:
        name = f"{stem}{ending}" if group is None else f"{stem}_{group}{ending}"
        return [Export(path=output or Path(name), kind=kind, groups=groups)]
    if output is not None and len(groups) > 1:
        raise Refused(f"{output}: one {kind} file holds one group; say which with --group {'|'.join(there)}")
    return [Export(path=output or Path(f"{stem}_{name}{ending}"), kind=kind, groups=(name,)) for name in groups]


def export(file: RunFile, exports: Sequence[Export], *, force: bool, between: Callable[[], None]) -> None:
    """Write files from an open run; they get their names when all are complete. Memory does not grow with its length.

    ``between`` is called after each chunk of rows and may raise to stop. Raises, before anything is created, Refused
    for an output that exists already (unless ``force``) or is the run itself, and
    ExtraMissing; RubnoiseError if the disk fails.
    """
    for each in exports:
        _check(file, each, force=force)
    with whole_files([each.path for each in exports], force=force) as parts:
        for part, each in zip(parts, exports, strict=True):
            tables = [ExportTable.of(file, name) for name in each.groups]
            with naming_file(each.path):
                WRITERS[each.kind](part, tables, origin(file), between)


def print_csv(file: RunFile, group: str, stream: TextIO, *, between: Callable[[], None]) -> None:
    """Write one group of an open run as CSV to a text stream, such as standard output."""
    write_lines(stream, ExportTable.of(file, group), between)


def _check(file: RunFile, each: Export, *, force: bool) -> None:
    paths = check_output(each.path, force=force)
    if paths.final.exists() and paths.final.samefile(file.path):
        raise OutputRefused(f"{each.path}: is the run itself")
    needed, free = sum(ExportTable.of(file, name).bytes for name in each.groups), disk_usage(paths.final.parent).free
    if each.kind == "netcdf" and needed > free:
        raise OutputRefused(f"{each.path}: needs {needed:,} bytes, and the disk has {free:,} free")
