"""Parts of pages that tools write, between `<!-- KIND: NAME -->` and `<!-- end -->`, and tables of Markdown."""

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

_PART = re.compile(r"(<!-- \w+: ([\w -]+) -->\n)(.*?)(?=<!-- end -->)", re.DOTALL)


def parts_of(page: str) -> dict[str, str]:
    """Return the texts of all parts of a page by name."""
    return {name: text for _, name, text in _PART.findall(page)}


def filled(page: str, parts: Mapping[str, str]) -> str:
    """Return a page with some of its parts replaced; raises ValueError for a part that the page has not."""
    if missing := sorted(parts.keys() - parts_of(page).keys()):
        raise ValueError(f"the page has no part called {', '.join(missing)}")
    return _PART.sub(lambda found: found[1] + parts.get(found[2], found[3]), page)


def fill(path: Path, parts: Mapping[str, str]) -> None:
    """Write some of the parts of a page into its file; raises ValueError for a part that the page has not."""
    path.write_text(filled(path.read_text(encoding="utf-8"), parts), encoding="utf-8")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of Markdown."""
    first, *others = ["".join(map(_cell, cells)) + "|\n" for cells in (head, *rows)]
    return first + "|---" * len(head) + "|\n" + "".join(others)


def _cell(text: str) -> str:
    shown = text.replace("|", "\\|")
    return f"| {shown} " if shown else "| "
