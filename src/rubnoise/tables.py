"""Short texts and HTML tables that show objects in a notebook."""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from html import escape
from itertools import accumulate
from textwrap import wrap
from typing import Any, Final

LONGEST: Final = 1500  # characters of a text at most: what one screen holds
WIDEST: Final = 140
FEW: Final = 8


def shortened(lines: Iterable[str], longest: int = LONGEST) -> str:
    """Return lines as one text of at most ``longest`` characters; its last line counts the lines left out."""
    whole = [line if len(line) <= WIDEST else f"{line[: WIDEST - 3]}..." for line in lines]
    ends = list(accumulate(len(line) + 1 for line in whole))
    if not ends or ends[-1] <= longest + 1:
        return "\n".join(whole)
    kept = bisect_right(ends, longest - len(f"\n  ... and {len(whole):,} more lines"))
    return "\n".join([*whole[:kept], f"  ... and {len(whole) - kept:,} more lines"])


def fields_as_text(value: Any) -> str:
    """Return a dataclass as a short text: its name, and a line for each field that its repr shows."""
    rows = [(each.name, in_short(getattr(value, each.name))) for each in fields(value) if each.repr]
    width = max(len(name) for name, _ in rows)
    return shortened([type(value).__name__, *(f"  {name:<{width}}  {text}" for name, text in rows)])


def in_short(value: Any) -> str:
    """Return a value as a short text: numbers with six digits; of many values only the first and the last."""
    if getattr(value, "ndim", 0):
        ends = f": {value.flat[0]:.6g} ... {value.flat[-1]:.6g}" if value.size and value.dtype.kind in "fiu" else ""
        return f"{value.size:,} values{ends}"
    if is_dataclass(value) and not isinstance(value, type):
        inside = (f"{each.name}={in_short(getattr(value, each.name))}" for each in fields(value) if each.repr)
        return f"{type(value).__name__}({', '.join(inside)})"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{name!r}: {in_short(each)}' for name, each in value.items())}}}"
    if isinstance(value, tuple | list):
        shown = len(value) <= FEW and not any(map(is_dataclass, value))
        return f"[{', '.join(map(in_short, value))}]" if shown else f"{len(value):,} of {type(value[0]).__name__}"
    plain = value.item() if hasattr(value, "item") else value
    return f"{plain:.6g}" if isinstance(plain, float) else repr(plain)


def as_html(heading: str, names: Sequence[str], rows: Iterable[Sequence[object]], note: str = "") -> str:
    """Return a heading and a table, as notebooks show them; everything is escaped."""
    head = "".join(f'<th style="text-align:left">{escape(name)}</th>' for name in names)
    body = "".join(
        "<tr>" + "".join(f'<td style="text-align:left">{escape(str(cell))}</td>' for cell in row) + "</tr>"
        for row in rows
    )
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<div><b>{escape(heading)}</b></div>{table}" + (f"<div>{escape(note)}</div>" if note else "")


def as_text(
    names: Sequence[str], rows: Iterable[Sequence[object]], numeric: Iterable[int] = (), widest: int | None = None
) -> list[str]:
    """Return the lines of a table; the columns whose numbers are in ``numeric`` are aligned right.

    A column is as wide as its widest cell or the longest word of its name. Columns that do not fit into ``widest``
    follow below, beside the first column again.
    """
    cells = [[str(cell) for cell in row] for row in rows]
    widths = [max(map(len, [*name.split(), *(row[n] for row in cells)])) for n, name in enumerate(names)]
    above = [wrap(name, width, break_on_hyphens=False) for name, width in zip(names, widths, strict=True)]
    right, lines = set(numeric), list[str]()
    for place, group in enumerate(_groups(widths, widest)):
        lines += [""] if place else []
        tall = max(len(above[n]) for n in group)
        heads = [[""] * (tall - len(words)) + words for words in above]
        for row in [*([head[line] for head in heads] for line in range(tall)), *cells]:
            aligned = (f"{row[n]:>{widths[n]}}" if n in right else f"{row[n]:<{widths[n]}}" for n in group)
            lines.append("  ".join(aligned).rstrip())
    return lines


def _groups(widths: Sequence[int], widest: int | None) -> list[list[int]]:
    """Return the numbers of columns in groups that fit, each beginning with the first column."""
    groups = [[0]]
    for number in range(1, len(widths)):
        taken = sum(widths[each] + 2 for each in groups[-1]) + widths[number]
        if widest is not None and taken > widest and len(groups[-1]) > 1:
            groups.append([0])
        groups[-1].append(number)
    return groups
