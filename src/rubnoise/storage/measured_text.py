"""Tables of text: the one reader of them, for `infer`, for Trace and for pictures; it goes through a file in pieces."""

import re
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.storage.samples import EvenSteps, Lines, Measured, along_of, check_values, chosen_column
from rubnoise.storage.text_heads import LONGEST_NAME, Head, check_unit
from rubnoise.storage.text_layout import LOOKED_AT, Layout, layout_of
from rubnoise.storage.text_lines import Line, lines_of

_PLACES: Final = {"time": "s", "t": "s", "distance": "um", "position": "um"}
_DIGITS: Final = re.compile(r"\s*[+-]?[0-9]*\.?([0-9]*)(?:[eE]([+-]?[0-9]{1,3}))?\s*")
_BEGUN: Final = 4 * 1024**2  # characters that are looked at for a layout
_SEEN: Final = 50  # rows at either end of a piece whose digits are counted


class Table:
    """A table of text: the names and units of its columns, and its rows, which are read once and in pieces."""

    def __init__(self, path: Path) -> None:
        """Read names and layout; raises Refused where there is no table."""
        self.path = path
        self._pieces = lines_of(path)
        self._begun: list[Line] = []
        while len(self._begun) < LOOKED_AT and sum(len(text) for _, text in self._begun) < _BEGUN:
            if not (more := next(self._pieces, [])):
                break
            self._begun += more
        if not self._begun:
            raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
        self.layout: Layout = layout_of(path, self._begun)
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
        """Yield the rows; raises Refused, with line and column, for a row that is none, and for fewer than two."""
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

    def __init__(self, table: Table, rows: Sequence[Line]) -> None:
        """Read the rows."""
        self._layout, self._rows = table.layout, rows
        self.numbers = [number for number, _ in rows]
        self.values = _read(table, rows)
        self._path = table.path

    def column(self, number: int) -> Doubles:
        """Return the values of a column; raises Refused, with the line, for one that is no finite number."""
        values = np.ascontiguousarray(self.values[:, number])
        what = f"{self._path}: {self._layout.heads[number].name}"
        check_values(values, what, lambda row: f"line {self.numbers[row]}")
        return values

    def resolution(self, column: int) -> float:
        """Return the last decimal with which a column is written, by rows at both ends of the piece."""
        seen = [*self._rows[:_SEEN], *self._rows[-_SEEN:]]
        texts = [self._layout.cells(text)[column].replace(",", ".") for _, text in seen]
        digits = [found for text in texts if (found := _DIGITS.fullmatch(text))]
        powers = [10.0 ** (int(each[2] or 0) - len(each[1])) for each in digits]
        # Numbers with exponents keep their digits as they grow; of others the zeros at the end may be missing.
        return (max if any(each[2] for each in digits) else min)(powers, default=0.0)


def _read(table: Table, rows: Sequence[Line]) -> Doubles:
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
    """Return a column of a table of text; only the column itself is kept.

    With a ``rate`` in Hz a column of times has to agree with it, to the digits that are written.
    """
    table = Table(path)
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
    """Raise Refused for a column that is called a time or a distance and has no unit, or an unknown one."""
    for head in heads:
        if head.name.lower() in _PLACES:
            check_unit(head.unit, f"{where}: {head.written}")
        if not head.unit and (found := _PLACES.get(head.name.lower())):
            raise Refused(f'{where}: {head.name} has no unit; write "{head.name} ({found})", or whichever unit it has')
