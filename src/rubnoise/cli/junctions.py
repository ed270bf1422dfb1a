"""`rubnoise junctions`: the rows of a result that meet a condition, or one of them, as text, CSV or JSON."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Self

import typer

from rubnoise.answer import Answer, Row, Table, printable
from rubnoise.cli.junction import show_life, state_names
from rubnoise.cli.layout import as_wide_text, grouped, json_text
from rubnoise.cli.options import AsJson, ReplacePlot, ResultFile
from rubnoise.errors import Refused

if TYPE_CHECKING:
    from rubnoise.analysis.selection import RowNumbers
    from rubnoise.record.reader import Rows
    from rubnoise.storage.schema import Dataset

ROWS_SHOWN = 20
"""Rows printed as text by default."""


SETTINGS: Final = {"context_settings": {"ignore_unknown_options": True}}
"""Unknown options pass, so that the row number -1 gets its own answer; the command refuses the others."""


def command(
    file: ResultFile,
    number: Annotated[
        str | None,
        typer.Argument(help="Row number of one junction, from 0 in order of birth, to show its life.", metavar="N"),
    ] = None,
    picture: Annotated[
        Path | None, typer.Argument(help="The png file of --plot; default: a name from RUN and N.", metavar="FILE.png")
    ] = None,
    *,
    where: Annotated[
        str | None,
        typer.Option(
            help="Only rows that meet this condition: columns, numbers (with units), < <= > >= == !=, and, or, not,"
            " parentheses, and the states complete, alive_at_start, alive_at_end, ended_early.",
            metavar="CONDITION",
        ),
    ] = None,
    sort: Annotated[str | None, typer.Option(help="Smallest first; -COLUMN: largest first.", metavar="COLUMN")] = None,
    reverse: Annotated[bool, typer.Option("--reverse", help="Reverse the order.")] = False,
    head: Annotated[
        int | None, typer.Option(help="Largest number of rows; default: 20 as text, otherwise all.", metavar="N", min=0)
    ] = None,
    columns: Annotated[str | None, typer.Option(help="The columns to print.", metavar="A,B,...")] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a table with commas, units in its heading.")] = False,
    as_json: AsJson = False,
    plot: Annotated[bool, typer.Option("--plot", help="Draw the life of junction N into a png file.")] = False,
    force: ReplacePlot = False,
) -> None:
    """List junctions that meet a condition, or show one life.

    A list is in order of birth or of a column. Of junction N: birth, mid-life, death, its share of the contact, and the
    others alive; --csv prints its curve.

    Example: rubnoise junctions fig5.h5 17

    Example: rubnoise junctions fig5.h5 --where "diameter > 6 um" --sort life_distance --head 10
    """
    from rubnoise.cli.loading import finished_run

    chosen = {"--where": where, "--sort": sort, "--reverse": reverse or None, "--head": head, "--columns": columns}
    if number is not None:
        _refuse(chosen, "is for a list, not for one junction")
        show_life(file, number, picture, plot=plot, force=force, as_csv=as_csv, as_json=as_json)
        return
    _refuse({"--plot": plot or None, "--force": force or None}, "is for one junction: rubnoise junctions RUN.h5 N")
    if as_csv and as_json:
        raise typer.BadParameter("only one of --csv and --json")
    show = print_csv if as_csv else print_json if as_json else print_text
    if head is None and show is print_text:
        head = ROWS_SHOWN
    with finished_run(file) as run:
        found = JunctionList.of(
            run, file, where=where, sort=sort, reverse=reverse, head=head, columns=columns, brief=show is print_text
        )
        show(found)


def _refuse(options: dict[str, Any], why: str) -> None:
    given = [name for name, value in options.items() if value is not None]
    if given:
        raise typer.BadParameter(f"{given[0]} {why}")


BRIEF = ("junction", "birth_distance", "diameter", "max_area", "state")
"""Columns that fit a terminal; those of --where and --sort are added."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JunctionList:
    """Rows in the requested order, the number of all that fit, and the columns to print."""

    run: "Rows"
    path: Path
    where: str | None
    sort: str | None
    rows: "RowNumbers"
    total: int
    columns: "tuple[Dataset, ...]"

    @classmethod
    def of(
        cls,
        run: "Rows",
        path: Path,
        *,
        where: str | None,
        sort: str | None,
        reverse: bool,
        head: int | None,
        columns: str | None,
        brief: bool,
    ) -> Self:
        """Find the rows; raises Refused for an invalid condition and an unknown column."""
        from rubnoise.analysis.selection import select
        from rubnoise.analysis.where import condition
        from rubnoise.storage.schema import JUNCTIONS

        there = tuple(column for column in JUNCTIONS.columns if column.name in run.columns["junctions"])
        tree = None if where is None else condition(where, there)
        by = None if sort is None else _column_named(sort.removeprefix("-"), "--sort", there).name
        named = {*(() if tree is None else tree.columns), *(() if by is None else (by,))}
        wanted = _chosen_columns(columns, there, named if brief else None)
        descending = reverse != (sort is not None and sort.startswith("-"))
        rows, total = select(run, tree, sort=by, descending=descending, head=head)
        order = f"-{by or 'junction'}" if descending else by
        return cls(run=run, path=path, where=where, sort=order, rows=rows, total=total, columns=wanted)

    def values(self) -> Iterator[tuple[Any, ...]]:
        """Yield the values of each row as numbers of Python."""
        from rubnoise.analysis.selection import gather

        names = [column.name for column in self.columns]
        for chunk in gather(self.run, self.rows, names):
            yield from zip(*(chunk[name].tolist() for name in names), strict=True)


