"""Tables of text as testers write them: found by the shape of their rows, with names and units above, read in pieces.

Numbers are demanded of the columns that are used, and of no other.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from io import TextIOWrapper
from itertools import islice
from pathlib import Path
from typing import Final, Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream
from rubnoise.storage.samples import Source
from rubnoise.storage.text_form import MARKS, SHOWN, Form, moment
from rubnoise.storage.text_heads import LONGEST_NAME
from rubnoise.storage.text_layout import TableLayout, layout

LOOKED_AT: Final = 1000
"""Lines within which a table has to begin."""

LONGEST_LINE: Final = 1 << 20
_PIECE: Final = 1 << 16
"""Lines that are read at once."""

_SAID: Final = {
    "utf-8-sig": (),
    "utf-16": ("{}: is read as UTF-16",),
    "cp1252": ("{}: is not in UTF-8, and is read as Windows-1252",),
}

Line = tuple[int, str]
"""The number of a line, from 1 on, and its text."""


def encoding_of(path: Path) -> str:
    """Return the encoding of a text: UTF-16 by its first bytes, UTF-8 if all of it is, else Windows-1252."""
    with open_stream(path) as stream:
        if stream.read(2) in (b"\xff\xfe", b"\xfe\xff"):
            return "utf-16"
        stream.seek(0)
        reader = TextIOWrapper(stream, encoding="utf-8-sig")
        try:
            while reader.read(_PIECE):
                pass
        except UnicodeDecodeError:
            return "cp1252"
    return "utf-8-sig"


def lines_of(path: Path, encoding: str) -> Iterator[Line]:
    """Yield the lines of a text, which end in LF, CR LF or CR; raises Refused, with the line, if it is not one."""
    with open_stream(path) as stream, TextIOWrapper(stream, encoding=encoding, errors="replace") as reader:
        for number, text in enumerate(iter(lambda: reader.readline(LONGEST_LINE + 1), ""), 1):
            if "\0" in text:
                why = "holds a zero byte, so it is no text; save it as CSV in UTF-8"
                raise Refused(f"{path}: line {number}: {why}")
            if len(text) > LONGEST_LINE:
                why = f"has more than {LONGEST_LINE:,} characters; a table has a row for each sample"
                raise Refused(f"{path}: line {number}: {why}")
            yield number, text.rstrip("\n")


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTable(Source):
    """A table of text, whose columns are read when they are needed."""

    encoding: str
    layout: TableLayout

    @classmethod
    def of(cls, path: Path) -> Self:
        """Return the table in a text, of the form that fits best; raises Refused if there is none."""
        encoding = encoding_of(path)
        begun = [line for line in islice(lines_of(path, encoding), 10 * LOOKED_AT) if line[1].strip()][:LOOKED_AT]
        if not begun:
            raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
        forms = [Form(mark, decimal) for decimal in ".," for mark in "\t;, "]
        layouts = [found for form in forms if (found := layout(form, begun))]
        if not layouts:
            number, text = next((line for line in begun if _is_row(line[1])), begun[0])
            raise Refused(
                f"{path}: line {number}: {text.strip()[:SHOWN]!r}: no row of numbers in {len(begun)} lines; a"
                ' line of names such as "time (s),force (mN)" and a row for each sample are needed, parted by comma,'
                " semicolon, tab or spaces"
            )
        best = max(layouts, key=lambda each: each.worth)
        longest = max(len(head.written) for head in best.heads)
        if longest > LONGEST_NAME:
            where = f"line {best.head_line}"
            raise Refused(f"{path}: {where}: a name of {longest:,} characters; up to {LONGEST_NAME} are read")
        return cls(
            path=path,
            heads=best.heads,
            step=best.step,
            notes=tuple(each.format(path) for each in _SAID[encoding]),
            first=best.first,
            of_file=True,
            unnamed="" if best.head_line else f"line {best.first}",
            encoding=encoding,
            layout=best,
        )

    @property
    def where(self) -> str:
        """The file, and the line of the names."""
        return f"{self.path}: line {self.layout.head_line}" if self.layout.head_line else str(self.path)

    @property
    def usable(self) -> Sequence[int]:
        """The columns that have numbers or times in most rows."""
        return self.layout.usable

    def _rows(self) -> Iterator[Line]:
        """Yield the lines that are rows: neither empty nor comments."""
        lines = lines_of(self.path, self.encoding)
        return (line for line in lines if line[0] >= self.first and _is_row(line[1]))

    def columns(self, numbers: Sequence[int]) -> list[Doubles]:
        """Return columns, nan where no number stands."""
        rows = self._rows()
        kept = [np.empty((0, len(numbers)))]
        while texts := [text for _, text in islice(rows, _PIECE)]:
            kept.append(self._parsed(texts, numbers))
        found = np.concatenate(kept).T
        return [
            _over_midnight(each) if n in self.layout.clocks else each for n, each in zip(numbers, found, strict=True)
        ]

    def _parsed(self, texts: list[str], numbers: Sequence[int]) -> Doubles:
        """Return the values of rows: by numpy where they are plain, otherwise cell by cell."""
        mark, comma = self.layout.form.separator, self.layout.form.decimal == ","
        whole = "\n".join(texts)
        if '"' not in whole and not (comma and "." in whole) and self.layout.clocks.isdisjoint(numbers):
            changed = whole.replace(",", ".").split("\n") if comma else texts
            separator = None if mark == " " else mark
            begins = self.step is None or all(text.startswith(mark) for text in texts)
            if begins and set(map(self.layout.form.width, texts)) == {len(self.heads)}:
                with suppress(ValueError):
                    return np.loadtxt(changed, delimiter=separator, usecols=numbers, ndmin=2, comments=None)
        return np.array([self._row(self.layout.form.cells(text), numbers) for text in texts])

    def _row(self, cells: Sequence[str], numbers: Sequence[int]) -> list[float]:
        fits = self._fits(cells) and not self._is_of_segment(cells)
        found = [self._value(cells, n) if fits else None for n in numbers]
        return [np.nan if value is None else value for value in found]

    def _value(self, cells: Sequence[str], number: int) -> float | None:
        cell = cells[number] if number < len(cells) else ""
        return moment(cell, self.layout.first_day) if number in self.layout.clocks else self.layout.form.number(cell)

    def _fits(self, cells: Sequence[str]) -> bool:
        """Whether a row has a cell for each name; behind the last number a cell may be missing, an empty one added."""
        spare = len(cells) == len(self.heads) + 1 and not cells[-1]
        return max(self.layout.usable, default=0) < len(cells) <= len(self.heads) or spare

    def _is_of_segment(self, cells: Sequence[str]) -> bool:
        """Whether a row is of the head of another segment of LabVIEW, whose rows have no X_Value."""
        return self.step is not None and bool(cells[0])

    def place(self, row: int) -> str:
        """Return the line of a row, which is looked for again."""
        return f"line {next(islice(self._rows(), row, None))[0]}"

    def wrong(self, row: int, number: int) -> str:
        """Say why the cell of a row is no number."""
        cells = self.layout.form.cells(next(islice(self._rows(), row, None))[1])
        if self._is_of_segment(cells):
            return f"{cells[0][:SHOWN]!r} is no row; a trace is one segment"
        if not self._fits(cells):
            what = "names" if self.layout.head_line else "cells in other rows"
            return f"{len(cells)} cells; there are {len(self.heads)} {what}"
        name = self.heads[number].name
        if self._value(cells, number) is not None:
            return f"{name} is nan; every sample needs a number"
        return f"{name}: {(cells[number] if number < len(cells) else '').strip()[:SHOWN]!r} is no number"


def _is_row(text: str) -> bool:
    return text[:1] not in MARKS and bool(text.strip())


def _over_midnight(times: Doubles) -> Doubles:
    """Return clock times that go on after midnight."""
    back = np.diff(times, prepend=times[:1]) < -43200.0
    found: Doubles = times + 86400.0 * np.cumsum(back)
    return found
