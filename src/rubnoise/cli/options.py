"""Options that several commands have."""

from typing import Annotated

import typer


def engines() -> tuple[str, ...]:
    """Return the values of --engine, which shells complete; loading the scenario refuses others."""
    return ("events", "batch")


AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="Print only errors.")]
ReplaceFile = Annotated[bool, typer.Option("--force", help="Replace an existing file.")]
Changes = Annotated[list[str] | None, typer.Option("--set", help="Change a key, as for run.", metavar="KEY=VALUE")]
EngineName = Annotated[
    str | None,
    typer.Option(
        help="events or batch, instead of the file's; both give the same bits.",
        metavar="ENGINE",
        autocompletion=engines,
    ),
]