def print_csv(found: JunctionList) -> None:
    """Print a heading of names with units, then a line for each row, every number to its last bit."""
    from rubnoise.storage.export import heading

    print(",".join(map(heading, found.columns)))
    for row in found.values():
        print(",".join(map(repr, row)))


def print_json(found: JunctionList) -> None:
    """Print one JSON object, column by column while the rows are read, so that memory does not grow with them."""
    from rubnoise.analysis.selection import gather

    print(json_text(about(found).to_json())[:-1] + ', "junctions": {', end="")
    for i, column in enumerate(found.columns):
        print(",\n" if i else "\n", json_text(column.name), ": [", sep="", end="")
        separator = ""
        for chunk in gather(found.run, found.rows, [column.name]):
            cells = json_text(_cells(column.name, chunk[column.name].tolist()))[1:-1]
            print(separator, cells, sep="", end="")
            separator = ", "
        print("]", end="")
    print("}}")


def about(found: JunctionList) -> Answer:
    """Return which rows were chosen, without these."""
    all_rows = found.run.rows("junctions")
    rows = {"where": found.where, "sort": found.sort, "rows": all_rows, "matched": found.total}
    return Answer(
        title=f"{found.path}: {grouped(found.total)} of {grouped(all_rows)} junctions",
        rows=tuple(Row(name=name, value=value) for name, value in rows.items() if value is not None),
    )


def print_text(found: JunctionList) -> None:
    """Print the rows in columns below their names and units, and the number of further ones."""
    units = {column.name: column.units for column in found.columns if column.units != "1"}
    names = [column.name for column in found.columns]
    values = {
        name: _cells(name, list(cells)) for name, cells in zip(names, zip(*found.values(), strict=True), strict=False)
    }
    tables = (Table(name="", columns=values, units=units),) if found.rows.size else ()
    print(as_wide_text(replace(about(found), rows=(), tables=tables)))
    if found.total > found.rows.size:
        print(f"\n  and {grouped(found.total - found.rows.size)} more (--head N for more, --csv for all)")


def _cells(name: str, values: list[Any]) -> list[Any]:
    """Return the values of a column as JSON and text have them: states by name."""
    if name != "state":
        return values
    from rubnoise.record.rows import JunctionState

    return [state_names(JunctionState(value)) for value in values]


def _chosen_columns(columns: str | None, there: "tuple[Dataset, ...]", named: set[str] | None) -> "tuple[Dataset, ...]":
    if columns is not None:
        names = [name.strip() for name in columns.split(",")]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise Refused(f"--columns: {printable(twice) or 'nothing'} is named twice")
        return tuple(_column_named(name, "--columns", there) for name in names)
    if named is None:
        return there
    return tuple(column for column in there if column.name in named.union(BRIEF))


def _column_named(name: str, option: str, there: "tuple[Dataset, ...]") -> "Dataset":
    from rubnoise.analysis.where import did_you_mean
    from rubnoise.storage.schema import JUNCTIONS

    for column in there:
        if column.name == name:
            return column
    if any(column.name == name for column in JUNCTIONS.columns):
        raise Refused(f"{option}: this run has no {name}; it has {', '.join(column.name for column in there)}")
    raise Refused(f"{option}: no column {printable(name)}; {did_you_mean(name, (column.name for column in there))}")
