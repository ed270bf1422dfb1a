"""The reader of text tables, for `infer`, for Trace and for pictures; it reads a file in pieces."""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Final, NoReturn

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.storage.samples import EvenSteps, Lines, Measured, along_of, check_values, chosen_column
from rubnoise.storage.text_heads import LONGEST_NAME, NONE, Head, check_unit, head_of, is_unit, spelled
from rubnoise.storage.text_lines import Line, lines_of

_PLACES: Final = {"time": "s", "t": "s", "distance": "um", "position": "um"}
_DIGITS: Final = re.compile(r"\s*[+-]?[0-9]*\.?([0-9]*)(?:[eE]([+-]?[0-9]{1,3}))?\s*")
_BEGUN: Final = 4 * 1024**2  # characters that are looked at for a layout
_SEEN: Final = 50  # rows at either end of a piece whose digits are counted


class TextTable:
    """A text table: the names and units of its columns, and its rows, which are read once and in pieces."""

    def __init__(self, path: Path) -> None:
        """Read the names and the form; raises Refused if there is no table."""
        self.path = path
        self._pieces = lines_of(path)
        self._begun: list[Line] = []
        while len(self._begun) < LOOKED_AT and sum(len(text) for _, text in self._begun) < _BEGUN:
            if not (more := next(self._pieces, [])):
                break
            self._begun += more
        if not self._begun:
            raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
        self.layout: TextLayout = layout_of(path, self._begun)
        longest = max(len(head.written) for head in self.heads)
        if longest > LONGEST_NAME:
            raise Refused(f"{self.where}: a name of {longest:,} characters; up to {LONGEST_NAME} are read")

    @property
    def heads(self) -> tuple[Head, ...]:
        """The names and units of the columns."""
        return self.layout.heads

    @property
    def where(self) -> str:
        """The file, and the line of the names."""
        return f"{self.path}: line {self.layout.head_line}" if self.layout.head_line else f"{self.path}"

    def pieces(self) -> Iterator["Piece"]:
        """Yield the rows; raises Refused, with line and column, for a row not of numbers, and for a single row."""
        count = 0
        for lines in chain([self._begun], self._pieces):
            self._begun = []
            rows = [line for line in lines if line[0] >= self.layout.first]
            if rows:
                count += len(rows)
                yield Piece(self, rows)
        if count < 2:
            raise Refused(f"{self.where}: {count} rows below the names; a row for each sample is needed, two or more")


class Piece:
    """Some rows of a table: ``numbers`` are those of their lines, ``values`` has a row for each."""

    def __init__(self, table: TextTable, rows: Sequence[Line]) -> None:
        """Read the rows."""
        self._layout, self._rows = table.layout, rows
        self.numbers = [number for number, _ in rows]
        self.values = _parsed_rows(table, rows)
        self._path = table.path

    def column(self, number: int) -> Doubles:
        """Return the values of a column; raises Refused, with the line, for a value that is not a finite number."""
        values = np.ascontiguousarray(self.values[:, number])
        what = f"{self._path}: {self._layout.heads[number].name}"
        check_values(values, what, lambda row: f"line {self.numbers[row]}")
        return values

    def resolution(self, column: int) -> float:
        """Return the last decimal with which a column is written, from rows at both ends of the piece."""
        seen = [*self._rows[:_SEEN], *self._rows[-_SEEN:]]
        texts = [self._layout.cells(text)[column].replace(",", ".") for _, text in seen]
        digits = [found for text in texts if (found := _DIGITS.fullmatch(text))]
        powers = [10.0 ** (int(each[2] or 0) - len(each[1])) for each in digits]
        # Numbers with exponents keep their digits as they grow; of others the zeros at the end may be missing.
        return (max if any(each[2] for each in digits) else min)(powers, default=0.0)


def _parsed_rows(table: TextTable, rows: Sequence[Line]) -> Doubles:
    layout = table.layout
    texts = [text for _, text in rows]
    if texts[0].count(layout.separator) == len(layout.heads):  # one more behind the last cell
        texts = [layout.separator.join(layout.cells(text)) for text in texts]
    if layout.comma:
        texts = [text.replace(",", ".") for text in texts]
    try:
        found: Doubles = np.loadtxt(texts, delimiter=layout.separator, ndmin=2, comments=None)
    except ValueError:
        found = np.empty((0, 0))
    if found.shape == (len(rows), len(layout.heads)):
        return found
    for line in rows:
        layout.check_row(table.path, line)
    return np.array([[layout.number(cell) for cell in layout.cells(text)] for _, text in rows], dtype=np.float64)


