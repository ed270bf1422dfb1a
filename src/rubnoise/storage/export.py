"""Export of results as CSV, Parquet or netCDF."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import disk_usage
from typing import Final, Literal, TextIO

from rubnoise.errors import OutputRefused, Refused, needing
from rubnoise.storage.output import check_output, naming_file, whole_files
from rubnoise.storage.reader import RunFile
from rubnoise.storage.resume import refusal
from rubnoise.storage.schema import Scalar
from rubnoise.storage.table import TABLES, Table, origin

Kind = Literal["csv", "parquet", "netcdf"]
ENDINGS: Final[dict[Kind, str]] = {"csv": ".csv", "parquet": ".parquet", "netcdf": ".nc"}
TABLES_TOGETHER: Final = frozenset({"netcdf"})
"""Formats of which one file holds several tables."""

Write = Callable[[Path, Sequence[Table], dict[str, Scalar], Callable[[], None]], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """One file to be written: where, in which format, from which groups of the run."""

    path: Path
    kind: Kind
    groups: tuple[str, ...]


def plan(file: RunFile, kind: Kind, *, group: str | None = None, output: Path | None = None) -> list[Export]:
    """Return the files that an export writes: one group or all there are, to ``output`` or into the current folder.

    Raises Refused for a group that the run does not have, and for one output where several files are due.
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
    """Write files from an open run, which get their names once all are whole; memory does not depend on its length.

    ``between`` is called after each chunk of rows and may raise to stop. Raises, before anything is created, Refused
    for a run that is not finished, an output that exists already (unless ``force``) or is the run itself, and
    ExtraMissing; RubnoiseError where the disk fails.
    """
    if not file.provenance["finished"]:
        raise refusal(file.path)
    for each in exports:
        _check(file, each, force=force)
    writers = {each.kind: _writer(each.kind) for each in exports}
    with whole_files([each.path for each in exports], force=force) as parts:
        for part, each in zip(parts, exports, strict=True):
            tables = [Table.of(file, name) for name in each.groups]
            with naming_file(each.path):
                writers[each.kind](part, tables, origin(file), between)


def print_csv(file: RunFile, group: str, stream: TextIO, *, between: Callable[[], None]) -> None:
    """Write one group of an open run as CSV to a text stream, such as standard output; Refused as by ``export``."""
    from rubnoise.storage.export_csv import write_lines

    if not file.provenance["finished"]:
        raise refusal(file.path)
    write_lines(stream, Table.of(file, group), between)


def _check(file: RunFile, each: Export, *, force: bool) -> None:
    paths = check_output(each.path, force=force)
    if paths.final.exists() and paths.final.samefile(file.path):
        raise OutputRefused(f"{each.path}: is the run itself")
    needed, free = sum(Table.of(file, name).bytes for name in each.groups), disk_usage(paths.final.parent).free
    if each.kind == "netcdf" and needed > free:
        raise OutputRefused(f"{each.path}: needs {needed:,} bytes, and the disk has {free:,} free")


def _writer(kind: Kind) -> Write:
    if kind == "parquet":
        with needing("tables", "export --to parquet"):
            from rubnoise.storage.export_parquet import write as write_parquet
        return write_parquet
    if kind == "netcdf":
        with needing("analysis", "export --to netcdf"):
            from rubnoise.storage.export_netcdf import write as write_netcdf
        return write_netcdf
    from rubnoise.storage.export_csv import write

    return write
