"""How wide the terminal is, and how what is printed keeps within it."""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from textwrap import fill
from typing import TextIO

WIDTH = 80
"""Columns of text that goes to no terminal."""

NARROWEST = 40
"""Columns below which nothing is laid out any narrower."""


def columns_of(stream: TextIO) -> int | None:
    """Return the columns of the terminal behind a stream, None where there is none; COLUMNS in the environment wins."""
    with suppress(ValueError):
        if (wanted := int(os.environ.get("COLUMNS", ""))) > 0:
            return wanted
    try:
        # A terminal that does not know its size says 0.
        return os.get_terminal_size(stream.fileno()).columns or None
    except (OSError, ValueError):
        return None


def width() -> int:
    """Return the columns of text on standard output."""
    return max(columns_of(sys.stdout) or WIDTH, NARROWEST)


def filled(text: str, first: str = "", others: str = "") -> str:
    """Return a text in lines of the terminal's width, broken between words, with what each begins with."""
    return fill(
        text, width(), initial_indent=first, subsequent_indent=others, break_long_words=False, break_on_hyphens=False
    )


def sentence(text: str) -> str:
    """Return a sentence broken between words on a terminal, and in one line elsewhere."""
    return text if columns_of(sys.stdout) is None else filled(text, "", "  ")


def headed(label: str, numbers: str) -> str:
    """Return a row of a table, its label above its numbers where the terminal is too narrow for both in a line.

    Both come padded to the widths that they have in every row, so that all rows are broken or none.
    """
    most = columns_of(sys.stdout)
    if most is None or len(label) + len(numbers) <= most:
        return (label + numbers).rstrip()
    return "\n".join(part.rstrip() for part in (label, f"  {numbers}") if part.strip())


def groups_that_fit(widths: Sequence[int]) -> list[list[int]]:
    """Return the numbers of the columns of a table in groups that fit a terminal, each beginning with the first column.

    Elsewhere than on a terminal they are one group, for programs that read a row a line.
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
    """Return a line, without its end where that would run over: a broken line is not written over by the next one."""
    columns = columns_of(stream)
    return text if columns is None else text[: columns - 1]
