"""Pictures on their way into files: what is refused before anything is drawn, and how a file gets its final name."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from rubnoise.figures.style import Format


def check_picture(path: Path, *, force: bool) -> "Format":
    """Return the format that a path's ending names; raises Refused where nothing may or can be written there."""
    from rubnoise.cli.layout import printable
    from rubnoise.figures.style import FORMATS
    from rubnoise.storage.output import check_output

    kind = next((kind for kind in FORMATS if path.suffix.lower() == f".{kind}"), None)
    if kind is None:
        raise typer.BadParameter(f"{printable(str(path))} ends in none of .png, .pdf and .svg")
    check_output(path, force=force)
    return kind


def write_picture(path: Path, draw: "Callable[[Format], bytes]", *, force: bool) -> None:
    """Draw a picture in the format of its file's ending, write the file whole or not at all, and print its name."""
    from rubnoise.storage.output import whole_file

    picture = draw(check_picture(path, force=force))
    with whole_file(path, force=force) as part:
        part.write_bytes(picture)
    print(path)
