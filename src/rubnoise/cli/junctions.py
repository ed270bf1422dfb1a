"""`rubnoise junctions`: the rows of a result that a condition chooses, in the order asked for."""

from pathlib import Path
from typing import Annotated

import typer

ROWS_SHOWN = 20
"""Rows printed as text where nobody said how many."""


def command(
    file: Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5", show_default=False)],
    *,
    where: Annotated[
        str | None,
        typer.Option(
            help="Only rows that meet this condition: columns, numbers (with units), < <= > >= == !=, and, or, not,"
            " parentheses, and the states complete, alive_at_start, alive_at_end, ended_early.",
            metavar="CONDITION",
        ),
    ] = None,
    sort: Annotated[
        str | None, typer.Option(help="Smallest first; -COLUMN: largest first.", metavar="COLUMN", show_default=False)
    ] = None,
    reverse: Annotated[bool, typer.Option("--reverse", help="Reverse the order.")] = False,
    head: Annotated[
        int | None, typer.Option(help="Largest number of rows; default: 20 as text, otherwise all.", metavar="N", min=0)
    ] = None,
    columns: Annotated[str | None, typer.Option(help="The columns to print.", metavar="A,B,...")] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a table with commas, units in its heading.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """List the junctions that meet a condition, in order of birth or of a column.

    Example: rubnoise junctions fig5.h5 --where "diameter > 6 um" --sort life_distance --head 10
    """
    from rubnoise.cli.junction_rows import Found, print_csv, print_json, print_text
    from rubnoise.cli.results import finished_run

    if as_csv and as_json:
        raise typer.BadParameter("only one of --csv and --json")
    show = print_csv if as_csv else print_json if as_json else print_text
    if head is None and show is print_text:
        head = ROWS_SHOWN
    with finished_run(file) as run:
        found = Found.of(
            run, file, where=where, sort=sort, reverse=reverse, head=head, columns=columns, brief=show is print_text
        )
        show(found)
