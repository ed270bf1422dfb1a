"""The blocks of code of docs/reading.md, by heading and language."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "reading.md"
SECTION = re.compile(r"^## (.+?)\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| `(\w+)` \| (\S+) \| (\S+) \|$", re.MULTILINE)


def blocks() -> dict[str, tuple[str, str]]:
    """Return language and code of every block; a section's second block has " 2" behind its name, and so on."""
    return {
        f"{title} {number}" if number > 1 else title: (language, code)
        for title, text in SECTION.findall(PAGE.read_text(encoding="utf-8"))
        for number, (language, code) in enumerate(BLOCK.findall(text), start=1)
    }


def printed_row() -> dict[str, tuple[str, float]]:
    """Return unit and value of every column of the junction that the page takes out."""
    return {name: (unit, float(value)) for name, unit, value in ROW.findall(PAGE.read_text(encoding="utf-8"))}
