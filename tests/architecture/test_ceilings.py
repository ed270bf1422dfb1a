"""The project only shrinks: lines, statements and words of each room stay below the ceilings of ceilings.toml.

`python -m tests.architecture.test_ceilings` lowers each ceiling to what is there now; it raises none. Who raises one by
hand says in CHANGELOG.md what a user gets for it. `final` is where each room is to end.
"""

import ast
import tomllib
from functools import cache
from pathlib import Path

import pytest

from tests.architecture.sources import PACKAGE, ROOT

CEILINGS = Path(__file__).with_name("ceilings.toml")
SLACK = 1.05
"""A ceiling that stands higher above its room than this was not lowered by the change that shrank the room."""


def statements(text: str) -> int:
    """Return the number of statements of a source text, without docstrings."""
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.stmt)]
    return sum(not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)) for node in nodes)


def lines(*files: Path) -> int:
    """Return the number of lines of some files."""
    return sum(file.read_bytes().count(b"\n") for file in files)


def room_of(file: Path) -> str:
    """Return the package of a source file below rubnoise, or "root"."""
    parts = file.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else "root"


@cache
def measured() -> dict[str, dict[str, int]]:
    """Return what each room holds now."""
    rooms: dict[str, list[Path]] = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        rooms.setdefault(room_of(file), []).append(file)
    source = sorted(PACKAGE.rglob("*.py"))
    script = [file for file in PACKAGE.rglob("*.js") if "uplot" not in file.name.lower()]
    pages = list((ROOT / "docs").rglob("*.md"))
    return {
        "lines": {name: lines(*files) for name, files in rooms.items()}
        | {
            "src": lines(*source),
            "javascript": lines(*script),
            "tests": lines(*(ROOT / "tests").rglob("*.py")),
            "tools": lines(*(ROOT / "tools").rglob("*.py")),
        },
        "statements": {
            name: sum(statements(file.read_text(encoding="utf-8")) for file in files) for name, files in rooms.items()
        }
        | {"src": sum(statements(file.read_text(encoding="utf-8")) for file in source)},
        "words": {"docs": sum(len(page.read_text(encoding="utf-8").split()) for page in pages)},
    }


def ceilings() -> dict[str, dict[str, int]]:
    """Return the ceilings that stand."""
    return tomllib.loads(CEILINGS.read_text(encoding="utf-8"))


def over(found: dict[str, dict[str, int]], allowed: dict[str, dict[str, int]]) -> dict[str, tuple[int, int]]:
    """Return each room that is larger than its ceiling, or has none, with what it holds and what it may hold."""
    return {
        f"{unit} of {room}": (count, allowed[unit].get(room, 0))
        for unit, counts in found.items()
        for room, count in counts.items()
        if count > allowed[unit].get(room, 0)
    }


def test_no_room_is_larger_than_its_ceiling() -> None:
    assert over(measured(), ceilings()) == {}


def test_each_ceiling_is_as_low_as_its_room() -> None:
    found, allowed = measured(), ceilings()
    high = {
        f"{unit} of {room}": (found[unit].get(room, 0), limit)
        for unit in found
        for room, limit in allowed[unit].items()
        if limit > SLACK * found[unit].get(room, 0) + 20
    }
    assert high == {}, "python -m tests.architecture.test_ceilings lowers them"


@pytest.mark.parametrize("unit", ["lines", "statements", "words"])
def test_growth_would_be_noticed(unit: str) -> None:
    found, allowed = measured(), ceilings()
    room, limit = next(iter(allowed[unit].items()))
    found[unit][room] = limit + 1
    assert f"{unit} of {room}" in over(found, allowed)


def test_a_statement_is_counted_and_a_docstring_is_not() -> None:
    assert statements('"""Text."""\nx = 1\nif x:\n    x = 2\n') == 3


def lower() -> None:
    """Write the ceilings again, each no higher than its room, and drop those of rooms that are gone."""
    found, allowed = measured(), ceilings()
    head = CEILINGS.read_text(encoding="utf-8").partition("[lines]")[0]
    parts = []
    for unit, counts in found.items():
        rows = [f"{room} = {min(count, allowed[unit].get(room, count))}" for room, count in counts.items()]
        parts.append(f"[{unit}]\n" + "\n".join(rows) + "\n")
    final = "\n".join(f"{room} = {count}" for room, count in allowed["final"].items())
    CEILINGS.write_text(head + "\n".join(parts) + f"\n[final]\n{final}\n", encoding="utf-8")


if __name__ == "__main__":
    lower()
