"""`rubnoise junctions FILE N`: one life in words and numbers, as a curve, or as a picture."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from rubnoise.answer import Answer, Row, Table, printable
from rubnoise.cli.layout import show
from rubnoise.cli.plot import check_picture, write_picture

if TYPE_CHECKING:
    from rubnoise.analysis.life import Life
    from rubnoise.record.rows import JunctionState


def show_life(
    file: Path, number: str, picture: Path | None, *, plot: bool, force: bool, as_csv: bool, as_json: bool
) -> None:
    """Show one junction of a result in the chosen form."""
    from rubnoise.analysis.life import life_of
    from rubnoise.cli.loading import finished_run

    _check_options(picture, plot=plot, force=force, as_csv=as_csv, as_json=as_json)
    row = _row(number)
    with finished_run(file) as run:
        life = life_of(run, row)
        if plot:
            _draw(life, file, picture or Path(f"{file.stem}_junction{life.number}.png"), force=force)
        elif as_csv:
            print("\n".join(curve_lines(life)))
        else:
            show(life_answer(life, file), as_json=as_json)


def life_answer(life: "Life", file: Path) -> Answer:
    """Return everything about a life: its row, the contact where its area is largest, and its curve."""
    of = ", ".join(STATES[name] for name in state_names(life.state))
    return Answer(
        title=f"{file}: junction {life.number} of 0 to {life.rows - 1}, {of}",
        rows=(*_row_of(life), *_peak(life)),
        tables=(Table(name="curve", columns=life.curve(), units=UNITS, shown=()),),
    )


def _row_of(life: "Life") -> Iterator[Row]:
    """Yield the columns of its row that the run has, and where it reached its largest overlap."""
    yield Row(part="junction", name="state", value=state_names(life.state))
    middle = life.mid_life_distance
    where = life.birth_distance, middle, life.death_distance
    when = life.birth_time, None if middle is None else life.time(middle), life.death_time
    for name, distance, time in zip(("birth", "mid_life", "death"), where, when, strict=True):
        if distance is None:
            yield Row(part="junction", name=f"{name}_distance", note="not reached")
            continue
        after = "before the start" if distance < 0.0 else "after the end" if distance > life.record_end else ""
        yield Row(part="junction", name=f"{name}_distance", value=distance, unit="um", note=after)
        if time is not None:
            yield Row(part="junction", name=f"{name}_time", value=float(time), unit="s")
    for name, unit in (
        ("life_distance", "um"),
        ("diameter", "um"),
        ("lateral_offset", "um"),
        ("max_area", "um^2"),
        ("shear_strength", "MPa"),
    ):
        if (value := getattr(life, name)) is not None:
            yield Row(part="junction", name=name, value=value, unit=unit)


def _peak(life: "Life") -> Iterator[Row]:
    """Yield the contact where the area of this junction is largest, and who was alive there."""
    time = life.time(life.peak_distance)
    known = {
        "distance": (life.peak_distance, "um"),
        "time": (None if time is None else float(time), "s"),
        "area": (life.peak_area, "um^2"),
        "real_contact_area": (life.real_contact_area, "um^2"),
        "area_share": (life.area_share, ""),
        "force": (life.peak_force, "uN"),
        "friction_force": (life.friction_force, "uN"),
        "force_share": (life.force_share, ""),
    }
    for name, (value, unit) in known.items():
        if value is not None:
            note = _occasion(life) if name == "distance" else ""
            yield Row(part="peak", name=name, value=value, unit=unit, note=note)
    yield Row(part="peak", name="others_alive", value=life.beside.rows.tolist(), note="row numbers")


def _occasion(life: "Life") -> str:
    if life.peak_distance == life.mid_life_distance:
        return "mid-life"
    if life.peak_distance == life.death_distance:
        return "just before it was ended"
    return f"largest in the record, at the {'end' if life.peak_distance == life.record_end else 'start'}"


def _check_options(picture: Path | None, *, plot: bool, force: bool, as_csv: bool, as_json: bool) -> None:
    if as_csv + as_json + plot > 1:
        raise typer.BadParameter("only one of --csv, --json and --plot")
    if not plot and (picture is not None or force):
        raise typer.BadParameter(f"{picture or '--force'} is for --plot")
    if picture is not None and picture.suffix.lower() != ".png":
        raise typer.BadParameter(f"{picture} does not end in .png, which is what --plot draws")


def _row(number: str) -> int:
    if number.startswith("-") and not re.fullmatch("-[0-9]+", number):
        raise typer.BadParameter(f"no such option: {number}")
    if not re.fullmatch("-?[0-9]{1,100}", number):
        raise typer.BadParameter(f"{number} is no row number")
    return int(number)


def _draw(life: "Life", file: Path, path: Path, *, force: bool) -> None:
    from rubnoise.figures.life import life_png

    check_picture(path, force=force, reads=[file])
    write_picture(path, lambda _: life_png(life, printable(file.name)), force=force)


UNITS = {"distance": "um", "time": "s", "area": "um^2", "force": "uN"}
STATES = {
    "alive_at_start": "alive at the start",
    "alive_at_end": "alive at the end",
    "ended_early": "ended early",
    "complete": "a complete life",
}


def state_names(state: "JunctionState") -> list[str]:
    """Return the names of a state's bits as the file has them, ``complete`` if there are none."""
    return [str(bit.name).lower() for bit in state] or ["complete"]


def curve_lines(life: "Life") -> Iterator[str]:
    """Yield the curve as a table with commas, the units in its heading; every number reads back to the same bits."""
    curve = life.curve()
    yield ",".join(f"{name}_{UNITS[name].replace('^', '')}" for name in curve)
    for values in zip(*(column.tolist() for column in curve.values()), strict=True):
        yield ",".join(map(repr, values))
