"""How a table of text is laid out: what parts its cells, which line has the names, and with which line its rows begin.

Above the names may stand whatever an instrument writes, and a row of units below them. Nothing else is left out: what
stands between names and numbers is a damaged row, and is refused as one.
"""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, NoReturn

from rubnoise.errors import Refused
from rubnoise.storage.text_heads import NONE, Head, head_of, is_unit, spelled
from rubnoise.storage.text_lines import Line

LOOKED_AT: Final = 1000
"""Lines within which a table has to begin."""

_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
_SEPARATORS: Final = ("\t", ";", ",")
_SHOWN: Final = 40
_QUOTED: Final = 100_000  # characters of names that are read as CSV quotes them


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """What parts the cells of a table, whether a comma stands before decimals, and its columns.

    ``first`` is the line where its rows begin; ``head_line`` is that of the names, 0 where there are none and columns
    are named by their number.
    """

    separator: str
    comma: bool
    heads: tuple[Head, ...]
    head_line: int
    first: int

    def cells(self, text: str) -> list[str]:
        """Return the cells of a row, without an empty one behind them."""
        found = text.split(self.separator)
        spare = len(found) > 1 and (not self.heads or len(found) == len(self.heads) + 1)
        return found[:-1] if spare and not found[-1].strip() else found

    def number(self, cell: str) -> float | None:
        """Return the number that a cell is, if it is one."""
        text = cell.strip().replace(",", ".") if self.comma else cell.strip()
        return float(text) if _NUMBER.fullmatch(text) and not (self.comma and text[-1] == ".") else None

    def check_row(self, path: Path, line: Line) -> None:
        """Raise Refused, with line and column, for what is no row of numbers."""
        cells = self.cells(line[1])
        for head, cell in zip(self.heads, cells, strict=False):
            if self.number(cell) is None:
                shown = repr(cell.strip()[:_SHOWN])
                quoted = "; numbers stand without quotes" if cell.strip()[:1] in "\"'" and cell.strip() else ""
                raise Refused(f"{path}: line {line[0]}: {head.name}: {shown} is no number{quoted}")
        if len(cells) != len(self.heads):
            what = "names" if self.head_line else "cells in other rows"
            raise Refused(f"{path}: line {line[0]}: {len(cells)} cells; there are {len(self.heads)} {what}")


def layout_of(path: Path, begun: Sequence[Line]) -> Layout:
    """Return how a table is laid out, by its first lines; raises Refused where no rows of numbers are found."""
    lines = begun[:LOOKED_AT]
    ways = [
        Layout(separator=mark, comma=comma, heads=(), head_line=0, first=0)
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
    """A way to part the cells: whether there are as many names as cells then, how many rows of numbers, how wide."""

    layout: Layout
    worth: tuple[bool, int, int]


def _tried(way: Layout, lines: Sequence[Line]) -> _Tried | None:
    cells = [way.cells(text) for _, text in lines]
    numbers = [sum(way.number(cell) is not None for cell in row) for row in cells]
    widths = Counter(len(row) for row, count in zip(cells, numbers, strict=True) if count == len(row))
    if not widths:
        return None
    width = max(widths, key=lambda each: (widths[each], each))
    row_at = [count == len(row) == width for row, count in zip(cells, numbers, strict=True)]
    # A preamble may have a number for a line: rows come one after another.
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
    """Return heads with the units that the preamble of LabVIEW gives: X_Dimension and Y_Unit_Label."""
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
