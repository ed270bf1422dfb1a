"""Diameters that stand in a file: read once, and kept with their hash, so that no result needs the file again."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from rubnoise.errors import NoColumn, Refused
from rubnoise.scenario.fields import Unfit
from rubnoise.scenario.layers import Layers
from rubnoise.scenario.lists import Sizes
from rubnoise.scenario.problems import Problem

ReadSizes = Callable[[str, str | None], Sequence[float]]
"""What returns the diameters (um) of a file and of a column in it; it raises Refused, NoColumn for the column."""

_TABLE = "diameter"
_STANDS_IN = (1.0,)  # for values that could not be read: what else is wrong with the scenario is still said


def hash_of(values: Sequence[float]) -> str:
    """Return the SHA-256 of diameters in um, as little-endian doubles in the order of the file."""
    return sha256(np.array(values, dtype="<f8").tobytes()).hexdigest()


def stored_sizes(*resolved: Mapping[str, Any]) -> ReadSizes:
    """Return what reads the values that resolved scenarios have kept, by file and column, in place of the files."""
    tables = [scenario[_TABLE] for scenario in resolved]
    kept = {(os.path.normpath(each["file"]), each.get("column")): each["values"] for each in tables if "file" in each}

    def read(path: str, column: str | None) -> Sequence[float]:
        if (values := kept.get((os.path.normpath(path), column))) is None:
            raise Refused(f"{path}: no values of it are kept")
        return [float(value) for value in values]

    return read


def with_values(given: Layers, read: ReadSizes | None) -> tuple[Layers, list[Problem]]:
    """Return layers with the values of a file of diameters and their hash, and what is wrong with these.

    Values that a result keeps beside their file are those of the hash, and the file is not read again.
    """
    table = given.data.get(_TABLE)
    if not isinstance(table, dict) or not {"file", "column", "hash"} & table.keys():
        return given, []
    if "file" not in table:
        key = "column" if "column" in table else "hash"
        return given, [_wrong(given, key, f"a {key} needs a file", 'file = "sizes.csv"')]
    if "values" in table:
        return given, _unlike(given, table)
    values, problems = _sizes_of_file(given, table, read)
    return _filled(given, values), problems


def _sizes_of_file(
    given: Layers, table: Mapping[str, Any], read: ReadSizes | None
) -> tuple[Sequence[float], list[Problem]]:
    """Return the values of a file, which lies relative to the scenario file that names it; or why there are none."""
    if not all(isinstance(table.get(key, ""), str) for key in ("file", "column", "hash")):
        return _STANDS_IN, []  # said where these keys are read
    try:
        folder = Path(given.source_of((_TABLE, "file")).name).parent
        values = (read or _refuse)(str(folder / table["file"]), table.get("column"))
    except Refused as refused:
        key = "column" if isinstance(refused, NoColumn) else "file"
        return _STANDS_IN, [_wrong(given, key, str(refused))]
    found = hash_of(values)
    if table.get("hash", found) == found:
        return values, []
    message = f'the file changed: "{table["file"]}" has {found}, not {table["hash"]}'
    hint = "bring the file back, or take the hash away to use the file as it is"
    return _STANDS_IN, [_wrong(given, "hash", message, hint)]


def _refuse(path: str, _column: str | None) -> Sequence[float]:
    raise Refused(f"{path}: is read by rubnoise.load, rubnoise.build and commands alone; here values are needed")


def _unlike(given: Layers, table: Mapping[str, Any]) -> list[Problem]:
    """Refuse values beside a file that are not those of the hash."""
    if "hash" not in table:
        return [_wrong(given, "values", "both values and file are given", "keep exactly one of the two")]
    try:
        found = hash_of(Sizes("diameters").read(table["values"]))
    except Unfit:
        return []  # said where the values are read
    if table["hash"] == found:
        return []
    hint = "take the values away to read the file, or the file to use the values"
    return [_wrong(given, "hash", f"the values beside it have {found}, not {table['hash']}", hint)]


def _filled(given: Layers, values: Sequence[float]) -> Layers:
    table = {"hash": hash_of(values), **given.data[_TABLE], "values": list(values)}
    return replace(given, data={**given.data, _TABLE: table})


def _wrong(given: Layers, key: str, message: str, hint: str = "") -> Problem:
    path = (_TABLE, key)
    return Problem(path=path, message=message, place=given.value_place(path), hint=hint)
