"""Check what readers of an index rely on, before they get it: an index from another person may hold anything."""

import json
import re
from math import prod
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.storage.index import POINTS, RUNS, IndexFile

GROUPS: Final = (POINTS, RUNS)
TEXTS: Final = ("run_id", "file", "state", "reason")
NUMBERS: Final = ("point", "replicate", "seed")
REMEDY: Final = "the same `rubnoise sweep` writes it again"

_KEY: Final = re.compile(r"[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*")
_KINDS: Final = {"S": "texts", "i": "whole numbers", "f": "numbers"}


def check_index(index: IndexFile) -> None:
    """Raise RunFileRefused, with the reason, for an index that this program cannot have written."""
    try:
        _check(index)
    except RunFileRefused as refusal:
        raise RunFileRefused(f"{index.path}: damaged: {refusal}; {REMEDY}") from refusal


def _check(index: IndexFile) -> None:
    grid, side_by_side = (_keys(index, name) for name in ("grid", "side_by_side"))
    keys = [*grid, *side_by_side]
    _require(len(set(keys)) == len(keys), "grid and side_by_side name a key twice")
    kinds = {group: {about.name: _kind(index, group, about.name) for about in index.columns(group)} for group in GROUPS}
    _check_kinds(RUNS, kinds[RUNS], dict.fromkeys(TEXTS, "S") | dict.fromkeys(NUMBERS, "i"))
    _check_kinds(POINTS, kinds[POINTS], {"values": "S"})
    for group in GROUPS:
        missing = next((key for key in keys if key not in kinds[group]), None)
        _require(missing is None, f"/{group} has no column {missing}")
    for name, kind in kinds[RUNS].items():
        _require(kind == "f" or name in {"run", *TEXTS, *NUMBERS, *keys}, f"/{RUNS}/{name} holds no figures")
    for row, text in enumerate(index.read(POINTS, "values").tolist()):
        _require(_is_point(_json(text), keys), f"/{POINTS}/values row {row} is no point of the swept keys")
    resolved = _json(index.attributes["scenario_resolved"])
    tables = isinstance(resolved, dict) and all(
        isinstance(resolved.get(name), dict) for name in ("interface", "sliding")
    )
    _require(tables, "scenario_resolved is no scenario")
    _check_places(index, grid, side_by_side)


def _require(right: bool, otherwise: str) -> None:  # noqa: FBT001
    if not right:
        raise RunFileRefused(otherwise)


def _json(text: str) -> Any:
    """Return the value of a JSON text; None if it is not valid JSON."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _keys(index: IndexFile, name: str) -> list[str]:
    keys = _json(index.attributes[name])
    right = isinstance(keys, list) and all(isinstance(key, str) and _KEY.fullmatch(key) for key in keys)
    _require(right, f"{name} is no list of keys")
    return list(keys)


def _kind(index: IndexFile, group: str, name: str) -> str:
    values = index.raw(group, name, 0, 0)
    _require(values.ndim == 1, f"/{group}/{name} has {values.ndim} dimensions")
    return values.dtype.kind


def _check_kinds(group: str, there: dict[str, str], wanted: dict[str, str]) -> None:
    for name, kind in wanted.items():
        _require(name in there, f"/{group} has no column {name}")
        _require(there[name] == kind, f"/{group}/{name} holds no {_KINDS[kind]}")


def _is_point(values: Any, keys: list[str]) -> bool:
    """Whether values can be those of a point: a plain value for each key."""
    return (
        isinstance(values, dict)
        and values.keys() == set(keys)
        and all(isinstance(value, str | int | float) for value in values.values())
    )


def _check_places(index: IndexFile, grid: list[str], side_by_side: list[str]) -> None:
    """Refuse numbers of points and replicates that do not exist, since arrays get their size from these numbers."""
    point, replicate = (index.read(RUNS, name) for name in ("point", "replicate"))
    points = index.rows(POINTS)
    _check_range("point", point, np.full(point.size, points))
    _check_range("replicate", replicate, np.bincount(point, minlength=points)[point])
    rows = list(zip(*(index.read(POINTS, key).tolist() for key in side_by_side), strict=True))
    axes = [len(np.unique(index.read(POINTS, key))) for key in grid] + [len(set(rows))] * bool(rows)
    _require(prod(axes) <= points, f"the values of its keys make {prod(axes):,} points, and it has {points:,}")


def _check_range(name: str, numbers: NDArray[Any], ends: NDArray[Any]) -> None:
    wrong = np.flatnonzero((numbers < 0) | (numbers >= ends))
    if wrong.size:
        row = int(wrong[0])
        raise RunFileRefused(f"/{RUNS}/{name} row {row} is {numbers[row]}, and there are {ends[row]}")
