"""The map of the package: its layers as the contract has them, and the arrows that its imports really draw."""

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

import grimp

CONTRACT: Final = Path(__file__).resolve().parent.parent / "pyproject.toml"
"""The layers are those that import-linter keeps, so a picture of others would fail its test."""


def _contract() -> dict[str, Any]:
    contracts = tomllib.loads(CONTRACT.read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    return dict(contracts[0])


def layers() -> list[list[str]]:
    """Return the rooms of each layer, the highest first: packages, and files beside them."""
    return [[room.strip(" ()") for room in layer.split("|")] for layer in _contract()["layers"]]


@cache
def arrows() -> dict[str, set[str]]:
    """Return for each room the rooms that any of its files imports, wherever in the file."""
    graph = grimp.build_graph("rubnoise", cache_dir=None)
    for importer, room in exceptions():
        for imported in graph.find_modules_directly_imported_by(importer) if importer in graph.modules else ():
            if imported.startswith(f"rubnoise.{room}."):
                graph.remove_import(importer=importer, imported=imported)
    rooms = {f"rubnoise.{room}": room for layer in layers() for room in layer}
    for module in rooms:
        graph.squash_module(module)
    return {
        room: {rooms[each] for each in graph.find_modules_directly_imported_by(module) if each in rooms} - {room}
        for module, room in rooms.items()
    }


def exceptions() -> set[tuple[str, str]]:
    """Return the modules that the contract lets import a room above them, each with that room."""
    ends = (each.split(" -> ") for each in _contract()["ignore_imports"])
    return {(importer, imported.split(".")[1]) for importer, imported in ends}


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
