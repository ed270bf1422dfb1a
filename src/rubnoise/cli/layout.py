"""Print an answer as wide as the terminal; and what commands without one print: lines of a label and a value, JSON."""

import json
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from math import isfinite
from textwrap import fill
from typing import Any, TextIO

from rubnoise.answer import Answer, finite, printable
from rubnoise.answer import as_json as as_json_text

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


def filled(text: str, first: str = "", others: str = "") -> str:
    """Return a text in lines of the terminal's width, broken between words, each with its indentation."""
    return fill(
        text, width(), initial_indent=first, subsequent_indent=others, break_long_words=False, break_on_hyphens=False
    )


def sentence(text: str) -> str:
    """Return a sentence broken between words on a terminal, otherwise in one line."""
    return text if columns_of(sys.stdout) is None else filled(text, "", "  ")


def table_row(label: str, numbers: str) -> str:
    """Return a row of a table, with its label above its numbers if the terminal is too narrow for one line.

    Both are padded to the width of their column, so that all rows are broken or none.
    """
    most = columns_of(sys.stdout)
    if most is None or len(label) + len(numbers) <= most:
        return (label + numbers).rstrip()
    return "\n".join(part.rstrip() for part in (label, f"  {numbers}") if part.strip())


def groups_that_fit(widths: Sequence[int]) -> list[list[int]]:
    """Return the numbers of a table's columns in groups that fit a terminal, each beginning with the first column.

    Without a terminal they are one group, for programs that read one row per line.
    """
    most = columns_of(sys.stdout)
    groups = [[0]]
    for number in range(1, len(widths)):
        taken = sum(widths[each] for each in groups[-1]) + widths[number]
        if most is not None and taken > max(most, NARROWEST) and len(groups[-1]) > 1:
            groups.append([0])
        groups[-1].append(number)
    return groups


def cut(text: str, stream: TextIO) -> str:
    """Return a line cut to the width of the terminal, since the next line of progress cannot overwrite a broken one."""
    columns = columns_of(stream)
    return text if columns is None else text[: columns - 1]


LABEL_WIDTH, SHORTER_LABEL_WIDTH, NARROW = 30, 25, 72
"""Columns of labels before their values, and the same on terminals of fewer columns than the last."""


def line(label: str, value: str, *, whole: bool = False) -> str:
    """Return one labelled value, indented below its heading; a long one takes several lines unless it is ``whole``."""
    head = f"  {label:<{LABEL_WIDTH if width() >= NARROW else SHORTER_LABEL_WIDTH}}"
    return head + printable(value) if whole else filled(printable(value), head, " " * len(head)) or head.rstrip()


def remark(text: str) -> str:
    """Return a sentence below the values."""
    return filled(text, "  ", "    ")


def number(value: float) -> str:
    """Return a number to seven digits."""
    return f"{value:.7g}"


def grouped(value: float) -> str:
    """Return a whole number with separated thousands."""
    return f"{round(value):,}" if isfinite(value) else str(value)


def about(value: float) -> str:
    """Return an estimated whole number, with three digits."""
    return f"about {grouped(float(f'{value:.3g}'))}"


def distance(um: float) -> str:
    """Return an estimated sliding distance, with two digits, in the unit that suits it."""
    for unit, length in (("m", 1e6), ("mm", 1e3)):
        if um >= length:
            return f"{_two_digits(um / length)} {unit}"
    return f"{_two_digits(um)} um"


def _two_digits(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.10g}"


def too_short_for_motion(decays: float, needed: float) -> str:
    """Return that a run is too short for standard errors of its slider's motion, and the distance that it needs."""
    return (
        f"the run is too short for standard errors of the slider's motion: it lasts {decays:.2g} of its decay times;"
        f" it needs about {distance(needed)}"
    )


def json_text(answer: Any, *, indent: int | None = None) -> str:
    """Return an answer as JSON: arrays as lists, and null for numbers that are not finite."""
    return json.dumps(finite(answer), allow_nan=False, indent=indent)


def show(answer: Answer, *, as_json: bool, as_csv: bool = False) -> None:
    """Print an answer as one JSON object, as CSV, or as text as wide as the terminal."""
    print(as_json_text(answer) if as_json else answer.to_csv() if as_csv else as_wide_text(answer))


def as_wide_text(answer: Answer) -> str:
    """Return an answer as text as wide as the terminal."""
    title, _, rest = answer.to_text(width()).partition("\n")
    return f"{sentence(title)}\n{rest}"
