"""Print an answer as wide as the terminal; and what commands without one print: lines of a label and a value."""

import json
import os
import sys
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TextIO

from rubnoise.answer import Answer, length
from rubnoise.answer import sentence as broken

WIDTH = 80
"""Columns of text that goes to no terminal."""

NARROWEST = 40
"""Columns below which nothing is laid out any narrower."""


def columns_of(stream: TextIO) -> int | None:
    """Return the width of a stream's terminal, None without a terminal; COLUMNS in the environment takes precedence."""
    with suppress(ValueError):
        if (wanted := int(os.environ.get("COLUMNS", ""))) > 0:
            return wanted
    try:
        # A terminal that does not know its size says 0.
        return os.get_terminal_size(stream.fileno()).columns or None
    except (OSError, ValueError):
        return None


def width() -> int:
    """Return the width of text on standard output."""
    return max(columns_of(sys.stdout) or WIDTH, NARROWEST)


def sentence(text: str, indent: str = "") -> str:
    """Return a sentence broken between words on a terminal, otherwise in one line."""
    return indent + text if columns_of(sys.stdout) is None else broken(text, width(), indent)


def too_short_for_motion(decays: float, needed: float) -> str:
    """Return that a run is too short for standard errors of its slider's motion, and the distance that it needs."""
    return (
        f"the run is too short for standard errors of the slider's motion: it lasts {decays:.2g} of its decay times;"
        f" it needs about {length(needed)}"
    )


def show(answer: Answer, *, as_json: bool, as_csv: bool = False) -> None:
    """Print an answer as one JSON object, as CSV, or as text as wide as the terminal."""
    if as_json:
        print(json.dumps(answer.to_json(), allow_nan=False))
    else:
        print(answer.to_csv() if as_csv else as_wide_text(answer))


def as_wide_text(answer: Answer) -> str:
    """Return an answer as text as wide as the terminal."""
    title, *rest = answer.to_text(width(), columns_of(sys.stdout)).split("\n", 1)
    return "\n".join([sentence(title), *rest])


def write_texts(texts: Mapping[Path, str], *, force: bool) -> None:
    """Write texts into files, which get their names when all are written: all or none."""
    from rubnoise.storage.output import whole_file

    with ExitStack() as files:
        for path, text in texts.items():
            files.enter_context(whole_file(path, force=force)).write_text(text, encoding="utf-8")
