"""Arguments and options that several commands have."""

import re
from pathlib import Path
from typing import Annotated, Any, Final

import typer


def argument(metavar: str, about: str, **more: Any) -> Any:
    """Return an argument of a command, as help shows it."""
    return typer.Argument(help=about, metavar=metavar, **more)


def option(metavar: str, about: str, *names: str, **more: Any) -> Any:
    """Return an option with a value; without ``names`` its name is that of the parameter."""
    return typer.Option(*names, help=about, metavar=metavar, **more)


def output(metavar: str, about: str) -> Any:
    """Return the option for what is written."""
    return option(metavar, about, "-o", "--output")


def flag(about: str, *names: str, **more: Any) -> Any:
    """Return an option without a value."""
    return typer.Option(*names, help=about, **more)


def _one_form(context: typer.Context, *, value: bool) -> bool:
    if value and (context.params.get("as_json") or context.params.get("as_csv")):
        raise typer.BadParameter("only one of --csv and --json")
    return value


NewFile = Path | None
ResultFile = Annotated[Path, argument("RUN.h5", "A result file.")]
ResultOrSweep = Annotated[Path, argument("RUN.h5|DIR", "A result file, or the folder of a sweep.")]
StretchStart = Annotated[str | None, option("S", "Start of the stretch: um, or with a unit.", "--from")]
StretchEnd = Annotated[str | None, option("S", "End of the stretch.", "--to")]
AsJson = Annotated[bool, flag("Print one JSON object and nothing else.", "--json", callback=_one_form)]
AsCsv = Annotated[bool, flag("Print CSV, one line per number.", "--csv", callback=_one_form)]
Quiet = Annotated[bool, flag("Print only errors.", "-q", "--quiet")]
ReplaceFile = Annotated[bool, flag("Replace an existing file.", "--force")]
ReplaceFiles = Annotated[bool, flag("Replace existing files.", "--force")]
ReplaceResult = Annotated[bool, flag("Replace an existing result.", "--force")]
ReplacePlot = Annotated[bool, flag("Let --plot replace a file.", "--force")]
Changes = Annotated[list[str] | None, option("KEY=VALUE", "Change a key, e.g. --set sliding.distance=5mm.", "--set")]
NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
"""A number without a unit."""

EngineName = Annotated[
    str | None,
    option("ENGINE", "events or batch; both give the same bits.", autocompletion=lambda: ("events", "batch")),
]
