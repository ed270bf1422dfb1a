"""`rubnoise plot`: pictures of a run or of a sweep, simulation and theory in each."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rubnoise.api.sweep_result import SweepResult


class What(StrEnum):
    """The pictures of a run."""

    TRACE = "trace"
    LIVES = "lives"
    HISTOGRAM = "histogram"
    PSD = "psd"
    ACF = "acf"
    COUNT = "count"
    SLIDER = "slider"


DEFAULTS = ("displacement_std", "real_contact_area_std")
"""The quantity of a sweep that is drawn where none is named: the first of these that it has."""


def complete(incomplete: str) -> list[str]:
    """Return the pictures of runs and the quantities of sweeps that begin so."""
    from rubnoise.figures.sweep_words import QUANTITIES

    return [name for name in (*What, *QUANTITIES) if name.startswith(incomplete)]


def command(
    file: Annotated[
        Path, typer.Argument(help="A result file, or the folder of a sweep.", metavar="RUN.h5|DIR", show_default=False)
    ],
    what: Annotated[
        str | None,
        typer.Argument(
            help=f"Of a run, the picture: {', '.join(What)}. Of a sweep, the quantity, such as displacement_std.",
            metavar="WHAT",
            autocompletion=complete,
            show_default="trace, or displacement_std or real_contact_area_std",
        ),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="A png, pdf or svg file; else RUN_WHAT.png, here.", metavar="PICTURE"),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option("--from", help="Where the stretch begins: um, or with a unit.", metavar="S", show_default=False),
    ] = None,
    stop: Annotated[
        str | None, typer.Option("--to", help="Where the stretch ends.", metavar="S", show_default=False)
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Draw a run beside theory: area, single lives, distribution, spectrum, autocovariance, count, slider.

    Of a sweep a quantity is drawn against what is swept, with intervals from the replicates and the exact curve.

    Example: rubnoise plot fig5.h5 psd -o spectrum.pdf
    """
    from rubnoise.cli.lengths import distance
    from rubnoise.regular_file import is_folder

    ends = distance("--from", start), distance("--to", stop)
    _refuse_missing(file)  # which of the two it should have been says what may be drawn of it
    if is_folder(file):
        if ends != (None, None):
            raise typer.BadParameter("--from and --to are for the stretch of one run")
        _plot_sweep(file, what, output, force=force)
    else:
        _plot_run(file, _picture(what), output, ends, force=force)


def _refuse_missing(file: Path) -> None:
    from rubnoise.errors import RunFileRefused

    try:
        file.stat()
    except (OSError, ValueError) as problem:
        reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise RunFileRefused(f"{file}: {reason.lower()}") from problem


def _picture(what: str | None) -> What:
    try:
        return What(what or What.TRACE)
    except ValueError:
        known = ", ".join(f"'{name}'" for name in What)
        raise typer.BadParameter(f"'{what}' is not one of {known}", param_hint="'[WHAT]'") from None


def _plot_run(
    file: Path, what: What, output: Path | None, ends: tuple[float | None, float | None], *, force: bool
) -> None:
    from rubnoise.cli.pictures import check_picture, write_picture
    from rubnoise.cli.results import finished_run
    from rubnoise.figures.catalogue import picture
    from rubnoise.figures.stretch import Stretch

    path = output or Path(f"{file.stem}_{what}.png")
    check_picture(path, force=force)
    with finished_run(file) as run:
        stretch = Stretch.of(run, *ends)
        write_picture(path, lambda kind: picture(what.value, stretch, kind), force=force)


def _plot_sweep(folder: Path, what: str | None, output: Path | None, *, force: bool) -> None:
    from rubnoise import api
    from rubnoise.cli.pictures import check_picture, write_picture
    from rubnoise.errors import Refused
    from rubnoise.figures.study_of_sweep import study_of_sweep
    from rubnoise.figures.study_picture import study_picture

    with api.open_sweep(folder) as sweep:
        quantity = what or _first(sweep)
        path = output or Path(f"{folder.resolve().name}_{quantity}.png")
        check_picture(path, force=force)
        try:
            study = study_of_sweep(sweep, quantity)
        except Refused as refusal:
            raise type(refusal)(f"{folder}: {refusal}") from refusal
    write_picture(path, lambda kind: study_picture(study, kind), force=force)


def _first(sweep: "SweepResult") -> str:
    return next((name for name in DEFAULTS if name in sweep.runs), DEFAULTS[-1])
