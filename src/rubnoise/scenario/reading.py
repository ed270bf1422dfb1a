"""Read a scenario from a file, a text, Python values or another scenario; return a Scenario or all problems."""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from hashlib import sha256
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from rubnoise.errors import NoColumn, Refused, RunFileRefused, ScenarioRefused
from rubnoise.model import CELLS, Model
from rubnoise.scenario import keys, layers
from rubnoise.scenario.checks import modelled
from rubnoise.scenario.document import SECTIONS, TOP, Document
from rubnoise.scenario.fields import Sizes, did_you_mean, keys_of
from rubnoise.scenario.scenario import Scenario, sized
from rubnoise.scenario.sweep_keys import SWEEP
from rubnoise.scenario.text import Layers, Problem, in_order, report
from rubnoise.units import Quantity, Unfit

ReadSizes = Callable[[str, str | None], Sequence[float]]
"""What returns the diameters (um) of a file and of a column in it; it raises Refused, NoColumn for the column."""

_TABLE = "diameter"
_STANDS_IN = (1.0,)  # for values that could not be read: what else is wrong with the scenario is still said


def hash_of(values: Sequence[float]) -> str:
    """Return the SHA-256 of diameters in um, as little-endian doubles in the order of the file."""
    return sha256(np.array(values, dtype="<f8").tobytes()).hexdigest()


def with_values(given: Layers, read: ReadSizes | None) -> tuple[Layers, list[Problem]]:
    """Return layers with the values of a file of diameters and their hash, and the problems of these.

    If a result has the values, they must have the hash, and the file is not read again.
    """
    table = given.table(_TABLE)
    if table.keys().isdisjoint(("file", "column", "hash")):
        return given, []
    if "file" not in table:
        key = "column" if "column" in table else "hash"
        return given, [given.problem((_TABLE, key), f"a {key} needs a file", 'file = "sizes.csv"')]
    if "values" in table:
        return given, _unlike(given, table)
    values, problems = _sizes_of_file(given, table, read)
    filled = {"hash": hash_of(values), **table, "values": list(values)}
    return replace(given, data={**given.data, _TABLE: filled}), problems


def _sizes_of_file(
    given: Layers, table: Mapping[str, Any], read: ReadSizes | None
) -> tuple[Sequence[float], list[Problem]]:
    """Return the values of a file, given relative to the scenario file that names it; or the reason of a refusal."""
    if not all(isinstance(table.get(key, ""), str) for key in ("file", "column", "hash")):
        return _STANDS_IN, []  # said where these keys are read
    try:
        values = (read or _refuse)(str(_size_file(given, table)), table.get("column"))
    except Refused as refused:
        key = "column" if isinstance(refused, NoColumn) else "file"
        return _STANDS_IN, [given.problem((_TABLE, key), str(refused))]
    found = hash_of(values)
    if table.get("hash", found) == found:
        return values, []
    message = f'the file changed: "{table["file"]}" has {found}, not {table["hash"]}'
    hint = "bring the file back, or take the hash away to use the file as it is"
    return _STANDS_IN, [given.problem((_TABLE, "hash"), message, hint)]


def _refuse(path: str, _column: str | None) -> Sequence[float]:
    raise Refused(f"{path}: is read by rubnoise.load, rubnoise.build and commands alone; here values are needed")


def _unlike(given: Layers, table: Mapping[str, Any]) -> list[Problem]:
    if "hash" not in table:
        return [given.problem((_TABLE, "values"), "both values and file are given", "keep exactly one of the two")]
    try:
        found = hash_of(Sizes("diameters").read(table["values"]))
    except Unfit:
        return []  # said where the values are read
    if table["hash"] == found:
        return []
    hint = "take the values away to read the file, or the file to use the values"
    return [given.problem((_TABLE, "hash"), f"the values beside it have {found}, not {table['hash']}", hint)]


def load(path: str | os.PathLike[str], overrides: Sequence[str] = (), read: ReadSizes | None = None) -> Scenario:
    """Return the scenario of a TOML file, with overrides of the form `KEY=VALUE` on top.

    ``read`` reads diameters of a file; without it a scenario with such a file is refused. Raises ScenarioRefused with
    every problem of the file, each with its line.
    """
    return checked(layers.from_file(path, overrides), read)


def loads(text: str, name: str = "<string>", overrides: Sequence[str] = ()) -> Scenario:
    """Return the scenario of a TOML text, which cannot extend a file; raises ScenarioRefused."""
    return checked(layers.from_text(text, name, overrides))


def build(values: Mapping[str, Any], name: str = "<python>", read: ReadSizes | None = None) -> Scenario:
    """Return the scenario of values as a TOML file would give them, where a bare number is in working units.

    Working units are um, um^2, um/s, kg, MPa, N/m and N s/m; ``read`` is as for `load`. Raises ScenarioRefused with
    every problem.
    """
    return checked(layers.from_values(name, values), read)


def stored(resolved: object, what: str = "the scenario in the file") -> Scenario:
    """Return the scenario of a result, as JSON or parsed; raises RunFileRefused, which names the file."""
    try:
        values: Any = json.loads(resolved) if isinstance(resolved, str) else resolved
        return build(values)
    except (ValueError, RecursionError, AttributeError, TypeError, Refused) as problem:
        raise RunFileRefused(f"{what} is not valid") from problem


