"""`rubnoise junctions`: the rows of a result that meet a condition, or the life of one of them."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.answer import Answer, Row, Table, printable, rows
from rubnoise.cli.layout import show
from rubnoise.cli.options import AsCsv, AsJson, ReplacePlot, ResultFile, argument, flag, option
from rubnoise.cli.plot import check_picture, check_plot, write_picture
from rubnoise.cli.vocabulary import UNITS, fields_of, named
from rubnoise.errors import Refused

if TYPE_CHECKING:
    from rubnoise.analysis.life import Life
    from rubnoise.record.reader import Rows
    from rubnoise.record.rows import JunctionState
    from rubnoise.storage.schema import Dataset

ROWS_SHOWN = 20
"""Rows printed as text by default."""

SETTINGS: Final = {"context_settings": {"ignore_unknown_options": True}}
"""Unknown options pass, so that the row number -1 gets its own answer; the command refuses the others."""


def junctions(
    file: ResultFile,
    number: Annotated[
        str | None, argument("N", "Row number of one junction, from 0 in order of birth, to show its life.")
    ] = None,
    picture: Annotated[
        Path | None, argument("FILE.png", "The png file of --plot; default: a name from RUN and N.")
    ] = None,
    *,
    where: Annotated[
        str | None,
        option(
            "CONDITION",
            "Only rows that meet this condition: columns, numbers (with units), < <= > >= == !=, and, or, not,"
            " parentheses, and the states complete, alive_at_start, alive_at_end, ended_early.",
        ),
    ] = None,
    sort: Annotated[str | None, option("COLUMN", "Smallest first; -COLUMN: largest first.")] = None,
    reverse: Annotated[bool, flag("Reverse the order.", "--reverse")] = False,
    head: Annotated[
        int | None, option("N", "Largest number of rows; default: 20 as text, otherwise all.", min=0)
    ] = None,
    columns: Annotated[str | None, option("A,B,...", "The columns to print.")] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    plot: Annotated[bool, flag("Draw the life of junction N into a png file.", "--plot")] = False,
    force: ReplacePlot = False,
) -> None:
    """List junctions that meet a condition, or show one life.

    A list is in order of birth or of a column. Of junction N: birth, mid-life, death, its share of the contact, and the
    others alive; --csv prints its curve.

    Example: rubnoise junctions fig5.h5 17

    Example: rubnoise junctions fig5.h5 --where "diameter > 6 um" --sort life_distance --head 10
    """
    from rubnoise.analysis.life import life_of
    from rubnoise.cli.loading import finished_run

    chosen = {"--where": where, "--sort": sort, "--reverse": reverse or None, "--head": head, "--columns": columns}
    if given := [name for name, value in chosen.items() if value is not None and number is not None]:
        raise typer.BadParameter(f"{given[0]} is for a list, not for one junction")
    check_plot(picture, plot=plot, printed=as_csv or as_json, force=force)
    if plot and number is None:
        raise typer.BadParameter("--plot is for one junction: rubnoise junctions RUN.h5 N")
    if picture is not None and picture.suffix.lower() != ".png":
        raise typer.BadParameter(f"{picture} does not end in .png, which is what --plot draws")
    row, brief = None if number is None else _row(number), not (as_csv or as_json)
    with finished_run(file) as run:
        if row is None:
            head = ROWS_SHOWN if brief and head is None else head
            answer, more = listed(run, where, sort, columns, reverse=reverse, head=head, brief=brief, as_csv=as_csv)
            answer = replace(answer, title=f"{file}: {answer.title}")
            show(answer if as_json else replace(answer, rows=()), as_json=as_json, as_csv=as_csv)
            if brief and more:
                print(f"\n  and {more:,} more (--head N for more, --csv for all)")
        elif plot:
            from rubnoise.figures.contact import draw_life

            path = picture or Path(f"{file.stem}_junction{row}.png")
            life = life_of(run, row)
            check_picture(path, force=force, reads=[file])
            write_picture(path, lambda: draw_life(life, printable(file.name)), force=force)
        else:
            show(life_answer(life_of(run, row), file, as_csv=as_csv), as_json=as_json, as_csv=as_csv)


def _row(number: str) -> int:
    if number.startswith("-") and not re.fullmatch("-[0-9]+", number):
        raise typer.BadParameter(f"no such option: {number}")
    if not re.fullmatch("-?[0-9]{1,100}", number):
        raise typer.BadParameter(f"{number} is no row number")
    return int(number)


# A list.

BRIEF = ("junction", "birth_distance", "diameter", "max_area", "state")
"""Columns that fit a terminal; those of --where and --sort are added."""


def listed(
    run: "Rows",
    where: str | None,
    sort: str | None,
    columns: str | None,
    *,
    reverse: bool,
    head: int | None,
    brief: bool,
    as_csv: bool,
) -> tuple[Answer, int]:
    """Return the rows that fit a condition in the requested order, and the number of those that ``head`` leaves out.

    ``as_csv``: with the units in the names of columns, as in max_area_um2, and states as numbers. Raises Refused for an
    invalid condition and an unknown column.
    """
    from rubnoise.analysis.selection import gather, select
    from rubnoise.analysis.where import Condition
    from rubnoise.storage.export import heading
    from rubnoise.storage.schema import JUNCTIONS

    there = [column for column in JUNCTIONS.columns if column.name in run.columns["junctions"]]
    tree = None if where is None else Condition(where, there)
    by = None if sort is None else _column_named(sort.removeprefix("-"), "--sort", there).name
    wanted = there if columns is None else _chosen_columns(columns, there)
    if columns is None and brief:
        shown = {*BRIEF, *(() if tree is None else tree.columns), by}
        wanted = [column for column in there if column.name in shown]
    descending = reverse != (sort is not None and sort.startswith("-"))
    found, total = select(run, tree, sort=by, descending=descending, head=head)
    chunks = list(gather(run, found, [column.name for column in wanted]))
    cells = {}
    for column in wanted:
        values = [each for chunk in chunks for each in chunk[column.name].tolist()]
        cells[heading(column) if as_csv else column.name] = values if as_csv else _cells(column.name, values)
    table = Table(
        name="" if brief else "junctions",
        columns=cells,
        units={column.name: column.units for column in wanted if column.units != "1"},
        shown=None if found.size else (),
    )
    order, all_rows = f"-{by or 'junction'}" if descending else by, run.rows("junctions")
    about = rows("", ("where", where), ("sort", order), ("rows", all_rows), ("matched", total))
    title = f"{total:,} of {all_rows:,} junctions"
    return Answer(title=title, rows=tuple(about), tables=(table,)), total - found.size


def _cells(name: str, values: list[Any]) -> list[Any]:
    """Return the values of a column as JSON and text have them: states by name."""
    if name != "state":
        return values
    from rubnoise.record.rows import JunctionState

    return [state_names(JunctionState(value)) for value in values]


def _chosen_columns(columns: str, there: "Sequence[Dataset]") -> "list[Dataset]":
    names = [name.strip() for name in columns.split(",")]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise Refused(f"--columns: {printable(twice) or 'nothing'} is named twice")
    return [_column_named(name, "--columns", there) for name in names]


def _column_named(name: str, option: str, there: "Sequence[Dataset]") -> "Dataset":
    from rubnoise.analysis.where import advice

    found = next((column for column in there if column.name == name), None)
    if found is None:
        raise Refused(f"{option}: no column {printable(name)}; {advice(name, [column.name for column in there])}")
    return found


# One life.


def state_names(state: "JunctionState") -> list[str]:
    """Return the names of a state's bits as the file has them, ``complete`` if there are none."""
    return [str(bit.name).lower() for bit in state] or ["complete"]