def read_text(path: Path, wanted: str | None, rate: float | None = None) -> Measured:
    """Return a column of a text table; memory holds only the column itself.

    With a ``rate`` in Hz a column of times has to agree with it, to the digits that are written.
    """
    table = TextTable(path)
    heads = table.heads
    if not table.layout.head_line and wanted is None and len(heads) > 1:
        raise Refused(
            f'{path}: line {table.layout.first}: has no line of names above its numbers; column=2, rate="10 kHz" and'
            ' unit="N" say what is in it'
        )
    place = next((n for n, head in enumerate(heads) if along_of(head.name, head.unit)), None)
    if wanted is None and place is None and rate is None:
        _check_place_units(heads, table.where)
    chosen = chosen_column(path, [head.name for head in heads], wanted, place)
    along = "time" if place is None else along_of(heads[place].name, heads[place].unit)
    even = (
        None if place is None or place == chosen else EvenSteps(heads[place].name, heads[place].unit, str(path), rate)
    )
    kept: list[Doubles] = []
    lines = Lines()
    for piece in table.pieces():
        if even is not None and place is not None:
            even.add(piece.values[:, place], piece.numbers, piece.resolution(place))
        kept.append(piece.column(chosen))
        lines.add(piece.numbers)
    return Measured(
        name=heads[chosen].name,
        values=np.concatenate(kept),
        unit=heads[chosen].unit,
        step=None if even is None else even.step(),
        along=along,
        where=table.where,
        lines=lines,
    )


def _check_place_units(heads: Sequence[Head], where: str) -> None:
    """Raise Refused for a column of times or distances without a unit, or with an unknown one."""
    for head in heads:
        if head.name.lower() in _PLACES:
            check_unit(head.unit, f"{where}: {head.written}")
        if not head.unit and (found := _PLACES.get(head.name.lower())):
            raise Refused(f'{where}: {head.name} has no unit; write "{head.name} ({found})", or whichever unit it has')


LOOKED_AT: Final = 1000
"""Lines within which a table has to begin."""

_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
_SEPARATORS: Final = ("\t", ";", ",")
_SHOWN: Final = 40
_QUOTED: Final = 100_000  # characters of names that are read as CSV quotes them


@dataclass(frozen=True, slots=True, kw_only=True)
class TextLayout:
    """The form of a table: the separator of its cells, whether decimals follow a comma, and its columns.

    ``first`` is the line where its rows begin; ``head_line`` is the line of the names, 0 if there are none and
    columns are named by their number.
    """

    separator: str
    comma: bool
    heads: tuple[Head, ...]
    head_line: int
    first: int

    def cells(self, text: str) -> list[str]:
        """Return the cells of a row, without an empty one at its end."""
        found = text.split(self.separator)
        spare = len(found) > 1 and (not self.heads or len(found) == len(self.heads) + 1)
        return found[:-1] if spare and not found[-1].strip() else found

    def number(self, cell: str) -> float | None:
        """Return the number in a cell; None if it is not a number."""
        text = cell.strip().replace(",", ".") if self.comma else cell.strip()
        return float(text) if _NUMBER.fullmatch(text) and not (self.comma and text[-1] == ".") else None

    def check_row(self, path: Path, line: Line) -> None:
        """Raise Refused, with line and column, if a row is not of numbers."""
        cells = self.cells(line[1])
        for head, cell in zip(self.heads, cells, strict=False):
            if self.number(cell) is None:
                shown = repr(cell.strip()[:_SHOWN])
                quoted = "; numbers stand without quotes" if cell.strip()[:1] in "\"'" and cell.strip() else ""
                raise Refused(f"{path}: line {line[0]}: {head.name}: {shown} is no number{quoted}")
        if len(cells) != len(self.heads):
            what = "names" if self.head_line else "cells in other rows"
            raise Refused(f"{path}: line {line[0]}: {len(cells)} cells; there are {len(self.heads)} {what}")


def layout_of(path: Path, begun: Sequence[Line]) -> TextLayout:
    """Return the form of a table from its first lines; raises Refused if they have no rows of numbers."""
    lines = begun[:LOOKED_AT]
    ways = [
        TextLayout(separator=mark, comma=comma, heads=(), head_line=0, first=0)
        for comma in (False, True)
        for mark in _SEPARATORS
        if not (comma and mark == ",")
    ]
    tried = [each for way in ways if (each := _tried(way, lines))]
    if not tried:
        _refuse_without_rows(path, lines)
    found = max(tried, key=lambda each: each.worth)
    return found.layout


@dataclass(frozen=True, slots=True)
class _Tried:
    """A trial of one separator. ``worth``: whether names and cells agree in number, rows of numbers, cells of a row."""

    layout: TextLayout
    worth: tuple[bool, int, int]


