"""`rubnoise verify`: check that every value of a result file is right."""

from dataclasses import replace
from typing import Annotated, Any, Final

import typer

from rubnoise.answer import printable
from rubnoise.cli.commands import Command
from rubnoise.cli.layout import show
from rubnoise.cli.options import AsJson, ResultFile
from rubnoise.cli.progress import bar, on_terminal, watching_reads
from rubnoise.errors import RunDiffers
from rubnoise.regular_file import is_folder

REGENERATE: Final = "--regenerate"


class BareCount(Command):
    """A command whose option --regenerate may have no number."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Add the default number to the option if it has none."""
        words = []
        for word, following in zip(args, [*args[1:], ""], strict=True):
            bare = word == REGENERATE and not following.lstrip("-").isdigit()
            words += [word, "1"] if bare else [word]
        return super().parse_args(ctx, words)


SETTINGS: Final = {"cls": BareCount}
"""How the command is registered."""


def command(
    file: ResultFile,
    *,
    regenerate: Annotated[
        int | None,
        typer.Option(
            REGENERATE,
            help="Refuse a file whose random numbers cannot be drawn again here; rows are made again in any case.",
            metavar="[K]",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Play a run again, and compare every value of its result.

    The exit code is 3 if something differs.

    For the folder of a sweep, check its names and index too, and every run.

    Example: rubnoise verify fig5.h5
    """
    from rubnoise.cli.loading import finished_run
    from rubnoise.runs.verification import verify

    if regenerate is not None and regenerate < 1:
        raise typer.BadParameter(f"{REGENERATE}: {regenerate} is no number; it is 1 or more")
    blocks, shown = regenerate or 0, on_terminal() and not as_json
    if is_folder(file):
        from rubnoise.runs.verify import verify_sweep

        with bar(shown=shown) as show_bar:
            found = verify_sweep(file, blocks, lambda done, runs: show_bar(done, runs, f"{done:,} of {runs:,} runs"))
    else:
        with finished_run(file) as run, watching_reads(run, shown=shown):
            found = verify(run, blocks)
    whole = (
        "its runs, made again, and the index of these" if is_folder(file) else "its hashes and its run, played again"
    )
    show(replace(found, title=f"{file}: compared with {whole}"), as_json=as_json)
    if found.different:
        places = [check.first for check in found.different if check.first is not None]
        first = next((place for place in places if place.row is not None), places[0])  # one with a row says most
        raise RunDiffers(printable(f"{file}: differs: {first}{f'; {found.remark}' if found.remark else ''}"))
