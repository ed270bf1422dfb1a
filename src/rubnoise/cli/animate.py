"""`rubnoise animate`: a run as a film for slides."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rubnoise.cli.layout import printable, sentence, size
from rubnoise.cli.options import ReplaceFile, ResultFile, StretchEnd, StretchStart
from rubnoise.cli.plot import distance
from rubnoise.cli.progress import stoppable

if TYPE_CHECKING:
    from rubnoise.figures.film import Kind


def command(
    file: ResultFile,
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="A gif or mp4 file; default: RUN.gif, in this folder.", metavar="FILM"),
    ] = None,
    start: StretchStart = None,
    stop: StretchEnd = None,
    seconds: Annotated[float, typer.Option(help="Length of the film.", metavar="T", min=0.1, max=600.0)] = 8.0,
    rate: Annotated[int, typer.Option("--fps", help="Frames a second.", metavar="N", min=1, max=50)] = 20,
    force: ReplaceFile = False,
) -> None:
    """Draw a run as a film: its junctions sliding over each other, and the growing real contact area below.

    Example: rubnoise animate fig5.h5 -o contact.gif --to 60
    """
    from rubnoise.cli.loading import finished_run
    from rubnoise.figures.animation import Film
    from rubnoise.figures.film import write_film
    from rubnoise.figures.stretch import Stretch
    from rubnoise.storage.output import whole_file

    ends = distance("--from", start), distance("--to", stop)
    path = output or Path(f"{file.stem}.gif")
    kind = _kind(path, file, force=force)
    with finished_run(file) as run, stoppable() as between:
        film = Film.of(Stretch.of(run, *ends), seconds=seconds, rate=rate)
        with whole_file(path, force=force) as part:
            write_film(part, film, kind, between)
    count, shown = film.distances.size, film.stretch
    stretch = f"{shown.start:g} to {shown.stop:g} um of sliding"
    print(sentence(f"{path}: {count} frames, {stretch}, {size(path.stat().st_size)}"))


def _kind(path: Path, file: Path, *, force: bool) -> "Kind":
    """Return the format of a path's ending; raises Refused if it cannot be made, or the path not be written."""
    from rubnoise.figures.film import KINDS, check_film
    from rubnoise.storage.output import check_output

    kind = next((kind for kind in KINDS if path.suffix.lower() == f".{kind}"), None)
    if kind is None:
        raise typer.BadParameter(f"{printable(str(path))} ends neither in .gif nor in .mp4")
    check_output(path, force=force, reads=[file])
    check_film(kind)
    return kind
