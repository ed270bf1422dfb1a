"""`rubnoise report`: a result as one page to send to a colleague."""

from os.path import realpath  # unlike resolve, it takes a loop of links for a name
from pathlib import Path
from typing import Annotated

import typer

import rubnoise
from rubnoise.cli.options import ReplaceFile, ResultOrSweep


def command(
    file: ResultOrSweep,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="The page to write; default: RUN_report.html, in this folder.", metavar="OUT.html"
        ),
    ] = None,
    force: ReplaceFile = False,
) -> None:
    """Write a report of a result: its scenario in words, measured and exact figures, pictures, sound and origin.

    It is one file that a browser opens without a network, and it prints on A4.

    Example: rubnoise report fig5.h5 -o fig5_report.html
    """
    from rubnoise.answer import size
    from rubnoise.cli.layout import sentence
    from rubnoise.cli.loading import finished_run
    from rubnoise.cli.progress import stoppable
    from rubnoise.pages.report import run_report, sweep_report
    from rubnoise.regular_file import is_folder
    from rubnoise.storage.output import check_output, whole_file

    path = output or Path(f"{Path(realpath(file)).stem}_report.html")
    if path.suffix.lower() not in {".html", ".htm"}:
        raise typer.BadParameter(f"{path} does not end in .html")
    check_output(path, force=force, reads=[file])
    with stoppable() as between:
        if is_folder(file):
            with rubnoise.open_sweep(file) as sweep:
                text = sweep_report(sweep, between)
        else:
            with finished_run(file) as run:
                text = run_report(run, between)
    with whole_file(path, force=force) as part:
        part.write_text(text, encoding="utf-8")
    print(sentence(f"{path}: {size(path.stat().st_size)}; a browser opens and prints it"))