def checked(given: Layers, read: ReadSizes | None = None) -> Scenario:
    """Return the scenario of its layers; raises ScenarioRefused with everything wrong with it."""
    if SWEEP in given.data:
        hint = "rubnoise sweep runs all of it, rubnoise check lists its points; without this table the file is one run"
        message = "a sweep is many runs, but this command needs one scenario"
        many = given.problem((SWEEP,), message, hint, place=given.key_place((SWEEP,)))
        raise ScenarioRefused(report([*given.problems, many]))
    scenario, problems = examined(given, read)
    if scenario is None:
        raise ScenarioRefused(report(problems))
    return scenario


def examined(given: Layers, read: ReadSizes | None = None) -> tuple[Scenario | None, list[Problem]]:
    """Return the scenario of its layers, or None, and all errors and warnings."""
    given = sized(given)
    if any(
        problem.path == ("format",) and problem.message.startswith("needs a rubnoise") for problem in given.problems
    ):
        return None, list(given.problems)  # the other keys may well be right in that format
    given, unread = with_values(given, read)
    document, wrong, problems = keys.read(given)
    wrong |= {_TABLE} if unread else set()
    model, tick, more = modelled(document, given, wrong)
    problems = [*given.problems, *unread, *problems, *more]
    refused = wrong or any(each.severity == "error" and not each.forbids_run for each in problems)
    if model is None or tick is None or refused:
        return None, problems
    return _scenario(given, document, model, tick, problems), problems


def _scenario(given: Layers, document: Document, model: Model, tick: Quantity, problems: list[Problem]) -> Scenario:
    """Return the scenario of a document that is right, with the defaults that follow from other keys."""
    slider, values = document.slider, {each.name: getattr(document, each.name) for each in fields(document)}
    if slider is not None and slider.coupling == "two-way" and slider.cells is None:
        values["slider"] = replace(slider, cells=CELLS)
    values["output"] = replace(document.output, tick=tick)
    table = given.table(_TABLE)
    return Scenario(
        **values,
        name=given.name,
        text=given.text,
        warnings=tuple(str(each) for each in in_order(problems) if each.severity == "warning"),
        too_large="\n".join(str(each) for each in in_order(problems) if each.forbids_run),
        physics=model,
        given=given.data,
        files=(*given.files, str(_size_file(given, table))) if "file" in table else given.files,
    )


def _size_file(given: Layers, table: Mapping[str, Any]) -> FilePath:
    """Return the path of the file of diameters, given relative to the scenario file that names it."""
    return FilePath(given.value_place((_TABLE, "file")).source).parent / table["file"]


def replaced(scenario: Scenario, changes: Mapping[Any, Any]) -> Scenario:
    """Return a scenario with other values of some keys (see Scenario.replace)."""
    if unnamed := [name for name in changes if not isinstance(name, str)]:
        raise ScenarioRefused(f"replace: {unnamed[0]!r} is no name of a key")
    # The seed and the engine may have been changed since the file was read.
    below = {"format": 1, **scenario.given, "run": scenario.resolved()["run"]}
    above: dict[str, Any] = {}
    for name, value in changes.items():
        table, key = place_of(name, {**below, **above}, "replace", value)
        if table and (value is not None or table in below):
            above[table] = {**(above.get(table) or {}), key: value}
        elif not table:
            above[key] = {**(above.get(key) or {}), **value} if isinstance(value, Mapping) else value
    made = checked(layers.from_values("<python>", below, above))
    return replace(made, text=made.to_toml())


def in_full(changes: Sequence[str]) -> tuple[str, ...]:
    """Return settings KEY=VALUE with the table of a key that has none, ``speed=2mm/s`` as ``sliding.speed=2mm/s``."""
    return tuple(_in_full(each) for each in changes)


def _in_full(change: str) -> str:
    name, equals, value = change.partition("=")
    name = name.strip()
    known = any(name in keys_of(kind) for kind in SECTIONS.values())
    if isinstance(change, layers.OptionOverride) or not equals or name in (*TOP, *SECTIONS) or not known:
        return change
    table, key = place_of(name, {}, f"--set {name}", value)
    return f"{table}.{key}={value}"


def place_of(name: str, values: Mapping[str, Any], said: str, value: Any = "") -> tuple[str, str]:
    """Return the table of a key, empty at the top, and the key in it; ``values`` are the tables of the scenario.

    A key of several tables means the only one that the scenario has. A name of both a table and a key, such as `load`,
    means the key if ``value`` is a text. Raises ScenarioRefused for an unknown key; ``said`` names the argument.
    """
    table, dot, key = name.partition(".")
    if dot:
        return table, key
    homes = [section for section, kind in SECTIONS.items() if name in keys_of(kind)]
    if (name in TOP or name in SECTIONS) and not (homes and isinstance(value, str)):
        return "", name
    homes = [section for section in homes if section in values] or homes
    if len(homes) == 1:
        return homes[0], name
    if homes:
        meant = " or ".join(f'"{home}.{name}"' for home in homes)
        raise ScenarioRefused(f"{said}: {name} is a key of several tables: say {meant}")
    known = (*TOP, *SECTIONS, *(key for kind in SECTIONS.values() for key in keys_of(kind)))
    hint = did_you_mean(name, tuple(dict.fromkeys(known)))
    raise ScenarioRefused(f"{said}: no key {name}" + (f"; {hint}" if hint else ""))
