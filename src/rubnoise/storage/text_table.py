"""Tables of text as testers write them: found by the shape of their rows, with names and units above, read in pieces.

Numbers are demanded of the columns that are used, and of no other.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from io import TextIOWrapper
from itertools import islice, zip_longest
from pathlib import Path
from typing import Final, Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream
from rubnoise.storage.measured import Source
from rubnoise.storage.text_heads import LONGEST_NAME, NONE, Head, head_of, is_unit, spelled

MARKS: Final = ("#", "%")
"""What a comment begins with, or a line of names."""

ENCODINGS: Final = {
    "utf-8-sig": (),
    "utf-16": ("read as UTF-16",),
    "cp1252": ("read as Windows-1252",),
}
"""What is said of a text by its encoding."""

_LOOKED_AT: Final = 1000  # lines within which a table has to begin
_LONGEST_LINE: Final = 1 << 20
_PIECE: Final = 1 << 16  # lines that are read at once
_SHOWN: Final = 40  # characters of a cell in a message
_GAPS: Final = " '\u2019\u00a0\u2009\u202f"
_WHOLE: Final = rf"[0-9]+|[0-9]{{1,3}}(?:[{_GAPS}][0-9]{{3}})+"
_NUMBERS: Final = {
    decimal: re.compile(rf"[+-]?(?:{forms})(?:[eEdD][+-]?[0-9]+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
    for decimal, forms in (
        (".", rf"(?:{_WHOLE})\.?[0-9]*|\.[0-9]+|[1-9][0-9]{{0,2}}(?:,[0-9]{{3}})+\.[0-9]+"),
        (",", rf"(?:{_WHOLE})(?:,[0-9]+)?|,[0-9]+|[1-9][0-9]{{0,2}}(?:\.[0-9]{{3}})+(?:,[0-9]+)?"),
    )
}
_PLAIN: Final = {
    decimal: str.maketrans({**dict.fromkeys(_GAPS + other, ""), decimal: ".", "d": "e", "D": "e"})
    for decimal, other in (".,", ",.")
}
_MOMENT: Final = re.compile(
    r"(?:[0-9]{1,4}([-/.])[0-9]{1,2}\1[0-9]{1,4}[T ] *)?([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}(?:[.,][0-9]+)?))?"
    r" *([aApP])?(?:[mM])?(?:Z| ?[+-][0-9]{2}:?[0-9]{2})?"
)
_NAMES_BY_SPACES: Final = re.compile(r"[^\s(\[]+(?: ?[(\[][^)\]]*[)\]])?")

Line = tuple[int, str]
"""The number of a line, from 1 on, and its text."""

Worth = tuple[bool, float, int, int]
"""How well a form fits: whether there is a name for each column, the share of numbers, the rows, the cells."""


@dataclass(frozen=True, slots=True)
class Form:
    """How a table is written: the separator of its cells (a space: any number), and what decimals follow."""

    separator: str
    decimal: str

    def cells(self, text: str) -> list[str]:
        """Return the cells of a row; quotes around a cell are no part of it."""
        if self.separator == " ":
            return text.split()
        if '"' in text and len(text) < csv.field_size_limit():
            return next(csv.reader([text], delimiter=self.separator, skipinitialspace=True))
        return [cell.strip() for cell in text.split(self.separator)]

    def names(self, text: str, width: int) -> list[str]:
        """Return the cells of a line of names, whose spaces part words as well as columns."""
        text = text.lstrip("".join(MARKS)).strip(" \r")
        if self.separator != " ":
            return [cell.strip().strip('"').strip() for cell in self.cells(text)]
        ways = (re.split(r"\s{2,}|\t", text), _NAMES_BY_SPACES.findall(text[: 20 * LONGEST_NAME]))
        return next((way for way in ways if len(way) == width), text.split())

    def number(self, cell: str) -> float | None:
        """Return the number in a cell; None if it is not a number."""
        text = cell.strip().replace("\u2212", "-")
        return float(text.translate(_PLAIN[self.decimal])) if _NUMBERS[self.decimal].fullmatch(text) else None

    def kind(self, cell: str) -> str:
        """Return "number" or "time" for a cell that is one; an empty text for others."""
        return "number" if self.number(cell) is not None else "time" if moment(cell) is not None else ""


def moment(cell: str) -> float | None:
    """Return the seconds since midnight of a date with time, or of a clock: steps between samples need no dates."""
    if (found := _MOMENT.fullmatch(cell.strip())) is None:
        return None
    _, hours, minutes, seconds, half = found.groups()
    hour = int(hours) if half is None else int(hours) % 12 + 12 * (half in "pP")
    return 3600.0 * hour + 60.0 * int(minutes) + float((seconds or "0").replace(",", "."))


def encoding_of(path: Path) -> str:
    """Return the encoding of a text: UTF-16 by its first bytes, UTF-8 if all of it is, else Windows-1252."""
    with open_stream(path) as stream:
        if stream.read(2) in (b"\xff\xfe", b"\xfe\xff"):
            return "utf-16"
        stream.seek(0)
        reader = TextIOWrapper(stream, encoding="utf-8-sig")
        with suppress(UnicodeDecodeError):
            while reader.read(_PIECE):
                pass
            return "utf-8-sig"
    return "cp1252"


def lines_of(path: Path, encoding: str) -> Iterator[Line]:
    """Yield lines with their numbers, from 1 on, which end in LF, CR LF or CR; raises Refused if it is no text."""
    with open_stream(path) as stream, TextIOWrapper(stream, encoding=encoding, errors="replace") as reader:
        for number, text in enumerate(iter(lambda: reader.readline(_LONGEST_LINE + 1), ""), 1):
            if "\0" in text:
                raise Refused(f"{path}: line {number}: holds a zero byte, so it is no text; save it as CSV in UTF-8")
            if len(text) > _LONGEST_LINE:
                why = f"has more than {_LONGEST_LINE:,} characters; a table has a row for each sample"
                raise Refused(f"{path}: line {number}: {why}")
            yield number, text.rstrip("\n")


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTable(Source):
    """A table of text, whose columns are read when they are needed; ``first`` is the line where its rows begin."""

    encoding: str
    form: Form
    first: int

    def _rows(self) -> Iterator[Line]:
        """Yield the lines that are rows: neither empty nor comments."""
        lines = lines_of(self.path, self.encoding)
        return (line for line in lines if line[0] >= self.first and line[1].strip() and line[1][0] not in MARKS)

    def with_columns(self, numbers: Sequence[int]) -> Self:
        """Return the table with some columns in memory, nan where no number stands; clocks go on after midnight."""
        rows, kept = self._rows(), [np.empty((0, len(numbers)))]
        while texts := [text for _, text in islice(rows, _PIECE)]:
            kept.append(self._parsed(texts, numbers))
        arrays = dict(zip(numbers, np.concatenate(kept).T, strict=True))
        for number in (number for number in numbers if self.heads[number].kind == "time"):
            back = np.diff(arrays[number], prepend=arrays[number][:1]) < -43200.0
            arrays[number] = arrays[number] + 86400.0 * np.cumsum(back)
        return replace(self, arrays=arrays)

    def _parsed(self, texts: list[str], numbers: Sequence[int]) -> Doubles:
        """Return the values of rows: by numpy where they are plain, otherwise cell by cell."""
        mark, comma, whole = self.form.separator, self.form.decimal == ",", "\n".join(texts)
        plain = (
            '"' not in whole and not (comma and "." in whole) and "time" not in [self.heads[n].kind for n in numbers]
        )
        if plain and not (self._is_unplaced and any(not text.startswith(mark) for text in texts)):
            widths = {len(text.split()) if mark == " " else text.count(mark) + 1 for text in texts}
            changed = whole.replace(",", ".").split("\n") if comma else texts
            with suppress(ValueError):
                if widths == {len(self.heads)}:
                    mark_or_none = None if mark == " " else mark
                    return np.loadtxt(changed, delimiter=mark_or_none, usecols=numbers, ndmin=2, comments=None)
        rows = [cells if self._fits(cells) else [] for cells in map(self.form.cells, texts)]
        found = [[self._value(cells, number) for number in numbers] for cells in rows]
        return np.array(found, dtype=np.float64)

    def _value(self, cells: Sequence[str], number: int) -> float | None:
        cell = cells[number] if number < len(cells) else ""
        return moment(cell) if self.heads[number].kind == "time" else self.form.number(cell)

    @property
    def _is_unplaced(self) -> bool:
        """Whether rows begin with an empty cell, since LabVIEW says their step alone; heads of its segments do not."""
        return self.heads[0].name == "X_Value" and not self.heads[0].kind

    def _fits(self, cells: Sequence[str]) -> bool:
        """Whether a row has a cell for each name; behind the last number a cell may be missing, an empty one added."""
        spare = len(cells) == len(self.heads) + 1 and not cells[-1]
        wide = max(self.usable, default=0) < len(cells) <= len(self.heads) or spare
        return wide and not (self._is_unplaced and cells[0])

    def _row(self, row: int) -> Line:
        return next(islice(self._rows(), self.begin + row, None))

    def place(self, row: int) -> str:
        """Return the line of a row, which is looked for again."""
        return f"line {self._row(row)[0]}"

    def wrong(self, row: int, number: int) -> str:
        """Say why the cell of a row is no number."""
        cells = self.form.cells(self._row(row)[1])
        if self._is_unplaced and cells[0]:
            return f"{cells[0][:_SHOWN]!r} is no row; a trace is one segment"
        if not self._fits(cells):
            what = "names" if self.head_line else "cells in other rows"
            return f"{len(cells)} cells; there are {len(self.heads)} {what}"
        name = self.heads[number].name
        if self._value(cells, number) is not None:
            return f"{name} is nan; every sample needs a number"
        return f"{name}: {(cells[number] if number < len(cells) else '').strip()[:_SHOWN]!r} is no number"


def read_table(path: Path) -> TextTable:
    """Return the table in a text, of the form that fits best; raises Refused if there is none."""
    encoding = encoding_of(path)
    lines = list(islice((line for line in lines_of(path, encoding) if line[1].strip()), _LOOKED_AT))
    if not lines:
        raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
    forms = [Form(mark, decimal) for decimal in ".," for mark in "\t;, "]
    tables = [found for form in forms if (found := _table(path, encoding, form, lines))]
    if not tables:
        number, text = next((line for line in lines if line[1][0] not in MARKS), lines[0])
        raise Refused(
            f"{path}: line {number}: {text.strip()[:_SHOWN]!r}: no row of numbers in {len(lines)} lines; a line of"
            ' names such as "time (s),force (mN)" and a row for each sample are needed, parted by comma, semicolon, tab'
            " or spaces"
        )
    return max(tables, key=lambda each: each[0])[1]


def _table(path: Path, encoding: str, form: Form, lines: Sequence[Line]) -> tuple[Worth, TextTable] | None:
    """Return the table that the first lines of a text have in one form, None if none has a number in it."""
    rows = [form.cells(text) if text[0] not in MARKS else [] for _, text in lines]
    shapes = [tuple(map(form.kind, cells)) for cells in rows]
    usual = Counter(shape for shape in shapes if any(shape)).most_common(1)
    if not usual:
        return None
    (shape, count), width = usual[0], len(usual[0][0])
    runs = (at for run in (4, 2, 1) for at in range(len(shapes)) if shapes[at : at + run] == run * [shape])
    begin = next(runs)
    at, names, units = _names_above(form, lines, rows, shapes, begin, width)
    said = {row[0]: row[1:] for row in rows[: max(at, 0)] if row}
    step, below = 0.0, bool(units)
    if names[0] == "X_Value" and said.get("X_Dimension", [""])[0] == "Time":
        step, units = form.number(said.get("Delta_X", [""])[0]) or 0.0, ["s", *said.get("Y_Unit_Label", [])]
    heads = []
    for name, unit, kind, n in zip_longest(names, units, shape, range(1, max(width, len(names)) + 1), fillvalue=""):
        head = head_of(name) if name else Head(f"column {n}", "", "")
        heads.append(replace(head, unit="s" if kind == "time" else head.unit or spelled(unit), kind=kind))
    alone = width == 1 and at >= 0 and any(mark in lines[at][1].strip() for mark in "\t;,")
    share = sum(map(bool, shape)) / sum(map(bool, rows[begin]))
    first = next(n for n, each in enumerate(shapes) if len(each) == width and any(each)) if at < 0 else at + 1 + below
    return (at >= 0 and len(heads) == width and not alone, share, count, width), TextTable(
        path=path,
        heads=heads,
        step=0.0 if shape[0] else step,
        notes=tuple(f"{path}: {each}" for each in ENCODINGS[encoding]),
        of_file=True,
        head_line=0 if at < 0 else lines[at][0],
        encoding=encoding,
        form=form,
        first=lines[first][0],
    )


def _names_above(
    form: Form,
    lines: Sequence[tuple[int, str]],
    rows: list[list[str]],
    shapes: list[tuple[str, ...]],
    begin: int,
    width: int,
) -> tuple[int, list[str], list[str]]:
    """Return the line of names above a table, the names, and the units below them; -1 if there is none.

    Best are names with units, then those that are no comment, then the nearest.
    """
    best: tuple[tuple[bool, bool], int, list[str], list[str]] = ((False, False), -1, [""] * width, [])
    units: list[str] = []
    for at, (_, text) in enumerate(lines[:begin]):
        are_units = bool(units)
        units = _units_below(rows, at) if at + 1 < len(rows) and "number" not in shapes[at] + shapes[at + 1] else []
        names = form.names(text, width)
        if len(names) == width + 1 and names[-1].lower() in ("", "comment"):
            names.pop()
        has_units = any(head_of(name).unit for name in names) or bool(units)
        fits = abs(len(names) - width) <= has_units and (has_units or "number" not in shapes[at])
        if fits and not are_units and not text.startswith("***"):  # with which LabVIEW ends a head
            best = max(best, ((has_units, text[0] not in MARKS), at, names, units))
    return best[1:]


def _units_below(rows: list[list[str]], at: int) -> list[str]:
    """Return the units in the line below a line of names; an empty list if there are none."""
    units = [cell.strip(' ()[]"') for cell in rows[at + 1]]
    known, others = sum(map(is_unit, units)), sum(unit not in NONE and not is_unit(unit) for unit in units)
    bare = not any(head_of(cell).unit for cell in rows[at])
    fits = abs(len(units) - len(rows[at])) <= 1 and (not others or (bare and others <= known))
    return units if known and fits else []
