"""Print an answer as wide as the terminal; and what commands without one print: lines of a label and a value."""

import json
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from shutil import get_terminal_size
from typing import TextIO

from rubnoise.answer import Answer
from rubnoise.answer import sentence as broken

WIDTH = 80  # columns of text that goes to no terminal
NARROWEST = 40  # columns below which nothing is laid out any narrower


def terminal_width() -> int | None:
    """Return the width of the terminal, None without one; COLUMNS in the environment takes precedence."""
    return get_terminal_size((0, 0)).columns or None


def width() -> int:
    """Return the width of text on standard output."""
    return max(terminal_width() or WIDTH, NARROWEST)


def sentence(text: str, indent: str = "") -> str:
    """Return a sentence broken between words on a terminal, otherwise in one line."""
    return indent + text if terminal_width() is None else broken(text, width(), indent)


def show(answer: Answer, *, as_json: bool = False, as_csv: bool = False, to: TextIO | None = None) -> None:
    """Print an answer as one JSON object, as CSV, or as text as wide as the terminal; ``to`` another stream."""
    if as_json:
        text = json.dumps(answer.to_json(), allow_nan=False)
    elif as_csv:
        text = answer.to_csv()
    else:
        title, *rest = answer.to_text(width(), terminal_width()).split("\n", 1)
        text = "\n".join([sentence(title), *rest])
    print(text, file=to)


def write_texts(texts: Mapping[Path, str], *, force: bool) -> None:
    """Write texts into files, which get their names when all are written: all or none."""
    from rubnoise.storage.output import whole_file

    with ExitStack() as files:
        for path, text in texts.items():
            files.enter_context(whole_file(path, force=force)).write_text(text, encoding="utf-8")
