"""`rubnoise new`: a scenario file to begin with."""

from pathlib import Path
from typing import Annotated

import typer


def command(
    file: Annotated[Path, typer.Argument(help="The scenario file to make; it must not exist.", metavar="NAME.toml")],
) -> None:
    """Make a scenario file with every key of this version, each explained, the optional ones as comments.

    It runs as it is. An existing file is never replaced.

    Example: rubnoise new contact.toml
    """
    from rubnoise.errors import OutputRefused
    from rubnoise.scenario.template import template

    text = template()
    try:
        with file.open("x", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
    except FileExistsError as problem:
        raise OutputRefused(f"{file}: exists already, and is left as it is; choose another name") from problem
    except FileNotFoundError as problem:
        raise OutputRefused(f"{file.parent}: no such folder") from problem
    except OSError as problem:
        raise OutputRefused(f"{file}: cannot be written: {problem.strerror}") from problem
    print(f"{file}: written; `rubnoise check {file}` says what it means, `rubnoise run {file}` runs it")
