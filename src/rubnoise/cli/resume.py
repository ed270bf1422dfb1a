"""`rubnoise resume`: a run that did not finish goes on."""

from pathlib import Path
from typing import Annotated

import typer

from rubnoise.cli.progress import interrupted_at_once


@interrupted_at_once
def command(
    part: Annotated[
        Path,
        typer.Argument(help="The part file of an unfinished run.", metavar="RUN.h5.part", show_default=False),
    ],
    *,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing result.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print only errors.")] = False,
) -> None:
    """Resume a run after a signal, a kill, a full disk or a power cut, with the same bits.

    Example: rubnoise resume fig5.h5.part
    """
    import time

    from rubnoise import api
    from rubnoise.api.resuming import distance_of
    from rubnoise.cli.outcome import tell
    from rubnoise.cli.progress import announce_compilation, on_terminal, watching
    from rubnoise.cli.starting import prepare_kernels

    prepare_kernels()
    shown = on_terminal() and not quiet and not as_json
    began = time.monotonic()
    distance = distance_of(part)
    if shown:
        announce_compilation()
    with watching(distance, shown=shown) as watcher:
        result = api.resume(part, force=force, watch=watcher)
    with result:
        tell(result, part.with_suffix(""), time.monotonic() - began, as_json=as_json, quiet=quiet)
