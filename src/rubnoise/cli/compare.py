"""`rubnoise compare` and `rubnoise verify`: a result beside the theory of its scenario, or its run, played again."""

import sys
from contextlib import ExitStack, suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from rubnoise.answer import Row, printable
from rubnoise.cli.layout import show
from rubnoise.cli.options import AsCsv, AsJson, ResultFile, option
from rubnoise.cli.progress import bar
from rubnoise.cli.vocabulary import named
from rubnoise.errors import NotPassed, Refused
from rubnoise.regular_file import is_folder

if TYPE_CHECKING:
    from rubnoise.model import Model


def compare(
    file: ResultFile,
    *,
    bound: Annotated[float | None, option("Z", "Largest |z| that agrees; default: the bound of all figures.")] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Compare the rows of a result with exact theory.

    The exit code is 3 if a value is outside.

    Example: rubnoise compare fig5.h5
    """
    from rubnoise.api.run import Run
    from rubnoise.cli.loading import finished_run

    with finished_run(file) as result:
        run = Run(result)
        found = run.compare(bound)
        title = f"{file}: compared with the theory of its scenario"
        rows = (*found.rows, *_white_noise(run.model()))
        show(replace(found, title=title, rows=rows), as_json=as_json, as_csv=as_csv)
    if found.outside:
        raise NotPassed(f"{printable(str(file))}: outside: {', '.join(found.outside)}")


def _white_noise(model: "Model") -> list[Row]:
    """Return what white noise of the same level at low frequency (Kilburn) would make of a one-way slider, if any."""
    from rubnoise.theory.ancestors import white_noise

    if not model.is_two_way and model.separation is None:
        with suppress(Refused):
            white = white_noise(model)
            return named("white_noise", {name: white[name] for name in ("displacement_std", "velocity_std")})
    return []


def verify(
    file: ResultFile,
    *,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Play a run again, and compare every value of its result.

    The exit code is 3 if something differs.

    For the folder of a sweep, check its names and index too, and every run.

    Example: rubnoise verify fig5.h5
    """
    from rubnoise.cli.loading import finished_run
    from rubnoise.runs import verification

    whole = "its hashes and its run, played again"
    with ExitStack() as stack:
        show_bar = stack.enter_context(bar(shown=sys.stderr.isatty() and not as_json))
        if is_folder(file):
            whole = "its runs, made again, and the index of these"

            def watch(done: int, runs: int) -> None:
                show_bar(done, runs, f"{done:,} of {runs:,} runs")

            found = verification.verify_sweep(file, watch=watch)
        else:
            run = stack.enter_context(finished_run(file))
            run.watch = lambda column, row, rows: show_bar(row, rows, column)
            found = verification.verify(run)
    show(replace(found, title=f"{file}: compared with {whole}"), as_json=as_json, as_csv=as_csv)
    if found.different:
        said = [check.first for check in found.different]
        first = next((each for each in said if " row " in each), said[0])  # one with a row says most
        raise NotPassed(printable(f"{file}: differs: {first}{f'; {found.remark}' if found.remark else ''}"))
