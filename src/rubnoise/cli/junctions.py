"""`rubnoise junctions`: the rows of a result that meet a condition, or the life of one of them."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from rubnoise.answer import Answer, Row, Table, printable, rows
from rubnoise.cli.plot import check_picture, check_plot, write_picture
from rubnoise.cli.terminal import AsCsv, AsJson, ReplacePlot, ResultFile, argument, flag, option, show
from rubnoise.cli.vocabulary import UNITS, fields_of, named
from rubnoise.errors import Refused

if TYPE_CHECKING:
    from rubnoise.analysis.junctions import Life
    from rubnoise.record.rows import Reader
    from rubnoise.storage.schema import Dataset

_ROWS_SHOWN: Final = 20  # as text by default
_BRIEF: Final = {"junction", "birth_distance", "diameter", "max_area", "state"}  # what fits a terminal


def junctions(
    file: ResultFile,
    number: Annotated[
        int | None, argument("N", "Row number of one junction, from 0 in order of birth, to show its life.")
    ] = None,
    picture: Annotated[
        Path | None, argument("PICTURE", "A png, pdf or svg file for --plot; default: a name from RUN and N.")
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
    plot: Annotated[bool, flag("Draw the life of junction N.", "--plot")] = False,
    force: ReplacePlot = False,
) -> None:
    """List junctions that meet a condition, or show one life.

    A list is in order of birth or of a column. Of junction N: birth, mid-life, death, its share of the contact, and the
    others alive; --csv prints its curve.

    Example: rubnoise junctions fig5.h5 17

    Example: rubnoise junctions fig5.h5 --where "diameter > 6 um" --sort life_distance --head 10
    """
    from rubnoise.analysis.junctions import life_of
    from rubnoise.api.run import Run
    from rubnoise.cli.loading import finished_run

    chosen = {"--where": where, "--sort": sort, "--reverse": reverse or None, "--head": head, "--columns": columns}
    if given := [name for name, value in chosen.items() if value is not None and number is not None]:
        raise typer.BadParameter(f"{given[0]} is for a list, not for one junction")
    check_plot(picture, plot=plot, printed=as_csv or as_json, force=force)
    if plot and number is None:
        raise typer.BadParameter("--plot is for one junction: rubnoise junctions RUN.h5 N")
    brief = not (as_csv or as_json)
    with finished_run(file) as run:
        if number is None:
            head = _ROWS_SHOWN if brief and head is None else head
            answer, more = _listed(run, where, sort, columns, reverse, head, brief=brief, as_csv=as_csv)
            show(replace(answer, rows=answer.rows if as_json else ()), as_json=as_json, as_csv=as_csv)
            if brief and more:
                print(f"\n  and {more:,} more (--head N for more, --csv for all)")
            return
        life = life_of(run, Run(run).junction(number))
        if plot:
            from rubnoise.figures.catalogue import drawing
            from rubnoise.figures.tracks import Stretch

            path = picture or Path(f"{file.stem}_junction{number}.png")
            check_picture(path, force=force, reads=[file])
            write_picture(path, drawing("lives", Stretch.of(run), life=life), force=force)
        else:
            answer = _life_answer(life, file)
            if as_csv:  # the curve alone, with the units in the names of its columns
                curve = {f"{name}_{UNITS[name].replace('^', '')}": each for name, each in life.curve().items()}
                answer = Answer(tables=(Table(name="curve", columns=curve),))
            show(answer, as_json=as_json, as_csv=as_csv)


def _listed(
    run: "Reader",
    where: str | None,
    sort: str | None,
    columns: str | None,
    reverse: bool,
    head: int | None,
    *,
    brief: bool,
    as_csv: bool,
) -> tuple[Answer, int]:
    """Return the rows that fit a condition in the requested order, and the number of those that ``head`` leaves out.

    ``as_csv``: with the units in the names of columns, as in max_area_um2, and states as numbers. Raises Refused for an
    invalid condition and an unknown column.
    """
    from rubnoise.analysis.junctions import gather, select
    from rubnoise.analysis.where import Condition
    from rubnoise.storage.export import heading
    from rubnoise.storage.schema import JUNCTIONS

    there = {each.name: each for each in JUNCTIONS.columns if each.name in run.columns["junctions"]}
    condition = None if where is None else Condition(where, [*there.values()])
    by = None if sort is None else _known(sort.removeprefix("-"), "--sort", there)
    descending = reverse != (sort or "").startswith("-")
    names = [*there]
    if columns is not None:
        names = _chosen(columns, there)
    elif brief:
        wanted = _BRIEF | {by} | (set() if condition is None else condition.columns)
        names = [name for name in there if name in wanted]
    meets = None if condition is None else condition.chosen
    found = select(run, meets, sort=by, descending=descending)
    shown = found[:head]
    cells = {name: values.tolist() for name, values in gather(run, shown, names).items()}
    if as_csv:
        cells = {heading(there[name]): values for name, values in cells.items()}
    elif "state" in cells:
        cells["state"] = [_state_names(value) for value in cells["state"]]
    table = Table(
        name="" if brief else "junctions",
        columns=cells,
        units={name: there[name].units for name in names if there[name].units != "1"},
        shown=None if shown.size else (),
    )
    order, all_rows = f"-{by or 'junction'}" if descending else by, run.rows("junctions")
    about = rows("", ("where", where), ("sort", order), ("rows", all_rows), ("matched", found.size))
    title = f"{run.path}: {found.size:,} of {all_rows:,} junctions"
    return Answer(title=title, rows=tuple(about), tables=(table,)), found.size - shown.size


def _chosen(columns: str, there: "Mapping[str, Dataset]") -> list[str]:
    names = [name.strip() for name in columns.split(",")]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise Refused(f"--columns: {printable(twice) or 'nothing'} is named twice")
    return [_known(name, "--columns", there) for name in names]


def _known(name: str, option: str, there: "Mapping[str, Dataset]") -> str:
    from rubnoise.analysis.where import advice

    if name not in there:
        raise Refused(f"{option}: no column {printable(name)}; {advice(name, [*there])}")
    return name


def _state_names(state: int) -> list[str]:
    """Return the names of a state's bits as the file has them, ``complete`` if there are none."""
    from rubnoise.record.rows import JunctionState

    return [str(bit.name).lower() for bit in JunctionState(state)] or ["complete"]


