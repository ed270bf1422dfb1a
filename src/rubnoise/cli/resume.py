"""`rubnoise resume`, of an earlier version: it says what to do now."""

from pathlib import Path
from typing import Annotated, Final

import typer

from rubnoise.cli.options import AsJson, Quiet, ReplaceResult
from rubnoise.errors import Refused

SETTINGS: Final = {"hidden": True}
"""How the command is registered."""


def command(
    part: Annotated[Path, typer.Argument(help="What an interrupted run has left.", metavar="RUN.h5.part")],
    *,
    force: ReplaceResult = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Say how to make an interrupted run again; nothing is resumed.

    Example: rubnoise resume fig5.h5.part
    """
    del force, as_json, quiet
    raise Refused(
        f"{part}: runs are not resumed any more; the `rubnoise run` that began it makes it again, with the same bits"
    )
