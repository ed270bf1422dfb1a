"""Arguments and options that several commands have."""

import re
from pathlib import Path
from typing import Annotated, Final

import typer

ResultFile = Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5")]
ResultOrSweep = Annotated[Path, typer.Argument(help="A result file, or the folder of a sweep.", metavar="RUN.h5|DIR")]
StretchStart = Annotated[
    str | None, typer.Option("--from", help="Start of the stretch: um, or with a unit.", metavar="S")
]
StretchEnd = Annotated[str | None, typer.Option("--to", help="End of the stretch.", metavar="S")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="Print only errors.")]
ReplaceFile = Annotated[bool, typer.Option("--force", help="Replace an existing file.")]
ReplaceFiles = Annotated[bool, typer.Option("--force", help="Replace existing files.")]
ReplaceResult = Annotated[bool, typer.Option("--force", help="Replace an existing result.")]
ReplacePlot = Annotated[bool, typer.Option("--force", help="Let --plot replace a file.")]
Changes = Annotated[list[str] | None, typer.Option("--set", help="Change a key, as for run.", metavar="KEY=VALUE")]
NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
"""A number without a unit."""

ENGINES: Final = ("events", "batch")
"""What shells complete; loading the scenario refuses others."""

EngineName = Annotated[
    str | None,
    typer.Option(
        help="events or batch, instead of the file's; both give the same bits.",
        metavar="ENGINE",
        autocompletion=lambda: ENGINES,
    ),
]
