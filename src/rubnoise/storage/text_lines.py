"""Lines of a text in whatever encoding it has."""

from collections.abc import Iterator
from contextlib import suppress
from io import TextIOWrapper
from itertools import islice
from pathlib import Path
from typing import Final

from rubnoise.regular_file import open_stream

ENCODINGS: Final = {"utf-8-sig": (), "utf-16": ("read as UTF-16",), "cp1252": ("read as Windows-1252",)}
"""What is said of a text by its encoding."""

_LONGEST_LINE: Final = 1 << 17  # as the module csv has it of a cell

Line = tuple[int, str]
"""The number of a line, from 1 on, and its text."""


def begin_of(path: Path, most: int | None = None) -> tuple[str, list[Line]]:
    """Return the encoding of a text, and its first lines in it: the first one of ENCODINGS that fits them."""
    for encoding in ENCODINGS:
        with suppress(UnicodeError):
            return encoding, list(islice(lines_of(path, encoding, "strict"), most))
    return "cp1252", list(islice(lines_of(path, "cp1252"), most))


def lines_of(path: Path, encoding: str, errors: str = "replace") -> Iterator[Line]:
    """Yield lines with their numbers, from 1 on, which end in LF, CR LF or CR; what is too long for one, in pieces."""
    with open_stream(path) as stream, TextIOWrapper(stream, encoding=encoding, errors=errors) as reader:
        lines = iter(lambda: reader.readline(_LONGEST_LINE), "")
        yield from enumerate((text.rstrip("\n") for text in lines), 1)
