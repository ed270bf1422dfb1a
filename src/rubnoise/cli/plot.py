"""`rubnoise plot`: pictures of a run or of a sweep, simulation and theory in each."""

import re
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

import rubnoise
from rubnoise.answer import printable
from rubnoise.cli.terminal import ReplaceFile, ResultOrSweep, StretchEnd, StretchStart, argument, flag, option
from rubnoise.errors import naming, refusing_files
from rubnoise.figures import Figure, Kind
from rubnoise.regular_file import is_folder

if TYPE_CHECKING:
    from rubnoise.figures.style import Format


PICTURES: tuple[Kind, ...] = get_args(Kind)  # the pictures of a run

SpectrumOf = StrEnum("SpectrumOf", "area force displacement velocity normal-velocity load")
"""The quantities of spectra and histograms."""


def complete(incomplete: str) -> list[str]:
    """Return the pictures of runs and the quantities of sweeps that begin with a text."""
    from rubnoise.figure_names import FIGURE_NAMES

    return [name for name in (*PICTURES, *FIGURE_NAMES) if name.startswith(incomplete)]


def plot(
    file: ResultOrSweep,
    what: Annotated[
        str | None,
        argument(
            "WHAT",
            f"Of a run, the picture: {', '.join(PICTURES)}. Of a sweep, a quantity, such as displacement_std.",
            autocompletion=complete,
            show_default="trace, or displacement_std or real_contact_area_std",
        ),
    ] = None,
    *,
    output: Annotated[
        Path | None, option("PICTURE", "A png, pdf or svg file; else RUN_WHAT.png, here.", "-o", "--output")
    ] = None,
    start: StretchStart = None,
    stop: StretchEnd = None,
    of: Annotated[
        SpectrumOf,
        option(
            "QUANTITY",
            "Of what psd and histogram are: area, or force, displacement, velocity, normal-velocity or load.",
        ),
    ] = SpectrumOf.area,
    beside: Annotated[
        Path | None,
        option(
            "RUN.h5|CSV",
            "Another run, laid over the first: for slider, phase, load and psd. For psd also a record of yours, a csv"
            " file.",
            "--with",
        ),
    ] = None,
    size: Annotated[
        str | None,
        option(
            "SIZE",
            "Width and height, such as '84 mm x 60 mm'; single and double are the columns of a journal.",
            show_default="the picture's own",
        ),
    ] = None,
    style: Annotated[
        str | None,
        option(
            "STYLE",
            "screen, paper (small letters) or slides (large ones).",
            show_default="paper below 120 mm, else screen",
        ),
    ] = None,
    title: Annotated[bool, flag("With titles, or without for a caption.", "--title/--no-title")] = True,
    force: ReplaceFile = False,
) -> None:
    """Draw a run beside theory.

    Area, single lives, distributions, spectra, autocovariance, count, and the slider.

    overview shows the run at a glance, contact the junctions from above at --from; sizes, life_distances and gaps are
    histograms beside their laws. lifelines has a bar from birth to death for each junction. slider is its motion in
    time, phase its velocity over its displacement, landmarks how far it slips and how long it sticks, or the speeds of
    impacts and the times of flights; load is its rise and fall under a load that weighs. Of a sweep a
    quantity is drawn against what is swept, with intervals and the exact curve.

    Example: rubnoise plot fig5.h5 psd --of velocity -o spectrum.pdf
    """
    ends = distance("--from", start), distance("--to", stop)
    with refusing_files(file):  # which of the two it should have been says what may be drawn of it
        file.stat()
    look = {"size": size, "style": style, "title": title}
    if is_folder(file):
        if ends != (None, None) or beside:
            raise typer.BadParameter("--from, --to and --with are for the pictures of one run")
        if of is not SpectrumOf.area:
            whose = what or "a quantity of a sweep"
            raise typer.BadParameter(f"--of is for psd and histogram of a run, not for {whose}")
        _plot_sweep(file, what, output, look, force=force)
    else:
        how = look | {"start": ends[0], "stop": ends[1], "of": of.value, "beside": beside}
        _plot_run(file, what or "trace", output, how, force=force)


def _plot_run(file: Path, what: str, output: Path | None, how: dict[str, Any], *, force: bool) -> None:
    from rubnoise.api.pictures import picture_named
    from rubnoise.api.run import Run
    from rubnoise.cli.loading import finished_run

    kind = picture_named(what)
    path = output or Path(f"{file.stem}_{kind}_{how['of']}".removesuffix("_area") + ".png")
    check_picture(path, force=force, reads=[file, *filter(None, [how["beside"]])])
    with finished_run(file) as run:
        write_picture(path, Run(run).plot(kind, **how), force=force)


def _plot_sweep(folder: Path, what: str | None, output: Path | None, look: dict[str, Any], *, force: bool) -> None:
    from rubnoise.figures.catalogue import first_quantity

    with rubnoise.open_sweep(folder) as sweep:
        shown = what or first_quantity(sweep.index)
        path = output or Path(f"{sweep.name}_{shown}.png")
        check_picture(path, force=force)
        with naming(folder):
            write_picture(path, sweep.plot(shown, **look), force=force)


def distance(option: str, text: str | None) -> float | None:
    """Return a sliding distance in um, also of a number without a unit; None if none is given.

    Raises Refused, naming the option, if it is not a length.
    """
    from rubnoise.arrays import number_in
    from rubnoise.units import LENGTH, NUMBER

    if text is None:
        return None
    return number_in(f"{text} um" if re.fullmatch(NUMBER, text) else text, option, LENGTH)


def check_picture(path: Path, *, force: bool, reads: Sequence[Path] = ()) -> "Format":
    """Return the format of a path's ending; raises Refused if the file may not or cannot be written."""
    from rubnoise.figures.style import FORMATS
    from rubnoise.storage.output import check_output

    kind = next((kind for kind in FORMATS if path.suffix.lower() == f".{kind}"), None)
    if kind is None:
        raise typer.BadParameter(f"{printable(str(path))} ends in none of .png, .pdf and .svg")
    check_output(path, force=force, reads=reads)
    return kind


def write_picture(path: Path, figure: Figure, *, force: bool) -> None:
    """Write a picture, whole or not at all in the format of its file's ending, and print its name."""
    from rubnoise.figures.style import as_bytes
    from rubnoise.storage.output import whole_file

    picture = as_bytes(figure, check_picture(path, force=force))
    with whole_file(path, force=force) as part:
        part.write_bytes(picture)
    print(path)


def check_plot(picture: Path | None, *, plot: bool, printed: bool, force: bool) -> None:
    """Raise BadParameter for a picture beside numbers, and for what belongs to one that is not asked for."""
    if plot and printed:
        raise typer.BadParameter("only one of --csv, --json and --plot")
    if not plot and (picture is not None or force):
        raise typer.BadParameter(f"{picture or '--force'} is for --plot")
