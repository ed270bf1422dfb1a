"""Tables of text as testers write them: found by the shape of their rows, with names and units above.

Numbers are demanded of the columns that are used, and of no other.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from io import TextIOWrapper
from itertools import islice
from math import isnan, nan
from pathlib import Path
from typing import Final, Self

import numpy as np

from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream
from rubnoise.storage.measured import Head, Source, head_of
from rubnoise.units import is_unit, spelled

ENCODINGS: Final = {"utf-8-sig": (), "utf-16": ("read as UTF-16",), "cp1252": ("read as Windows-1252",)}
"""What is said of a text by its encoding."""

_LONGEST_LINE: Final = 1 << 17  # as the module csv has it of a cell

Line = tuple[int, str]  # the number of a line, from 1 on, and its text


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


MARKS: Final = ("#", "%")
"""What a comment begins with, or a line of names."""

_LOOKED_AT: Final = 1000  # lines within which a table has to begin
_SHOWN: Final = 40  # characters of a cell in a message
_TYPED: Final = {".": str.maketrans("\u2212dD", "-ee"), ",": str.maketrans(",.\u2212dD", ".,-ee")}
"""The letters of a number in Python for those of a cell, by what its decimals follow."""

_GAPS: Final = " '\u2019\u00a0\u2009\u202f"
_GROUPED: Final = re.compile(
    rf"[+-]?(?:[0-9]{{1,3}}(?:[{_GAPS}][0-9]{{3}})+\.?|[1-9][0-9]{{0,2}}(?:,[0-9]{{3}})+\.(?=[0-9]))[0-9]*(?:e[+-]?[0-9]+)?"
)
_MOMENT: Final = re.compile(
    r"(?:[0-9]{1,4}([-/.])[0-9]{1,2}\1[0-9]{1,4}[T ] *)?([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}(?:[.,][0-9]+)?))?"
    r" *([aApP])?(?:[mM])?(?:Z| ?[+-][0-9]{2}:?[0-9]{2})?"
)


@dataclass(frozen=True, slots=True)
class Form:
    """How a table is written: the separator of its cells (a space: any number), and what decimals follow."""

    separator: str
    decimal: str

    def cells(self, text: str) -> list[str]:
        """Return the cells of a row; quotes around a cell are no part of it."""
        if self.separator == " ":
            return text.split()
        cells = next(csv.reader([text], delimiter=self.separator, skipinitialspace=True), [])
        return [cell.strip() for cell in cells]

    def names(self, text: str, width: int) -> list[str]:
        """Return the cells of a line of names, whose spaces part words as well as columns."""
        text = text.lstrip("".join(MARKS)).strip(" \r")
        if self.separator != " ":
            return self.cells(text)
        names = re.split(r"\s{2,}|\t", text)
        return names if len(names) == width else re.sub(r"\s+(?=[(\[])", "", text).split()

    def number(self, cell: str) -> float:
        """Return the number in a cell, nan if it is not a number."""
        text = cell.strip().translate(_TYPED[self.decimal])
        try:
            return float(text)
        except ValueError:
            return float(re.sub(f"[,{_GAPS}]", "", text)) if _GROUPED.fullmatch(text) else nan

    def kind(self, cell: str) -> str:
        """Return "number" or "time" for a cell that is one; an empty text for others."""
        return "time" if not isnan(moment(cell)) else "" if isnan(self.number(cell)) else "number"


def moment(cell: str) -> float:
    """Return the seconds since midnight of a date with time, or of a clock: steps between samples need no dates."""
    if (found := _MOMENT.fullmatch(cell.strip())) is None:
        return nan
    _, hours, minutes, seconds, half = found.groups()
    hour = int(hours) if half is None else int(hours) % 12 + 12 * (half in "pP")
    return 3600.0 * hour + 60.0 * int(minutes) + float((seconds or "0").replace(",", "."))


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTable(Source):
    """A table of text: its rows begin in line ``first``; ``kinds`` are those of the columns of numbers and of times.

    ``fit`` is how well its form fits: whether each column has a name, the share of numbers, the rows, the cells.
    """

    encoding: str
    form: Form
    first: int
    kinds: Mapping[int, str]
    fit: tuple[bool, float, int, int]

    def rows(self, begin: int = 0) -> Iterator[Line]:
        """Yield the lines that are rows, from one on: neither empty nor comments."""
        lines = lines_of(self.path, self.encoding)
        rows = (line for line in lines if line[0] >= self.first and line[1].strip() and line[1][0] not in MARKS)
        return islice(rows, begin, None)

    def read(self) -> Self:
        """Return the table with its columns of numbers and times; clocks go on after midnight."""
        mark = None if self.form.separator == " " else self.form.separator
        read = partial(np.loadtxt, delimiter=mark, usecols=list(self.kinds), quotechar='"', comments=None, ndmin=2)
        try:  # as numpy reads numbers, in a third of the time
            values = read(self._texts())
        except ValueError:
            each = {number: moment if kind == "time" else self.form.number for number, kind in self.kinds.items()}
            values = read(self._texts(), converters=each)
        arrays = dict(zip(self.kinds, values.T, strict=True))
        clocks = {n: np.unwrap(arrays[n], period=86400.0) for n, kind in self.kinds.items() if kind == "time"}
        return replace(self, arrays=arrays | clocks)

    def _texts(self) -> Iterator[str]:
        """Yield the rows, those that have other cells without a number."""
        blank = self.form.separator.join(["-"] * len(self.heads))
        return (text if self._has_cells(text) else blank for _, text in self.rows())

    def _has_cells(self, text: str) -> bool:
        """Whether a row has a cell for each name; behind the last number cells may be missing, empty ones added.

        The rows of LabVIEW begin with an empty cell if it says their step alone; heads of its segments do not.
        """
        unplaced = self.heads[0].name == "X_Value" and 0 not in self.kinds
        if not unplaced and text.count(self.form.separator) == len(self.heads) - 1 and '"' not in text:
            return True
        cells = self.form.cells(text)
        return max(self.kinds) < len(cells) and not any([*cells[len(self.heads) :], *cells[:unplaced]])

    def place(self, row: int) -> str:
        """Return the line of a row, which is looked for again."""
        return f"line {next(self.rows(self.begin + row))[0]}"

    def wrong(self, row: int, number: int) -> str:
        """Say why the cell of a row is no number."""
        _, text = next(self.rows(self.begin + row))
        cells = self.form.cells(text)
        if not self._has_cells(text):
            what = "names" if self.head_line else "cells in other rows"
            return f"{len(cells)} cells; there are {len(self.heads)} {what}"
        cell = cells[number] if number < len(cells) else ""
        if cell.lower().strip("+-") == "nan":
            return Source.wrong(self, row, number)
        return f"{self.heads[number].name}: {cell[:_SHOWN]!r} is no number"


def read_table(path: Path) -> TextTable:
    """Return the table in a text, of the form that fits best; raises Refused if there is none."""
    encoding, begin = begin_of(path, _LOOKED_AT)
    lines = [line for line in begin if line[1].strip()]
    if not lines:
        raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
    forms = [Form(mark, decimal) for decimal in ".," for mark in "\t;, "]
    tables = [found for form in forms if (found := _table(path, encoding, form, lines))]
    if not tables or any("\0" in text for _, text in lines):
        number, text = next((line for line in lines if line[1][0] not in MARKS), lines[0])
        raise Refused(
            f"{path}: line {number}: {text.strip()[:_SHOWN]!r}: no row of numbers in {len(lines)} lines; a CSV in UTF-8"
            ' with a line of names such as "time (s),force (mN)" and a row for each sample is needed'
        )
    return max(tables, key=lambda found: found.fit).read()


def _table(path: Path, encoding: str, form: Form, lines: Sequence[Line]) -> TextTable | None:
    """Return the table that the first lines of a text have in one form, None if none has a number in it."""
    rows = [form.cells(text) if text[0] not in MARKS else [] for _, text in lines]
    shapes = [tuple(map(form.kind, cells)) for cells in rows]
    usual = Counter(shape for shape in shapes if any(shape)).most_common(1)
    if not usual:
        return None
    (shape, count), width = usual[0], len(usual[0][0])
    begin = next(at for run in (4, 2, 1) for at in range(len(shapes)) if shapes[at : at + run] == run * [shape])
    at, heads = _heads_above(form, lines[:begin], rows, shapes, width)
    named, step = at >= 0 and len(heads) == width, 0.0
    said = {row[0]: row[1:] for row in rows[:begin] if row}
    if at >= 0 and heads[0].name == "X_Value" and said.get("X_Dimension", [""])[0] == "Time":
        step = form.number(said.get("Delta_X", ["0"])[0])
        heads = _with_units(heads, ["s", *said.get("Y_Unit_Label", [])])
    heads += [Head("", "", "")] * (width - len(heads))
    for n, head in enumerate(heads):
        unit = "s" if shape[n : n + 1] == ("time",) else head.unit
        heads[n] = replace(head, name=head.name or f"column {n + 1}", unit=unit)
    alone = width == 1 and at >= 0 and any(mark in lines[at][1].strip() for mark in "\t;,")
    share = sum(map(bool, shape)) / sum(map(bool, rows[begin]))
    first = next(n for n, each in enumerate(shapes) if len(each) == width and any(each)) if at < 0 else at + 1
    return TextTable(
        path=path,
        heads=heads,
        step=0.0 if shape[0] else step,
        notes=tuple(f"{path}: {each}" for each in ENCODINGS[encoding]),
        of_file=True,
        head_line=0 if at < 0 else lines[at][0],
        encoding=encoding,
        form=form,
        first=lines[first][0],
        kinds={number: kind for number, kind in enumerate(shape) if kind},
        fit=(named and not alone, share, count, width),
    )


def _heads_above(
    form: Form, above: Sequence[Line], rows: Sequence[list[str]], shapes: Sequence[tuple[str, ...]], width: int
) -> tuple[int, list[Head]]:
    """Return the last line of the heads above a table, and the heads; -1 if there are none.

    Best are names with units, in the same line or the next one, then those that are no comment, then the nearest.
    """
    best: tuple[tuple[bool, bool], int, list[Head]] = ((False, False), -1, [])
    for at, (_, text) in enumerate(above):
        heads = [head_of(name) for name in form.names(text, width)]
        if len(heads) == width + 1 and heads[-1].written.lower() in ("", "comment"):
            heads.pop()
        units = [] if "number" in shapes[at] + shapes[at + 1] else _units_below(heads, rows[at + 1])
        heads = _with_units(heads, units)
        has_units = any(head.unit for head in heads)
        fits = abs(len(heads) - width) <= has_units and (has_units or "number" not in shapes[at])
        if fits and best[1] < at and not text.startswith("***"):  # with which LabVIEW ends a head
            best = max(best, ((has_units, text[0] not in MARKS), at + bool(units), heads), key=lambda each: each[:2])
    return best[1:]


def _units_below(heads: Sequence[Head], below: Sequence[str]) -> list[str]:
    """Return the units in the line below a line of names; an empty list if there are none."""
    units = [spelled(cell.strip(' ()[]"')) for cell in below]
    known, others = sum(map(is_unit, units)), sum(bool(unit) and not is_unit(unit) for unit in units)
    fits = not others or (others <= known and not any(head.unit for head in heads))
    return units if known and fits and abs(len(units) - len(heads)) <= 1 else []


def _with_units(heads: Sequence[Head], units: Sequence[str]) -> list[Head]:
    """Return heads with units for those that have none."""
    several = zip(heads, [*units, *[""] * len(heads)], strict=False)
    return [replace(head, unit=head.unit or spelled(unit)) for head, unit in several]
