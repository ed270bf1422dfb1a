"""Measured traces in tables of text: a line of names with units, then a row for each sample, read in pieces."""

import csv
import re
from collections.abc import Iterator
from io import TextIOWrapper
from itertools import chain
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream
from rubnoise.storage.samples import EvenSteps, Lines, Measured, along_of, chosen_column

_PIECE_BYTES: Final = 4 * 1024**2  # of text
_PLACES: Final = {"time": "s", "t": "s", "distance": "um", "position": "um"}
ENDINGS: Final = {"_um_per_s": "um/s", "_um2": "um^2", "_um": "um", "_uN": "uN", "_MPa": "MPa", "_s": "s"}
_HEADER: Final = re.compile(r"(?P<name>[^()\[\]]+?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\[\]]*)\])")


def read_text(path: Path, wanted: str | None) -> Measured:
    """Return a column of a table of text, which is read in pieces: only the column itself is kept."""
    rows = _rows(path)
    begun = next(rows, [])
    if not begun:
        raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
    head_line, head = begun.pop(0)
    separator = next((mark for mark in ("\t", ";", ",") if mark in head), ",")
    heads = [_named(cell) for cell in next(csv.reader([head], delimiter=separator))]
    if all(_is_number(name) for name, _ in heads):
        raise Refused(
            f'{path}: line {head_line}: numbers; a first line of names is needed: "time (s){separator}force (mN)"'
        )
    place = next((n for n, (name, unit) in enumerate(heads) if along_of(name, unit)), None)
    if wanted is None and place is None:
        _check_place_units(heads, f"{path}: line {head_line}")
    chosen = chosen_column(path, [name for name, _ in heads], wanted, place)
    kept: list[Doubles] = []
    lines = Lines()
    even: EvenSteps | None = None
    for piece in chain([begun], rows):
        if not piece:
            continue
        table = _numbers(path, piece, separator, len(heads))
        numbers = [number for number, _ in piece]
        if not np.isfinite(table[:, chosen]).all():
            row = int(np.argmin(np.isfinite(table[:, chosen])))
            raise Refused(
                f"{path}: line {numbers[row]}: {heads[chosen][0]} is {table[row, chosen]}; every sample needs a number"
            )
        if place is not None:
            if even is None:
                even = EvenSteps(heads[place], path, _resolution(piece[:100], separator, place))
            even.add(table[:, place], numbers)
        kept.append(table[:, chosen].copy())
        lines.add(numbers)
    if lines.count < 2:
        raise Refused(f"{path}: has {lines.count + 1} lines; a line of names and a row for each sample are needed")
    return Measured(
        name=heads[chosen][0],
        values=np.concatenate(kept),
        unit=heads[chosen][1],
        step=None if even is None else even.step(),
        along="time" if place is None else along_of(*heads[place]),
        where=f"{path}: line {head_line}",
        lines=lines,
    )


def _rows(path: Path) -> Iterator[list[tuple[int, str]]]:
    """Yield the lines of a text with their numbers, a piece at a time, without comments and empty lines."""
    number = 0
    with open_stream(path) as stream, TextIOWrapper(stream, encoding="utf-8-sig") as text:
        try:
            while piece := text.readlines(_PIECE_BYTES):
                kept = [(at, line) for at, line in enumerate(piece, number + 1) if line.strip() and line[0] != "#"]
                number += len(piece)
                if kept:
                    yield kept
        except UnicodeDecodeError as problem:
            raise Refused(f"{path}: is no text in UTF-8, beyond line {number}") from problem


def _check_place_units(heads: list[tuple[str, str]], where: str) -> None:
    """Raise Refused for a column that is called a time or a distance and has no unit."""
    for name, unit in heads:
        if not unit and (found := _PLACES.get(name.lower())):
            raise Refused(f'{where}: {name} has no unit; write "{name} ({found})", or whichever unit it has')


def _numbers(path: Path, rows: list[tuple[int, str]], separator: str, count: int) -> Doubles:
    """Return the table; raises Refused with the first line that is not one of ``count`` numbers."""
    try:
        table: Doubles = np.loadtxt([line for _, line in rows], delimiter=separator, ndmin=2, comments=None)
    except ValueError:
        table = np.empty((0, 0))
    if table.shape[1] == count:
        return table
    for number, line in rows:
        cells = next(csv.reader([line], delimiter=separator))
        if len(cells) != count:
            raise Refused(f"{path}: line {number}: {len(cells)} cells; there are {count} names")
        for cell in cells:
            if not _is_number(cell):
                raise Refused(f"{path}: line {number}: {cell.strip()!r} is no number")
    raise Refused(f"{path}: is no table of numbers")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _named(cell: str) -> tuple[str, str]:
    """Return the name and the unit of a header: `NAME (UNIT)`, `NAME [UNIT]` or our own `NAME_UNIT`."""
    text = cell.strip()
    if match := _HEADER.fullmatch(text):
        return match["name"].strip(), (match["round"] or match["square"] or "").strip()
    ending = next((end for end in ENDINGS if text.endswith(end)), "")
    return (text.removesuffix(ending), ENDINGS[ending]) if ending else (text, "")


def _resolution(rows: list[tuple[int, str]], separator: str, place: int) -> float:
    """Return the last decimal with which places are written."""
    cells = [next(csv.reader([line], delimiter=separator))[place].strip() for _, line in rows]
    return min(10.0 ** -len(cell.partition("e")[0].partition(".")[2]) for cell in cells)