def _tried(way: TextLayout, lines: Sequence[Line]) -> _Tried | None:
    cells = [way.cells(text) for _, text in lines]
    numbers = [sum(way.number(cell) is not None for cell in row) for row in cells]
    widths = Counter(len(row) for row, count in zip(cells, numbers, strict=True) if count == len(row))
    if not widths:
        return None
    width = max(widths, key=lambda each: (widths[each], each))
    row_at = [count == len(row) == width for row, count in zip(cells, numbers, strict=True)]
    # A line of a preamble may be a number: rows must follow one another.
    begin = next((at for at in range(len(lines)) if row_at[at] and all(row_at[at : at + 2])), row_at.index(True))
    named = [at for at in range(len(lines)) if numbers[at] < len(cells[at]) and _has_unit(cells, at, numbers)]
    if width == 1:
        begin = next((at + 1 for at in named if begin < at < _FEW and any(row_at[at + 1 :])), begin)
    above = [at for at in named if at < begin] or [at for at in range(begin) if not numbers[at]]
    if not above:
        unnamed = tuple(Head(f"column {n}", "", "") for n in range(1, width + 1))
        return _Tried(replace(way, heads=unnamed, first=lines[0][0]), (False, widths[width], width))
    at = above[-1]
    heads, below = _heads(cells, at, lines, way.separator), at + 1
    if _is_unit_row(cells, at + 1, numbers):
        units = [each.strip(" ()[]") for each in cells[at + 1]]
        heads = [
            replace(head, unit=head.unit or spelled(unit))
            for head, unit in zip(heads, [*units, *[""] * len(heads)], strict=False)
        ]
        below += 1
    heads = _of_labview(heads, cells[:at])
    if len(heads) == width + 1 and (heads[-1].name.lower() == "comment" or not heads[-1].written):
        heads = heads[:-1]
    layout = replace(way, heads=tuple(heads), head_line=lines[at][0], first=lines[below][0])
    alone = width == 1 and any(mark in lines[at][1].strip() for mark in _SEPARATORS)
    return _Tried(layout, (len(heads) == width and not alone, widths[width], width))


_FEW: Final = 20
"""Lines of a preamble among which those of one number may be."""


def _has_unit(cells: list[list[str]], at: int, numbers: list[int]) -> bool:
    """Whether a line names columns with their units, in its cells or in the line below."""
    if any(head_of(cell).unit for cell in _unquoted(cells[at])):
        return True
    return not numbers[at] and _is_unit_row(cells, at + 1, numbers)


def _is_unit_row(cells: list[list[str]], at: int, numbers: list[int]) -> bool:
    if not 0 < at < len(cells) or numbers[at] or abs(len(cells[at]) - len(cells[at - 1])) > 1:
        return False
    units = [cell.strip(' ()[]"') for cell in cells[at]]
    return any(map(is_unit, units)) and all(is_unit(unit) or unit in NONE for unit in units)


def _heads(cells: list[list[str]], at: int, lines: Sequence[Line], separator: str) -> list[Head]:
    names = _unquoted(cells[at])
    if len(lines[at][1]) < _QUOTED and '"' in lines[at][1]:  # a name in quotes may hold what parts the others
        names = next(csv.reader([lines[at][1]], delimiter=separator))
    return [head_of(name) if name.strip() else Head(f"column {n}", "", "") for n, name in enumerate(names, 1)]


def _unquoted(cells: list[str]) -> list[str]:
    """Return names without the quotes that many programs put around texts."""
    return [cell.strip().strip('"').strip() for cell in cells]


def _of_labview(heads: list[Head], above: list[list[str]]) -> list[Head]:
    """Return heads with the units from the preamble of LabVIEW: X_Dimension and Y_Unit_Label."""
    said = {row[0]: row[1:] for row in above if len(row) > 1}
    if heads[0].name != "X_Value" or "X_Dimension" not in said:
        return heads
    units = ["s" if said["X_Dimension"][0] == "Time" else "", *said.get("Y_Unit_Label", [])]
    return [
        replace(head, unit=head.unit or unit.strip())
        for head, unit in zip(heads, [*units, *[""] * len(heads)], strict=False)
    ]


def _refuse_without_rows(path: Path, lines: Sequence[Line]) -> NoReturn:
    first = lines[0][1].strip()
    raise Refused(
        f"{path}: line {lines[0][0]}: {first[:_SHOWN]!r}: no row of numbers in {len(lines)} lines; a line of names"
        ' such as "time (s),force (mN)" and a row for each sample are needed, parted by comma, semicolon or tab'
    )
