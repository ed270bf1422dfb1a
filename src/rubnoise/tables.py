"""Short texts and HTML tables, with which objects show themselves in a notebook."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import Final

LONGEST: Final = 1500
"""Characters of a text at most: what one screen holds."""

WIDEST: Final = 140


def shortened(lines: Iterable[str], longest: int = LONGEST) -> str:
    """Return lines as one text of at most so many characters; the rest is counted in its last line."""
    whole = [line if len(line) <= WIDEST else f"{line[: WIDEST - 3]}..." for line in lines]
    if sum(len(line) + 1 for line in whole) <= longest + 1:
        return "\n".join(whole)
    kept: list[str] = []
    room = longest - len(f"\n  ... and {len(whole):,} more lines")
    for line in whole:
        room -= len(line) + 1
        if room < 0:
            break
        kept.append(line)
    return "\n".join([*kept, f"  ... and {len(whole) - len(kept):,} more lines"])


def as_html(heading: str, names: Sequence[str], rows: Iterable[Sequence[object]], note: str = "") -> str:
    """Return a heading and a table, as notebooks show them; everything is escaped."""
    head = "".join(f'<th style="text-align:left">{escape(name)}</th>' for name in names)
    body = "".join(
        "<tr>" + "".join(f'<td style="text-align:left">{escape(str(cell))}</td>' for cell in row) + "</tr>"
        for row in rows
    )
    below = f"<div>{escape(note)}</div>" if note else ""
    return (
        f"<div><b>{escape(heading)}</b></div><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{below}"
    )


def as_text(names: Sequence[str], rows: Iterable[Sequence[object]], numeric: Iterable[int] = ()) -> list[str]:
    """Return lines of a table in columns; those whose numbers are in ``numeric`` are flush right."""
    cells = [list(names), *([str(cell) for cell in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    right = set(numeric)
    return [
        "  ".join(
            f"{cell:>{width}}" if n in right else f"{cell:<{width}}" for n, (cell, width) in enumerate(each)
        ).rstrip()
        for each in (list(zip(row, widths, strict=True)) for row in cells)
    ]
