"""Scans in files of text: a list of points with their places, which is put on a grid, or a matrix of heights."""

import re
from collections import Counter
from itertools import dropwhile
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import Refused
from rubnoise.storage.measured import head_of, is_unit, spelled
from rubnoise.storage.text_table import ENCODINGS, begin_of

MOST_VALUES: Final = 1 << 26  # points of a map that is read
_NEAR: Final = 0.1  # of a step: how far a point may lie off the grid
_MISSED: Final = re.compile(r"(?<!\w)(?:nan|bad|inf(?:inite)?)(?!\w)", re.IGNORECASE)
_ROW: Final = re.compile(r"(?=.*(?:\d|nan))[\s\d.,;+-]*(?:(?:[eEdD](?=[+-]?\d)|nan)[\s\d.,;+-]*)*")


def text_of(path: Path) -> tuple[str | None, tuple[str, ...]]:
    """Return a text in UTF-8, UTF-16 or Windows-1252, with a note on the last two; None for other files."""
    encoding, lines = begin_of(path)
    text = "\n".join(line for _, line in lines)
    return (None, ()) if "\0" in text else (text, ENCODINGS[encoding])


def table_of(text: str, name: str) -> tuple[str, Doubles, str]:
    """Return the lines above a table, its numbers by row, and all lines with spaces between numbers, or Refused."""
    lines = _MISSED.sub("nan", text.replace("\u2212", "-")).splitlines()
    numbers = [at for at, line in enumerate(lines) if _ROW.fullmatch(line)]
    if not numbers:
        raise Refused(f"{name}: has no rows of numbers")
    seen = "\n".join(lines[at] for at in numbers[:100])
    spaced = re.search(r"\d[ \t]+[+-]?\d", seen) is not None and re.search(r",\s", seen) is None
    decimal = ";" in seen or (spaced and "." not in seen)  # what a comma is; else it parts numbers
    marks = str.maketrans({";": " ", ",": "." if decimal else " ", "D": "e", "d": "e"})
    for at in numbers:
        lines[at] = lines[at].translate(marks)
    lengths = {at: len(lines[at].split()) for at in numbers}
    usual = Counter(lengths.values()).most_common(1)[0][0]
    # What stands above the table, such as a date, is no row of it.
    rows = list(dropwhile(lambda at: lengths[at] != usual, numbers))
    if uneven := [f"line {at + 1}: has {lengths[at]} numbers" for at in rows if lengths[at] != usual]:
        raise Refused(f"{name}: {uneven[0]}, other rows {usual}; write nan for a point that was missed")
    try:
        values = np.loadtxt((lines[at] for at in rows), ndmin=2)
    except ValueError as problem:
        cell = str(problem).split("'")[1]
        line = next(at for at in rows if cell in lines[at].split()) + 1
        raise Refused(f"{name}: line {line}: {cell} is no number; right form: 1.5") from None
    head = [f"# {line}" if at in lengths else line for at, line in enumerate(lines[: rows[0]])]
    return "\n".join(head), values, "\n".join([*head, *lines[rows[0] :]])


def points_of(head: str, values: Doubles) -> tuple[Doubles, str, str] | None:
    """Return x, y, z in columns with the units of places and heights; None without three columns or such names."""
    width = values.shape[1]
    lines = [line.strip("#% \t").replace('"', "") for line in reversed(head.splitlines())]
    cells = [each for line in lines for each in (re.split(r"[;,\t]|\s{2,}", line), line.split()) if len(each) == width]
    if len(cells) > 1 and all(is_unit(spelled(unit.strip("[] "))) for unit in cells[0]):
        cells[0] = [f"{name} [{unit.strip('[] ')}]" for name, unit in zip(cells[1], cells[0], strict=True)]
    heads = [head_of(cell) for cell in cells[0]] if cells else []
    names = [each.name.lower() for each in heads]
    named = {"x", "y", "z"} <= set(names)
    if not (width == 3 or named):
        return None
    columns = [names.index(each) for each in "xyz"] if named else [0, 1, 2]
    said = dict(re.findall(r"(Lateral|Value) units?\s*[:=]\s*(\S+)", head))
    along, _, up = (heads[column].unit for column in columns) if heads else ("", "", "")
    return values[:, columns], along or said.get("Lateral", ""), up or said.get("Value", "")


def gridded(points: Doubles, name: str) -> tuple[Doubles, tuple[float, float]]:
    """Return heights on the even grid of their places, nan where there is no point, and its spacings."""
    (along, step), (across, other) = (_on_axis(points[:, axis], name, "xy"[axis]) for axis in (0, 1))
    shape = int(along.max()) + 1, int(across.max()) + 1
    if shape[0] * shape[1] > MOST_VALUES:
        raise Refused(f"{name}: its points need a grid of {shape[0]:,} x {shape[1]:,}; up to {MOST_VALUES:,} are read")
    taken, heights = np.zeros(shape, dtype=bool), np.full(shape, np.nan)
    taken[along, across], heights[along, across] = True, points[:, 2]
    if taken.sum() < len(points):
        raise Refused(f"{name}: has two points at one place; leave out one of them")
    return heights, (step, other)


def _on_axis(values: Doubles, name: str, axis: str) -> tuple[Integers, float]:
    """Return the numbers of even steps at which values lie, a tenth of a step beside at most, and the step."""
    ordered = np.sort(values)
    gaps, span = np.diff(ordered), float(ordered[-1] - ordered[0])
    if not (0.0 < span < np.inf):
        raise Refused(f"{name}: {axis} is not a place of each point; a list needs x, y and z, that of a map")
    apart = ordered[np.append(True, gaps > _NEAR * gaps.max())]
    step = span / round(span / float(np.median(np.diff(apart))))
    places = (values - ordered[0]) / step
    off = np.abs(places - np.rint(places))
    if (worst := int(off.argmax())) and off[worst] > _NEAR:
        raise Refused(f"{name}: {axis} = {values[worst]:g} lies on no even grid, whose step would be {step:.4g}")
    return np.rint(places).astype(np.int64), step
