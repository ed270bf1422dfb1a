"""Where a table of text stands in its file: its rows, the names and units above them, its times."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from rubnoise.storage.text_form import MARKS, Form, moment
from rubnoise.storage.text_heads import NONE, Head, head_of, is_unit, spelled

_HEAD_ENDS: Final = "***"
"""What LabVIEW ends a head with, which is no name."""

_FEW: Final = 20
"""Lines of a preamble among which those of one number may be."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TableLayout:
    """A table as one form sees it; ``worth`` is how well: names that agree, the share of numbers, rows, cells.

    ``first`` is the line where rows begin, ``head_line`` that of the names, 0 if there are none; ``usable`` are the
    columns of numbers or times, ``clocks`` those of dates and clock times, counted from ``first_day``; ``step`` in s is
    what LabVIEW says where no column has the times.
    """

    form: Form
    heads: list[Head]
    head_line: int
    first: int
    usable: list[int]
    clocks: frozenset[int]
    first_day: int
    step: float | None
    worth: tuple[bool, float, int, int]


def layout(form: Form, lines: Sequence[tuple[int, str]]) -> TableLayout | None:
    """Return the table that the first lines of a text have in one form, None if none has a number in it."""
    rows = [form.cells(text) if text[0] not in MARKS else [] for _, text in lines]
    kinds = [[_kind(form, cell) for cell in row] for row in rows]
    seen = [at for at, each in enumerate(kinds) if any(each)]
    if not seen:
        return None
    widths = Counter(len(rows[at]) for at in seen)
    width = max(widths, key=lambda each: (widths[each], each))
    table = [at for at in seen if len(rows[at]) == width]
    counts = [Counter(kinds[at][n] for at in table) for n in range(width)]
    share = [max(each["number"], each["time"]) / len(table) for each in counts]
    begin = _begin(rows, kinds, table, [n for n in range(width) if share[n] >= 0.9 * max(share)])
    at, names, units = _names_above(form, [text for _, text in lines[:begin]], rows, kinds, width)
    heads = [head_of(name) if name else Head(f"column {n}", "", "") for n, name in enumerate(names, 1)]
    below, step = bool(units), None
    if not below and heads[0].name == "X_Value":
        units, step = _of_labview(rows[:at], form)
    padded = [*units, *[""] * len(heads)]
    heads = [replace(head, unit=head.unit or spelled(unit)) for head, unit in zip(heads, padded, strict=False)]
    if len(heads) == width - 1 and share[-1] == 0.0:
        heads.append(Head(f"column {width}", "", ""))
    clocks = frozenset(n for n, each in enumerate(counts) if each["time"] > each["number"])
    heads = [replace(head, unit="s") if n in clocks else head for n, head in enumerate(heads)]
    while at < 0 and begin > 0 and len(rows[begin - 1]) == width and "number" in kinds[begin - 1]:
        begin -= 1  # a damaged row is no preamble
    days = [found for n in clocks for each in table if (found := moment(rows[each][n])) is not None]
    alone = width == 1 and at >= 0 and any(mark in lines[at][1].strip() for mark in "\t;,")
    filled = sum(bool(cell) for each in table for cell in rows[each])
    read = sum(each["number"] + each["time"] for each in counts)
    usable = [n for n in range(min(width, len(heads))) if share[n] >= 0.5]
    return TableLayout(
        form=form,
        heads=heads,
        head_line=0 if at < 0 else lines[at][0],
        first=lines[begin if at < 0 else at + 1 + below][0],
        usable=usable,
        clocks=clocks,
        first_day=int(min(days, default=0.0) // 86400.0),
        step=None if 0 in usable else step,
        worth=(at >= 0 and len(heads) == width and not alone, read / filled, len(table), width),
    )


def _kind(form: Form, cell: str) -> str:
    """Return "number" or "time" for a cell that is one; an empty text for others."""
    if form.number(cell) is not None:
        return "number"
    return "time" if moment(cell) is not None else ""


def _begin(rows: Sequence[list[str]], kinds: Sequence[list[str]], table: Sequence[int], core: Sequence[int]) -> int:
    """Return the first of two rows of a table in which each column of the ``core`` has a number or a time."""
    whole = [at for at in table if all(kinds[at][n] for n in core)]
    begin = next((at for at in whole if at + 1 in whole), whole[0] if whole else table[0])
    if len(rows[begin]) == 1:  # numbers of a preamble may stand above the name
        few = range(begin + 1, min(_FEW, len(rows) - 1))
        begin = next((at + 1 for at in few if any(head_of(cell).unit for cell in rows[at])), begin)
    return begin


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
    form: Form, texts: Sequence[str], rows: Sequence[list[str]], kinds: Sequence[list[str]], width: int
) -> tuple[int, list[str], list[str]]:
    """Return the nearest line of names above a table, the names, and the units below them; -1 if there is none.

    Best is one with units and a name for each column, then such a comment, then one without units, then any with units.
    """
    best: tuple[int, int, list[str], list[str]] = (0, -1, [""] * width, [])
    above: list[str] = []
    for at, text in enumerate(texts):
        are_units = bool(above)
        is_bare = at + 1 < len(rows) and "number" not in kinds[at] + kinds[at + 1]
        above = _units_below(rows, at) if is_bare else []
        if are_units or text.startswith(_HEAD_ENDS):
            continue
        names, is_comment = form.names(text, width), text[0] in MARKS
        if len(names) == width + 1 and names[-1].lower() in ("", "comment"):
            names.pop()
        has_units = any(head_of(name).unit for name in names) or bool(above)
        if abs(len(names) - width) <= 1 and has_units:
            rank = 4 if is_comment else 5
        elif len(names) == width and "number" not in kinds[at]:
            rank = 1 if is_comment else 3
        else:
            rank = 2 if has_units and not is_comment else 0
        if rank and rank >= best[0]:
            best = rank, at, names, above
    return best[1:]


def _of_labview(above: Sequence[list[str]], form: Form) -> tuple[list[str], float | None]:
    """Return the units that LabVIEW's preamble names, and its step in s."""
    said = {row[0]: row[1:] for row in above if len(row) > 1}
    is_time = said.get("X_Dimension", [""])[0] == "Time"
    units = ["s" if is_time else "", *said.get("Y_Unit_Label", [])]
    return units, form.number(said.get("Delta_X", [""])[0]) if is_time else None
