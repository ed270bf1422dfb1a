"""`rubnoise junctions FILE N`: one life in words and numbers, as a curve, or as a picture."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from rubnoise.answer import printable
from rubnoise.cli.layout import filled, grouped, json_text, number, table_row
from rubnoise.cli.plot import check_picture, write_picture

if TYPE_CHECKING:
    from rubnoise.analysis.life import Life
    from rubnoise.record.rows import JunctionState


def show(
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
        elif as_json:
            print(json_text(life_as_json(life, file)))
        elif as_csv:
            print("\n".join(curve_lines(life)))
        else:
            print("\n".join(format_life(life, file)))


def life_as_json(life: "Life", file: Path) -> dict[str, Any]:
    """Return everything about a life, by name; values that the run lacks, or the life did not reach, are None."""
    middle = life.mid_life_distance
    return {
        "file": str(file),
        "junction": life.number,
        "rows": life.rows,
        "state": state_names(life.state),
        "birth_distance": life.birth_distance,
        "mid_life_distance": middle,
        "death_distance": life.death_distance,
        "life_distance": life.life_distance,
        "birth_time": life.birth_time,
        "mid_life_time": None if middle is None else life.time(middle),
        "death_time": life.death_time,
        "diameter": life.diameter,
        "lateral_offset": life.lateral_offset,
        "max_area": life.max_area,
        "shear_strength": life.shear_strength,
        "peak": {
            "distance": life.peak_distance,
            "time": life.time(life.peak_distance),
            "area": life.peak_area,
            "force": life.peak_force,
            "real_contact_area": life.real_contact_area,
            "friction_force": life.friction_force,
            "area_share": life.area_share,
            "force_share": life.force_share,
            "others_alive": life.beside.rows.tolist(),
        },
        "curve": life.curve(),
    }


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
MOST_NAMED = 60
"""Others named on the terminal; --json names all."""


def state_names(state: "JunctionState") -> list[str]:
    """Return the names of a state's bits as the file has them, ``complete`` if there are none."""
    return [str(bit.name).lower() for bit in state] or ["complete"]


def curve_lines(life: "Life") -> Iterator[str]:
    """Yield the curve as a table with commas, the units in its heading; every number reads back to the same bits."""
    curve = life.curve()
    yield ",".join(f"{name}_{UNITS[name].replace('^', '')}" for name in curve)
    for values in zip(*(column.tolist() for column in curve.values()), strict=True):
        yield ",".join(map(repr, values))


def format_life(life: "Life", file: Path) -> Iterator[str]:
    """Yield the life in words and numbers."""
    state = ", ".join(STATES[name] for name in state_names(life.state))
    yield f"{printable(str(file))}: junction {life.number} of 0 to {life.rows - 1}, {state}"
    yield ""
    yield from _event_lines(life)
    yield ""
    yield _line("diameter", life.diameter, "um")
    if life.lateral_offset is not None:
        yield _line("lateral offset", life.lateral_offset, "um")
    yield _line("area at full overlap" if life.lateral_offset is None else "area at mid-life", life.max_area, "um^2")
    if life.shear_strength is not None:
        yield _line("shear strength", life.shear_strength, "MPa")
    yield ""
    yield from _peak(life)


def _event_lines(life: "Life") -> Iterator[str]:
    yield _event("birth", life, life.birth_distance)
    middle = life.mid_life_distance
    yield _event("mid-life", life, middle) if middle is not None else "  mid-life    not reached"
    yield _event("death", life, life.death_distance)
    length = _line("life", life.life_distance, "um")
    if life.birth_time is not None and life.death_time is not None:
        length = f"{length:<31}{number(life.death_time - life.birth_time):>14} s"
    yield length


def _event(name: str, life: "Life", distance: float) -> str:
    time = life.time(distance)
    after = "" if time is None else f"{number(float(time)):>14} s"
    if distance < 0.0:
        after += "   before the start"
    elif distance > life.record_end:
        after += "   after the end"
    return table_row(f"{_line(name, distance, 'um'):<31}", after)


def _line(name: str, value: float, unit: str, after: str = "") -> str:
    return table_row(f"  {name:<22}{number(value):>13} {unit}", after)


def _peak(life: "Life") -> Iterator[str]:
    yield f"at {_peak_occasion(life)}, {number(life.peak_distance)} um"
    yield _line("its area", life.peak_area, "um^2", f"   {_percent(life.area_share)} of the contact")
    yield _line("real contact area", life.real_contact_area, "um^2")
    if life.peak_force is not None and life.friction_force is not None and life.force_share is not None:
        yield _line("its force", life.peak_force, "uN", f"   {_percent(life.force_share)} of the friction force")
        yield _line("friction force", life.friction_force, "uN")
    yield from _neighbour_lines(life)


def _peak_occasion(life: "Life") -> str:
    if life.peak_distance == life.mid_life_distance:
        return "its peak, mid-life"
    if life.peak_distance == life.death_distance:
        return "its peak, just before it was ended"
    return f"its largest in the record, at the {'end' if life.peak_distance == life.record_end else 'start'}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _neighbour_lines(life: "Life") -> Iterator[str]:
    rows = life.beside.rows
    yield f"  alive beside it: {grouped(rows.size)}" + (", row numbers" if rows.size else "")
    named = ", ".join(str(row) for row in rows[:MOST_NAMED].tolist())
    more = f" and {grouped(rows.size - MOST_NAMED)} more (--json names all)" if rows.size > MOST_NAMED else ""
    if rows.size:
        yield filled(named + more, "    ", "    ")
