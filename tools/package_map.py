"""The map of the package: its layers as the contract has them, and the arrows that its imports really draw."""

import ast
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
PACKAGE: Final = ROOT / "src" / "rubnoise"
CONTRACT: Final = ROOT / "pyproject.toml"
"""The layers are those that import-linter keeps, so a picture of others would fail its test."""


def layers() -> list[list[str]]:
    """Return the rooms of each layer, the highest first: packages, and files beside them."""
    contract = tomllib.loads(CONTRACT.read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"][0]
    return [[room.strip(" ()") for room in layer.split("|")] for layer in contract["layers"]]


def arrows(package: Path = PACKAGE) -> dict[str, set[str]]:
    """Return for each room the rooms that any of its files imports, wherever in the file."""
    rooms, left_out = [room for layer in layers() for room in layer], exceptions()
    return {
        room: {
            name
            for file in files(room, package)
            for name in _imported(file)
            if name in rooms and (file.relative_to(package).with_suffix("").as_posix(), name) not in left_out
        }
        - {room}
        for room in rooms
    }


def exceptions() -> set[tuple[str, str]]:
    """Return the files that the contract lets import a room above them, each with that room."""
    contract = tomllib.loads(CONTRACT.read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"][0]
    ends = (each.split(" -> ") for each in contract["ignore_imports"])
    return {(file.removeprefix("rubnoise.").replace(".", "/"), room.split(".")[1]) for file, room in ends}


def files(room: str, package: Path = PACKAGE) -> list[Path]:
    """Return the files of a room."""
    folder = package / room
    return sorted(folder.rglob("*.py")) if folder.is_dir() else [package / f"{room}.py"]


def _imported(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom) or node.module is None:
            continue
        if node.module == "rubnoise":
            yield from (alias.name for alias in node.names)
        elif node.module.startswith("rubnoise."):
            yield node.module.split(".")[1]


def shown_arrows(drawn: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """Return the arrows that no longer way replaces: a -> c goes where a -> b and b -> c are there."""
    return {
        room: {end for end in ends if not any(end in _below(drawn, other) for other in ends - {end})}
        for room, ends in drawn.items()
    }


def _below(drawn: Mapping[str, set[str]], room: str) -> set[str]:
    """Return all rooms that a room's arrows lead to, directly or not."""
    return drawn[room] | {end for other in drawn[room] for end in _below(drawn, other)}


def line() -> Iterator[str]:
    """Yield the layers in one line, as the contract orders them."""
    yield "    " + " > ".join(", ".join(layer) for layer in layers())


def diagram() -> Iterator[str]:
    """Yield the arrows between rooms in the language of Mermaid, which GitHub draws."""
    shown = shown_arrows(arrows())
    yield "```mermaid"
    yield "flowchart TD"
    for layer in layers():
        for room in layer:
            if shown[room]:
                yield f"    {room} --> {' & '.join(_in_order(shown[room]))}"
    yield "```"


def _in_order(rooms: set[str]) -> list[str]:
    return [room for layer in layers() for room in layer if room in rooms]
