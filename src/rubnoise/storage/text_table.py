"""Tables of text as testers write them: found by the shape of their rows, with names and units above, read in pieces.

Numbers are demanded of the columns that are used, and of no other.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import date
from io import TextIOWrapper
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream
from rubnoise.storage.text_heads import LONGEST_NAME, NONE, Head, head_of, is_unit, spelled

LOOKED_AT: Final = 1000
"""Lines within which a table has to begin."""

LONGEST_LINE: Final = 1 << 20
_PIECE: Final = 1 << 22
_SHOWN: Final = 40
_FEW: Final = 20
"""Lines of a preamble among which those of one number may be."""

_MARKS: Final = ("#", "%")
_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
_THOUSANDS: Final = {
    True: re.compile(r"[+-]?[1-9][0-9]{0,2}(?:\.[0-9]{3})+(?:,[0-9]+)?"),
    False: re.compile(r"[+-]?[1-9][0-9]{0,2}(?:,[0-9]{3})+\.[0-9]+"),
}
_GAP: Final = re.compile("(?<=[0-9])[ '\u2019\u00a0\u2009\u202f](?=[0-9]{3}(?![0-9]))")
_EXPONENT: Final = re.compile("(?<=[0-9.])[dD](?=[+-]?[0-9])")
_MOMENT: Final = re.compile(
    r"(?:([0-9]{4})[-/.]([0-9]{1,2})[-/.]([0-9]{1,2})[T ]|([0-9]{1,2})[-/.]([0-9]{1,2})[-/.]([0-9]{4}) )? *"
    r"([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}(?:[.,][0-9]+)?))? *([aApP][mM])?(?:Z| ?[+-][0-9]{2}:?[0-9]{2})?"
)
_NAMES_BY_SPACES: Final = re.compile(r"[^\s(\[]+(?: ?[(\[][^)\]]*[)\]])?")

Line = tuple[int, str]
"""The number of a line, from 1 on, and its text."""


@dataclass(frozen=True, slots=True)
class Form:
    """How a table is written: the separator of its cells (a space: any number), and whether decimals follow a comma."""

    separator: str
    comma: bool

    def cells(self, text: str) -> list[str]:
        """Return the cells of a row; quotes around a cell are no part of it."""
        if self.separator == " ":
            return text.split()
        if '"' in text and len(text) < 100_000:
            return next(csv.reader([text], delimiter=self.separator, skipinitialspace=True))
        return [cell.strip() for cell in text.split(self.separator)]

    def names(self, text: str, width: int) -> list[str]:
        """Return the cells of a line of names, whose spaces part words as well as columns."""
        text = text.lstrip("".join(_MARKS)).strip(" \r")
        if self.separator != " ":
            return [cell.strip().strip('"').strip() for cell in self.cells(text)]
        ways = (re.split(r"\s{2,}|\t", text), _NAMES_BY_SPACES.findall(text[: _FEW * LONGEST_NAME]))
        return next((way for way in ways if len(way) == width), text.split())

    def number(self, cell: str) -> float | None:
        """Return the number in a cell; None if it is not a number."""
        text = cell.strip().replace("\u2212", "-")
        if not self.comma and _NUMBER.fullmatch(text):
            return float(text)
        if len(text) > 2 * _SHOWN:
            return None
        text = _EXPONENT.sub("e", _GAP.sub("", text))
        decimal, other = (",", ".") if self.comma else (".", ",")
        if other in text:
            text = text.replace(other, "") if _THOUSANDS[self.comma].fullmatch(text) else ""
        text = text.replace(decimal, ".")
        return float(text) if _NUMBER.fullmatch(text) and not (self.comma and text[-1] == ".") else None


def moment(cell: str, first_day: int = 0) -> float | None:
    """Return the seconds since the begin of a day (counted as Python does) of a date with time, or of a clock."""
    found = _MOMENT.fullmatch(cell.strip()) if ":" in cell and len(cell) < _SHOWN else None
    if found is None:
        return None
    year, month, day, day_first, month_next, year_last, hours, minutes, seconds, half = found.groups()
    days = 0
    if year or year_last:
        try:
            days = date(int(year or year_last), int(month or month_next), int(day or day_first)).toordinal() - first_day
        except ValueError:
            return None
    hour = int(hours) if half is None else int(hours) % 12 + 12 * (half in "pmPM")
    return 86400.0 * days + 3600.0 * hour + 60.0 * int(minutes) + float((seconds or "0").replace(",", "."))


def encoding_of(path: Path) -> tuple[str, tuple[str, ...]]:
    """Return the encoding of a text, and what is said of it if it is not UTF-8."""
    with open_stream(path) as stream:
        begin = stream.read(2)
        if begin in (b"\xff\xfe", b"\xfe\xff"):
            return "utf-16", (f"{path}: is read as UTF-16",)
        stream.seek(0)
        reader = TextIOWrapper(stream, encoding="utf-8-sig")
        try:
            while reader.read(_PIECE):
                pass
        except UnicodeDecodeError:
            return "cp1252", (f"{path}: is not in UTF-8, and is read as Windows-1252",)
    return "utf-8-sig", ()


def lines_of(path: Path, encoding: str) -> Iterator[list[Line]]:
    """Yield the lines of a text, a piece at a time, which end in LF, CR LF or CR.

    Raises Refused, with the line, if the file is not a text.
    """
    rest, number, text = "", 0, "begun"
    with open_stream(path) as stream, TextIOWrapper(stream, encoding=encoding, errors="replace") as reader:
        while text:
            text = reader.read(_PIECE)
            if "\0" in text:
                line = number + 1 + (rest + text).split("\0")[0].count("\n")
                raise Refused(f"{path}: line {line}: holds a zero byte, so it is no text; save it as CSV in UTF-8")
            lines = (rest + text).split("\n")
            rest = lines.pop() if text else ""
            if len(rest) > LONGEST_LINE or max(map(len, lines), default=0) > LONGEST_LINE:
                at = next(at for at, each in enumerate([*lines, rest], number + 1) if len(each) > LONGEST_LINE)
                raise Refused(
                    f"{path}: line {at}: has more than {LONGEST_LINE:,} characters; a table has a row for each sample"
                )
            yield list(enumerate(lines, number + 1))
            number += len(lines)


def _rows(lines: Sequence[Line], first: int = 0) -> list[Line]:
    """Return the lines from one on that are neither empty nor comments."""
    return [line for line in lines if line[0] >= first and line[1] and line[1][0] not in _MARKS and line[1].strip()]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Layout:
    """A table as one form sees it; ``worth`` is how well: names that agree, the share of numbers, rows, cells.

    ``first`` is the line where rows begin, ``head_line`` that of the names, 0 if there are none; ``clocks`` are the
    columns of dates and clock times, counted from ``first_day``, ``step`` that of LabVIEW.
    """

    form: Form
    heads: list[Head]
    head_line: int
    first: int
    usable: list[bool]
    clocks: frozenset[int]
    first_day: int
    step: float | None
    worth: tuple[bool, float, int, int]


def _layout(form: Form, lines: Sequence[Line]) -> _Layout | None:
    rows = [form.cells(text) if text[0] not in _MARKS else [] for _, text in lines]
    kinds = [[form.number(cell) is not None for cell in row] for row in rows]
    times = [[":" in cell and moment(cell) is not None for cell in row] for row in rows]
    seen = [at for at in range(len(rows)) if any(kinds[at]) or any(times[at])]
    if not seen:
        return None
    widths = Counter(len(rows[at]) for at in seen)
    width = max(widths, key=lambda each: (widths[each], each))
    table = [at for at in seen if len(rows[at]) == width]
    count = [[sum(each[at][n] for at in table) for n in range(width)] for each in (kinds, times)]
    share = [max(both) / len(table) for both in zip(*count, strict=True)]
    core = [n for n in range(width) if share[n] >= 0.9 * max(share)]
    whole = [at for at in table if all(kinds[at][n] or times[at][n] for n in core)]
    begin = next((at for at in whole if at + 1 in whole), whole[0] if whole else table[0])
    units = {
        at: _units_below(rows, at) for at in range(min(begin + 1, len(rows) - 1)) if not any(kinds[at] + kinds[at + 1])
    }
    if width == 1:  # numbers of a preamble may stand above the name
        named = (at for at in range(begin + 1, min(_FEW, len(rows))) if any(head_of(cell).unit for cell in rows[at]))
        begin = next((at + 1 for at in named if at + 1 < len(rows)), begin)
    at, names = _names_above(form, lines, rows[:begin], kinds, units, width)
    heads = [head_of(name) if name else Head(f"column {n}", "", "") for n, name in enumerate(names, 1)]
    below = units.get(at, []) if at >= 0 else []
    heads = _with_units(heads, below)
    heads, step = _of_labview(heads, rows[: max(at, 0)], form)
    if len(heads) == width - 1 and share[-1] == 0.0:
        heads = [*heads, Head(f"column {width}", "", "")]
    clocks = frozenset(n for n in range(width) if count[1][n] > count[0][n])
    heads = [replace(head, unit="s") if n in clocks else head for n, head in enumerate(heads)]
    while at < 0 and begin > 0 and len(rows[begin - 1]) == width and any(kinds[begin - 1]):
        begin -= 1  # a damaged row is no preamble
    first = begin if at < 0 else at + 1 + bool(below)
    days = [found for n in clocks for each in table if (found := moment(rows[each][n])) is not None]
    alone = width == 1 and at >= 0 and any(mark in lines[at][1].strip() for mark in "\t;,")
    filled = sum(bool(cell) for each in table for cell in rows[each])
    return _Layout(
        form=form,
        heads=heads,
        head_line=0 if at < 0 else lines[at][0],
        first=lines[first][0],
        usable=[n < width and share[n] >= 0.5 for n in range(len(heads))],
        clocks=clocks,
        first_day=int(min(days, default=0.0) // 86400.0),
        step=step,
        worth=(at >= 0 and len(heads) == width and not alone, sum(map(sum, count)) / filled, len(table), width),
    )


def _units_below(rows: Sequence[list[str]], at: int) -> list[str]:
    """Return the units in the line below a line of names; an empty list if there are none."""
    units = [cell.strip(' ()[]"') for cell in rows[at + 1]]
    if abs(len(units) - len(rows[at])) > 1:
        return []
    known = sum(map(is_unit, units))
    others = sum(unit not in NONE and not is_unit(unit) for unit in units)
    bare = not any(head_of(cell).unit for cell in rows[at])
    return units if known and (not others or (bare and others <= known)) else []


def _names_above(
    form: Form,
    lines: Sequence[Line],
    rows: Sequence[list[str]],
    kinds: Sequence[list[bool]],
    units: dict[int, list[str]],
    width: int,
) -> tuple[int, list[str]]:
    """Return the nearest line of names above a table, and the names; -1 if there is none.

    Best is one with units and a name for each column, then such a comment, then one without units, then any with units.
    """
    best: tuple[int, int, list[str]] = (0, -1, [""] * width)
    for at in range(len(rows)):
        comment = lines[at][1][0] in _MARKS
        names = form.names(lines[at][1], width)
        if len(names) == width + 1 and names[-1].lower() in ("", "comment"):
            names.pop()
        has_units = any(head_of(name).unit for name in names) or bool(units.get(at))
        if units.get(at - 1):
            continue
        fits, bare = abs(len(names) - width) <= 1, not any(kinds[at])
        if fits and has_units:
            rank = 4 if comment else 5
        elif fits and len(names) == width and bare:
            rank = 1 if comment else 3
        else:
            rank = 2 if has_units and not comment else 0
        if rank and (rank, at) > best[:2]:
            best = rank, at, names
    return best[1:]


def _with_units(heads: list[Head], units: Sequence[str]) -> list[Head]:
    """Return heads with units from another line, where they have none of their own."""
    padded = [*units, *[""] * len(heads)]
    return [replace(head, unit=head.unit or spelled(unit)) for head, unit in zip(heads, padded, strict=False)]


def _of_labview(heads: list[Head], above: Sequence[list[str]], form: Form) -> tuple[list[Head], float | None]:
    """Return heads with the units of LabVIEW's preamble, and its step if no column has the times."""
    said = {row[0]: row[1:] for row in above if len(row) > 1}
    if not heads or heads[0].name != "X_Value" or "X_Dimension" not in said:
        return heads, None
    is_time = said["X_Dimension"][0] == "Time"
    units = ["s" if is_time else "", *said.get("Y_Unit_Label", [])]
    return _with_units(heads, units), form.number(said.get("Delta_X", [""])[0]) if is_time else None


