"""`rubnoise plot`: pictures of a run, simulation and theory in each."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class What(StrEnum):
    """The pictures there are."""

    TRACE = "trace"
    LIVES = "lives"
    HISTOGRAM = "histogram"
    PSD = "psd"
    ACF = "acf"
    COUNT = "count"
    SLIDER = "slider"


def command(
    file: Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5", show_default=False)],
    what: Annotated[What, typer.Argument(help="The picture.")] = What.TRACE,
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
    """Draw a run: its area, single lives, distribution, spectrum, autocovariance, count or slider, beside theory.

    Example: rubnoise plot fig5.h5 psd -o spectrum.pdf
    """
    from rubnoise.cli.lengths import distance
    from rubnoise.cli.pictures import check_picture, write_picture
    from rubnoise.cli.results import finished_run
    from rubnoise.errors import Refused
    from rubnoise.figures.catalogue import picture
    from rubnoise.figures.stretch import Stretch

    ends = distance("--from", start), distance("--to", stop)
    path = output or Path(f"{file.stem}_{what}.png")
    check_picture(path, force=force)
    if file.is_dir():
        raise Refused(f"{file}: is a folder; plot draws one result at a time")
    with finished_run(file) as run:
        stretch = Stretch.of(run, *ends)
        write_picture(path, lambda kind: picture(what.value, stretch, kind), force=force)
