"""`rubnoise export`: a result for tools that do not read HDF5."""

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from rubnoise.answer import size
from rubnoise.cli.options import NewFile, ReplaceFiles, ResultFile, option, output
from rubnoise.cli.progress import stoppable

STANDARD_OUTPUT = Path("-")
ExportedGroup = StrEnum("ExportedGroup", "junctions trace slider load landmarks")
ExportFormat = StrEnum("ExportFormat", "csv parquet netcdf")


def export(
    file: ResultFile,
    *,
    kind: Annotated[ExportFormat, option("FORMAT", "csv, parquet or netcdf.", "--to")],
    group: Annotated[
        ExportedGroup | None, option("GROUP", f"One group of the run: {', '.join(ExportedGroup)}; default: all.")
    ] = None,
    output: Annotated[
        NewFile,
        output("OUT", "The file to write, - for standard output (CSV); default: RUN_GROUP.csv and so on, here."),
    ] = None,
    force: ReplaceFiles = False,
) -> None:
    """Write a result as CSV, Parquet or netCDF.

    CSV has units in the names of columns, the others beside them.

    CSV and Parquet files hold one group each, a netCDF file holds all. -o - prints one group as CSV.

    Example: rubnoise export fig5.h5 --to csv --group trace -o trace.csv
    """
    from rubnoise.storage.export import export as write
    from rubnoise.storage.export import plan, write_csv
    from rubnoise.storage.reader import open_run

    printed = output == STANDARD_OUTPUT
    if printed and kind is not ExportFormat.csv:
        raise typer.BadParameter(f"-o -: only CSV goes to standard output; {kind} is binary: name a file")
    if printed and force:
        raise typer.BadParameter("--force replaces files; standard output is not a file")
    with open_run(file) as run, stoppable() as between:
        files = plan(run, kind.value, group and group.value, output)  # type: ignore[arg-type]  # one of three
        if printed:
            write_csv(sys.stdout, run, files[STANDARD_OUTPUT][0], between)
            return
        write(run, kind.value, files, force=force, between=between)  # type: ignore[arg-type]
        for path, groups in files.items():
            rows = ", ".join(f"{run.rows(each.name):,} rows of {each.name}" for each in groups)
            print(f"{path}: {rows}, {size(path.stat().st_size)}")