class TextTable:
    """A table of text: names and units of its columns, and which of them hold numbers or times (``usable``)."""

    along, of_file = "time", True

    def __init__(self, path: Path) -> None:
        """Read the names and the form; raises Refused if there is no table."""
        self.path = path
        self._encoding, self.notes = encoding_of(path)
        pieces = lines_of(path, self._encoding)
        begun: list[Line] = []
        while len(begun) < LOOKED_AT and (piece := next(pieces, [])):
            begun += piece
        begun = [line for line in begun[: 10 * LOOKED_AT] if line[1].strip()][:LOOKED_AT]
        if not begun:
            raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
        forms = [Form(mark, comma) for comma in (False, True) for mark in "\t;, "]
        layouts = [found for form in forms if (found := _layout(form, begun))]
        if not layouts:
            first = next(iter(_rows(begun)), begun[0])
            raise Refused(
                f"{path}: line {first[0]}: {first[1].strip()[:_SHOWN]!r}: no row of numbers in {len(begun)} lines; a"
                ' line of names such as "time (s),force (mN)" and a row for each sample are needed, parted by comma,'
                " semicolon, tab or spaces"
            )
        self._layout = max(layouts, key=lambda each: each.worth)
        self.heads, self.usable, self.head_line = self._layout.heads, self._layout.usable, self._layout.head_line
        self.first = self._layout.first
        self.where = f"{path}: line {self.head_line}" if self.head_line else f"{path}"
        longest = max(len(head.written) for head in self.heads)
        if longest > LONGEST_NAME:
            raise Refused(f"{self.where}: a name of {longest:,} characters; up to {LONGEST_NAME} are read")

    @property
    def step(self) -> float | None:
        """The step in s that LabVIEW says, if no column has the times."""
        return None if self.usable[0] else self._layout.step

    def columns(self, numbers: Sequence[int], most: int | None = None) -> list[Doubles]:
        """Return columns, nan where no number stands; ``most`` ends the reading after so many rows."""
        kept: list[Doubles] = [np.empty((0, len(numbers)))]
        lines: list[Doubles] = []
        for piece in lines_of(self.path, self._encoding):
            if rows := _rows(piece, self.first):
                kept.append(self._parsed([text for _, text in rows], numbers))
                lines.append(np.array([at for at, _ in rows], dtype=np.int32))
            if most is not None and sum(map(len, kept)) > most:
                break
        self._lines = np.concatenate(lines) if lines else np.empty(0, dtype=np.int32)
        found = [np.concatenate([part[:, n] for part in kept]) for n in range(len(numbers))]
        return [
            _over_midnight(each) if number in self._layout.clocks else each
            for number, each in zip(numbers, found, strict=True)
        ]

    def _parsed(self, texts: list[str], numbers: Sequence[int]) -> Doubles:
        form, clocks = self._layout.form, self._layout.clocks
        whole = "\n".join(texts)
        plain = '"' not in whole and not (form.comma and "." in whole) and clocks.isdisjoint(numbers)
        if plain and form.separator != " ":
            plain = {text.count(form.separator) for text in texts} == {len(self.heads) - 1}
        if plain:
            changed = whole.replace(",", ".").split("\n") if form.comma else texts
            try:
                separator = None if form.separator == " " else form.separator
                return np.loadtxt(changed, delimiter=separator, usecols=numbers, ndmin=2, comments=None)
            except ValueError:
                pass
        return np.array([self._row(text, numbers) for text in texts], dtype=np.float64).reshape(-1, len(numbers))

    def _row(self, text: str, numbers: Sequence[int]) -> list[float]:
        cells = self._layout.form.cells(text)
        if not self._fits(cells):
            return [np.nan] * len(numbers)
        found = [self._value(cells[n], n) if n < len(cells) else None for n in numbers]
        return [np.nan if value is None else value for value in found]

    def _value(self, cell: str, number: int) -> float | None:
        if number in self._layout.clocks:
            return moment(cell, self._layout.first_day)
        return self._layout.form.number(cell)

    def _fits(self, cells: Sequence[str]) -> bool:
        """Whether a row has a cell for each name; behind the last number a cell may be missing, an empty one added."""
        last = max((n for n, usable in enumerate(self.usable) if usable), default=0)
        spare = len(cells) == len(self.heads) + 1 and not cells[-1]
        return last < len(cells) <= len(self.heads) or spare

    def place(self, row: int) -> str:
        """Return the line of a row."""
        return f"line {self._lines[row]}"

    def wrong(self, row: int, number: int) -> str:
        """Say why the cell of a row is no number."""
        wanted = int(self._lines[row])
        line = next(text for piece in lines_of(self.path, self._encoding) for at, text in piece if at == wanted)
        cells, name = self._layout.form.cells(line), self.heads[number].name
        if not self._fits(cells):
            what = "names" if self.head_line else "cells in other rows"
            return f"{len(cells)} cells; there are {len(self.heads)} {what}"
        cell = cells[number] if number < len(cells) else ""
        if self._value(cell, number) is None:
            return f"{name}: {cell.strip()[:_SHOWN]!r} is no number"
        return f"{name} is nan; every sample needs a number"


def _over_midnight(times: Doubles) -> Doubles:
    """Return clock times that go on after midnight."""
    back = np.concatenate([[False], np.diff(times) < -43200.0])
    found: Doubles = times + 86400.0 * np.cumsum(back)
    return found
