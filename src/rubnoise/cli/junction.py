"""`rubnoise junction`: one life in words and numbers, as a curve, or as a picture."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rubnoise.analysis.life import Life


def command(
    file: Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5", show_default=False)],
    number: Annotated[
        str,
        typer.Argument(help="Row number of the junction, from 0 in order of birth.", metavar="N", show_default=False),
    ],
    picture: Annotated[
        Path | None,
        typer.Argument(
            help="The png file of --plot; default: a name from RUN and N.", metavar="FILE.png", show_default=False
        ),
    ] = None,
    *,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print its curve: distance, time, area and force.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    plot: Annotated[bool, typer.Option("--plot", help="Draw it into a png file.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Let --plot replace a file.")] = False,
) -> None:
    """Show the life of one junction: birth, mid-life, death, its share of the contact, the others alive.

    Example: rubnoise junction fig5.h5 17 --plot
    """
    import json

    from rubnoise.analysis.life import life_of
    from rubnoise.cli import junction_text
    from rubnoise.cli.results import finished_run

    _check_wishes(picture, plot=plot, force=force, as_csv=as_csv, as_json=as_json)
    row = _row(number)
    with finished_run(file) as run:
        life = life_of(run, row)
        if plot:
            _draw(life, file, picture or Path(f"{file.stem}_junction{life.number}.png"), force=force)
        elif as_json:
            print(json.dumps(contents(life, file)))
        elif as_csv:
            print("\n".join(junction_text.curve_lines(life)))
        else:
            print("\n".join(junction_text.described(life, file)))


def contents(life: "Life", file: Path) -> dict[str, Any]:
    """Return everything about a life, by name; what the run does not have, or the life did not reach, is None."""
    from rubnoise.cli.junction_text import state_names

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
        "mid_life_time": None if middle is None else _number(life.time(middle)),
        "death_time": life.death_time,
        "diameter": life.diameter,
        "max_area": life.max_area,
        "shear_strength": life.shear_strength,
        "peak": {
            "distance": life.peak_distance,
            "time": _number(life.time(life.peak_distance)),
            "area": life.peak_area,
            "force": life.peak_force,
            "real_contact_area": life.real_contact_area,
            "friction_force": life.friction_force,
            "area_share": life.area_share,
            "force_share": life.force_share,
            "others_alive": life.beside.rows.tolist(),
        },
        "curve": {name: values.tolist() for name, values in life.curve().items()},
    }


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _check_wishes(picture: Path | None, *, plot: bool, force: bool, as_csv: bool, as_json: bool) -> None:
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
    from rubnoise.cli.layout import printable
    from rubnoise.figures.life import life_png
    from rubnoise.storage.output import check_output, whole_file

    check_output(path, force=force)
    picture = life_png(life, printable(file.name))
    with whole_file(path, force=force) as part:
        part.write_bytes(picture)
    print(path)
