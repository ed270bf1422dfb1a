"""`rubnoise verify`: check that every value of a result file is right."""

from dataclasses import replace
from typing import Annotated

import typer

from rubnoise.answer import printable
from rubnoise.cli.layout import show
from rubnoise.cli.options import AsJson, ResultFile
from rubnoise.cli.progress import bar, on_terminal, watching_reads
from rubnoise.errors import NotPassed
from rubnoise.regular_file import is_folder


def command(
    file: ResultFile,
    *,
    regenerate: Annotated[
        bool,
        typer.Option(
            "--regenerate",
            help="Refuse a file whose random numbers cannot be drawn again here; rows are made again in any case.",
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Play a run again, and compare every value of its result.

    The exit code is 3 if something differs.

    For the folder of a sweep, check its names and index too, and every run.

    Example: rubnoise verify fig5.h5
    """
    from rubnoise.cli.loading import finished_run
    from rubnoise.runs.verification import verify

    shown = on_terminal() and not as_json
    if is_folder(file):
        from rubnoise.runs.verify import verify_sweep

        with bar(shown=shown) as show_bar:
            found = verify_sweep(
                file, int(regenerate), lambda done, runs: show_bar(done, runs, f"{done:,} of {runs:,} runs")
            )
    else:
        with finished_run(file) as run, watching_reads(run, shown=shown):
            found = verify(run, int(regenerate))
    whole = (
        "its runs, made again, and the index of these" if is_folder(file) else "its hashes and its run, played again"
    )
    show(replace(found, title=f"{file}: compared with {whole}"), as_json=as_json)
    if found.different:
        places = [check.first for check in found.different if check.first is not None]
        first = next((place for place in places if place.row is not None), places[0])  # one with a row says most
        raise NotPassed(printable(f"{file}: differs: {first}{f'; {found.remark}' if found.remark else ''}"))