def life_answer(life: "Life", file: Path, *, as_csv: bool = False) -> Answer:
    """Return everything about a life: its row, the contact where its area is largest, and its curve.

    ``as_csv``: the curve alone, with the units in the names of its columns.
    """
    curve = {name: values.tolist() for name, values in life.curve().items()}
    if as_csv:
        named = {f"{name}_{UNITS[name].replace('^', '')}": values for name, values in curve.items()}
        return Answer(tables=(Table(name="curve", columns=named),))
    of = ", ".join(name.replace("_", " ") for name in state_names(life.state))
    return Answer(
        title=f"{file}: junction {life.number} of 0 to {life.rows - 1}, {of}",
        rows=(*_row_of(life), *_peak(life)),
        tables=(Table(name="curve", columns=curve, units=UNITS, shown=()),),
    )


def _row_of(life: "Life") -> Iterator[Row]:
    """Yield the columns of its row that the run has, and where it reached its largest overlap."""
    yield Row(part="junction", name="state", value=state_names(life.state))
    middle = life.mid_life_distance
    for name, distance, time in (
        ("birth", life.birth_distance, life.birth_time),
        ("mid_life", middle, None if middle is None else life.time(middle)),
        ("death", life.death_distance, life.death_time),
    ):
        after = ""
        if distance is None:
            yield Row(part="junction", name=f"{name}_distance", note="not reached")
        elif not 0.0 <= distance <= life.record_end:
            after = "before the start" if distance < 0.0 else "after the end"
        yield from rows("junction", (f"{name}_distance", distance, "um", after), (f"{name}_time", _number(time), "s"))
    yield from named("junction", fields_of(life, "life_distance diameter lateral_offset max_area shear_strength"))


def _number(time: Any) -> float | None:
    return None if time is None else float(time)


def _peak(life: "Life") -> list[Row]:
    """Return the contact where the area of this junction is largest, and who was alive there."""
    known = {
        "distance": life.peak_distance,
        "time": _number(life.time(life.peak_distance)),
        "area": life.peak_area,
        **fields_of(life, "real_contact_area area_share"),
        "force": life.peak_force,
        **fields_of(life, "friction_force force_share"),
        "others_alive": life.beside.rows.tolist(),
    }
    return named("peak", known, {"distance": _occasion(life), "others_alive": "row numbers"})


def _occasion(life: "Life") -> str:
    if life.peak_distance == life.mid_life_distance:
        return "mid-life"
    if life.peak_distance == life.death_distance:
        return "just before it was ended"
    return f"largest in the record, at the {'end' if life.peak_distance == life.record_end else 'start'}"
