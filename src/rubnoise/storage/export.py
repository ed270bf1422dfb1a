"""Export of results as CSV, Parquet or netCDF: a group is a table, written chunk by chunk."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Final, Literal, TextIO

import numpy as np

from rubnoise.errors import Refused, needing
from rubnoise.record.rows import chunks
from rubnoise.storage.format import unfailing
from rubnoise.storage.layout import stored_groups
from rubnoise.storage.output import check_output, whole_file
from rubnoise.storage.reader import RunFile
from rubnoise.storage.schema import CONVENTIONS, Dataset, Group, Scalar

Kind = Literal["csv", "parquet", "netcdf"]
ENDINGS: Final[dict[Kind, str]] = {"csv": ".csv", "parquet": ".parquet", "netcdf": ".nc"}
ROW_GROUP: Final = 262_144  # rows of a row group of a Parquet file
TABLES: Final = ("junctions", "trace", "slider", "load", "landmarks")
"""The groups that are exported; the life curve is the same in every run of one pulse."""


def origin(file: RunFile) -> dict[str, Scalar]:
    """Return what every export keeps beside the rows: the run that made them, and the scenario to make them again."""
    origin = file.provenance
    found = {name: file.attributes[name] for name in ("title", "source", "junction_area_formula")}
    found |= {name: origin[name] for name in ("scenario_toml", "scenario_resolved", "seed")}
    return {"Conventions": CONVENTIONS, "history": f"{origin['finished']} {origin['command']}", **found}


def heading(column: Dataset) -> str:
    """Return a column's name with its unit, in characters that every tool accepts in a name: max_area_um2.

    A power loses its ^, a slash becomes per, and a pure number has no unit: velocity_um_per_s, state.
    """
    unit = column.units.replace("^", "").replace("/", "_per_").replace("*", "_")
    return column.name if unit == "1" else f"{column.name}_{unit}"


def write_csv(stream: TextIO, file: RunFile, group: Group, between: Callable[[], None]) -> None:
    """Write one group as CSV, which has no place for its origin, to a text stream, such as standard output."""
    row = ",".join(["%r"] * len(group.columns)) + "\n"
    stream.write(",".join(map(heading, group.columns)) + "\n")
    for chunk in chunks(file, group.name):
        values = zip(*(chunk[each.name].tolist() for each in group.columns), strict=True)
        stream.write("".join(map(row.__mod__, values)))
        between()


def _write_csv(path: Path, file: RunFile, groups: Sequence[Group], between: Callable[[], None]) -> None:
    with path.open("w", encoding="ascii", newline="") as stream:
        write_csv(stream, file, groups[0], between)


def _write_netcdf(path: Path, file: RunFile, groups: Sequence[Group], between: Callable[[], None]) -> None:
    """Write one group into the root, or several as groups, with units and origin as attributes."""
    with needing("analysis", "export --to netcdf"):
        import h5netcdf
    with path.open("r+b") as stream, unfailing(stream.fileno()) as target, h5netcdf.File(target, "w") as written:
        written.attrs.update(origin(file))
        for group in groups:
            owner, dimension = written.create_group(group.name) if len(groups) > 1 else written, group.columns[0]
            owner.attrs["long_name"] = group.long_name
            owner.dimensions = {dimension.name: file.rows(group.name)}
            for column in group.columns:
                variable = owner.create_variable(column.name, (dimension.name,), np.dtype(column.dtype))
                variable.attrs.update(column.attributes)
            for chunk in chunks(file, group.name):
                for column in group.columns:
                    owner[column.name][chunk.first : chunk.end] = chunk[column.name]
                between()


def _write_parquet(path: Path, file: RunFile, groups: Sequence[Group], between: Callable[[], None]) -> None:
    """Write one group, a chunk to a row group; its origin goes into the metadata of the schema."""
    with needing("tables", "export --to parquet"):
        import pyarrow as pa
        import pyarrow.parquet as pq
    (group,), fields = groups, []
    for column in group.columns:
        about = {"units": column.units, "long_name": column.long_name, "symbol": column.symbol}
        if column.codes:
            about["flags"] = " ".join(f"{number}:{meaning}" for number, meaning in column.codes)
        fields.append(pa.field(column.name, pa.from_numpy_dtype(column.dtype), nullable=False, metadata=about))
    metadata = {"group": group.name, "long_name": group.long_name} | origin(file)
    schema = pa.schema(fields, metadata={name: str(value) for name, value in metadata.items()})
    with pq.ParquetWriter(path, schema, compression="zstd", use_dictionary=False) as writer:
        for chunk in chunks(file, group.name, ROW_GROUP):
            writer.write_table(pa.table([pa.array(chunk[each.name]) for each in group.columns], schema=schema))
            between()


def plan(file: RunFile, kind: Kind, group: str | None, output: Path | None) -> dict[Path, Sequence[Group]]:
    """Return files and their groups; raises Refused for a missing group, and for one file for several groups."""
    there = {each.name: each for each in stored_groups(file.features) if each.name in TABLES}
    if group is not None and group not in there:
        raise Refused(f"{file.path}: the run has no {group}; it has {', '.join(there)}")
    groups = [*there.values()] if group is None else [there[group]]
    stem, ending = file.path.stem, ENDINGS[kind]
    if kind == "netcdf":
        return {output or Path(f"{stem}{ending}" if group is None else f"{stem}_{group}{ending}"): groups}
    if output is not None and len(groups) > 1:
        raise Refused(f"{output}: one {kind} file holds one group; say which with --group {'|'.join(there)}")
    return {output or Path(f"{stem}_{each.name}{ending}"): [each] for each in groups}


def export(
    file: RunFile, kind: Kind, files: Mapping[Path, Sequence[Group]], *, force: bool, between: Callable[[], None]
) -> None:
    """Write files from an open run; they get their names when all are complete. Memory does not grow with its length.

    ``between`` is called after each chunk of rows and may raise to stop. Raises, before anything is created, Refused
    for an output that exists already (unless ``force``) or is the run itself, and ExtraMissing; RubnoiseError if the
    disk fails.
    """
    for path in files:
        check_output(path, force=force, reads=[file.path])
    write = {"csv": _write_csv, "netcdf": _write_netcdf, "parquet": _write_parquet}[kind]
    with ExitStack() as finishing:
        for path, groups in files.items():
            write(finishing.enter_context(whole_file(path, force=force)), file, groups, between)
