"""`rubnoise figures`: the figures of the paper, drawn from scenarios, with the theory over them."""

from pathlib import Path
from typing import Annotated, Final

import typer

from rubnoise.cli.options import Quiet
from rubnoise.cli.progress import StatusLine, announce_compilation, on_terminal

PICTURES: Final = ("png", "pdf", "svg")


def command(
    names: Annotated[list[str] | None, typer.Argument(help="fig2, fig3 ... fig9, or all.", metavar="FIG")] = None,
    *,
    folder: Annotated[
        Path, typer.Option("-o", "--output", help="Folder of the pictures; created if missing.", metavar="DIR")
    ] = Path("figures"),
    formats: Annotated[
        list[str] | None,
        typer.Option(
            "--format",
            help="png, pdf or svg; repeat it for several; default: all three.",
            metavar="FORMAT",
            autocompletion=lambda: PICTURES,
        ),
    ] = None,
    scenarios: Annotated[
        Path | None,
        typer.Option(help="Folder with scenarios of these names, instead of the installed ones.", metavar="DIR"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace existing pictures.")] = False,
    quiet: Quiet = False,
) -> None:
    """Draw figures 2 to 9 of the paper: simulated by the scenarios of scenarios/paper, and by exact theory.

    Example: rubnoise figures fig4 fig8 -o figures --format png
    """
    from rubnoise.api.pictures import drawn_figures

    kinds = formats or PICTURES
    if not quiet:
        announce_compilation()
    with StatusLine(shown=on_terminal() and not quiet) as status:
        for file in drawn_figures(names or (), folder, kinds, scenarios, force=force, report=status.show):
            if not quiet:
                status.clear()
                print(file)