def _life_answer(life: "Life", file: Path) -> Answer:
    """Return everything about a life: its row, the contact where its area is largest, and its curve."""
    peak, states = life.peak, _state_names(life.state)
    known = fields_of(peak, "distance time area real_contact_area area_share force friction_force force_share")
    known["others_alive"] = peak.beside.rows.tolist()
    notes = {"distance": _occasion(life), "others_alive": "row numbers"}
    of = ", ".join(name.replace("_", " ") for name in states)
    return Answer(
        title=f"{file}: junction {life.number} of 0 to {life.rows - 1}, {of}",
        rows=(Row(part="junction", name="state", value=states), *_row_of(life), *named("peak", known, notes)),
        tables=(Table(name="curve", columns=life.curve(), units=UNITS, shown=()),),
    )


def _row_of(life: "Life") -> Iterator[Row]:
    """Yield the columns of its row that the run has, and where it reached its largest overlap."""
    middle = life.mid_life_distance
    half = None if middle is None else life.time(middle)
    for name, distance, time in (
        ("birth", life.birth_distance, life.birth_time),
        ("mid_life", middle, None if half is None else float(half)),
        ("death", life.death_distance, life.death_time),
    ):
        after = ""
        if distance is None:
            yield Row(part="junction", name=f"{name}_distance", note="not reached")
        elif not 0.0 <= distance <= life.record_end:
            after = "before the start" if distance < 0.0 else "after the end"
        yield from rows("junction", (f"{name}_distance", distance, "um", after), (f"{name}_time", time, "s"))
    yield from named("junction", fields_of(life, "life_distance diameter lateral_offset max_area shear_strength"))


def _occasion(life: "Life") -> str:
    if life.peak.distance == life.mid_life_distance:
        return "mid-life"
    if life.peak.distance == life.death_distance:
        return "just before it was ended"
    return f"largest in the record, at the {'end' if life.peak.distance == life.record_end else 'start'}"
