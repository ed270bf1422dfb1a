"""`rubnoise view`: a result as a page to explore in a browser."""

from os.path import realpath  # unlike resolve, it takes a loop of links for a name
from pathlib import Path
from typing import Annotated

import typer

import rubnoise
from rubnoise.cli.options import ReplaceFile, ResultOrSweep, StretchEnd, StretchStart


def command(
    file: ResultOrSweep,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="The page to write; default: RUN.html, in this folder.", metavar="OUT.html"
        ),
    ] = None,
    start: StretchStart = None,
    stop: StretchEnd = None,
    force: ReplaceFile = False,
) -> None:
    """Write a page to explore a result: curves to zoom into, a bar for the life of each junction, and filters.

    One file, which a browser opens without a network. Of a long run it holds every life and the ticks of a stretch.

    Example: rubnoise view fig5.h5 --from 1mm --to 2mm
    """
    from rubnoise.answer import size
    from rubnoise.cli.layout import sentence
    from rubnoise.cli.loading import finished_run
    from rubnoise.cli.plot import distance
    from rubnoise.figures.stretch import Stretch
    from rubnoise.pages.run_view import RunView
    from rubnoise.pages.sweep_view import sweep_page
    from rubnoise.regular_file import is_folder
    from rubnoise.storage.output import check_output, whole_file

    ends = distance("--from", start), distance("--to", stop)
    path = output or Path(f"{Path(realpath(file)).stem}.html")
    if path.suffix.lower() not in {".html", ".htm"}:
        raise typer.BadParameter(f"{path} does not end in .html")
    check_output(path, force=force, reads=[file])
    if is_folder(file):
        if ends != (None, None):
            raise typer.BadParameter("--from and --to are for one run")
        with rubnoise.open_sweep(file) as sweep:
            text, what = sweep_page(sweep, str(file)), f"{sweep.count('done'):,} runs"
    else:
        with finished_run(file) as run:
            view = RunView.of(Stretch.of(run, *ends), str(file))
            text, what = view.page(), f"every tick from {view.stretch.start:g} to {view.stretch.stop:g} um"
    with whole_file(path, force=force) as written:
        written.write_text(text, encoding="utf-8")
    print(sentence(f"{path}: {what}, {size(path.stat().st_size)}; a browser opens it, with or without a network"))
