"""Read a scenario from a file, a text, Python values or another scenario; return a Scenario or all problems."""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from hashlib import sha256
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from rubnoise.errors import NoColumn, Refused, RunFileRefused, ScenarioRefused, advised, did_you_mean
from rubnoise.model import CELLS
from rubnoise.scenario import keys, layers
from rubnoise.scenario.checks import modelled
from rubnoise.scenario.document import SECTIONS, SWEEP, TOP
from rubnoise.scenario.fields import Sizes, keys_of
from rubnoise.scenario.scenario import Scenario, sized
from rubnoise.scenario.text import Layers, Problem, in_order, report
from rubnoise.units import Unfit

ReadSizes = Callable[[str, str | None], Sequence[float]]
"""What returns the diameters (um) of a file and of a column in it; it raises Refused, NoColumn for the column."""

_TABLE = "diameter"
_STANDS_IN: Sequence[float] = (1.0,)  # for values that cannot be read: what else is wrong is still said


def hash_of(values: Sequence[float]) -> str:
    """Return the SHA-256 of diameters in um, as little-endian doubles in the order of the file."""
    return sha256(np.array(values, dtype="<f8").tobytes()).hexdigest()


def _with_values(given: Layers, read: ReadSizes | None) -> tuple[Layers, list[Problem]]:
    """Return layers with the values of a file of diameters and their hash, and the problems of these.

    If a result has the values, they must have the hash, and the file is not read again.
    """
    table = given.table(_TABLE)
    named = [key for key in ("column", "hash", "file") if key in table]
    if not named:
        return given, []
    if "file" not in table:
        return given, [given.problem((_TABLE, named[0]), f"a {named[0]} needs a file", 'file = "sizes.csv"')]
    if "values" in table and "hash" not in table:
        return given, [
            given.problem((_TABLE, "values"), "both values and file are given", "keep exactly one of the two")
        ]
    values, problems = _STANDS_IN, list[Problem]()
    try:
        if "values" in table:
            values = Sizes("diameters").read(table["values"])
        elif all(isinstance(table[key], str) for key in named):
            values = (read or _refuse)(str(_size_file(given, table)), table.get("column"))
        else:
            named = []
    except Unfit:
        return given, []  # said where the values are read
    except Refused as refused:
        problems = [given.problem((_TABLE, "column" if isinstance(refused, NoColumn) else "file"), str(refused))]
    found = hash_of(values)
    if "hash" in named and table["hash"] != found and not problems:
        message = "the values beside it have"
        hint = "take the values away to read the file, or the file to use the values"
        if "values" not in table:
            message = f'the file changed: "{table["file"]}" has'
            hint = "bring the file back, or take the hash away to use the file as it is"
        problems = [given.problem((_TABLE, "hash"), f"{message} {found}, not {table['hash']}", hint)]
    filled = {"hash": found, **table, "values": list(values)}
    return replace(given, data={**given.data, _TABLE: filled}), problems


def _refuse(path: str, _column: str | None) -> Sequence[float]:
    raise Refused(f"{path}: is read by rubnoise.load, rubnoise.build and commands alone; here values are needed")


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
    given, unread = _with_values(sized(given), read)
    document, wrong, problems = keys.read(given)
    wrong |= {_TABLE} if unread else set()
    model, tick, more = modelled(document, given, wrong)
    problems = [*given.problems, *unread, *problems, *more]
    refused = wrong or any(each.severity == "error" and not each.forbids_run for each in problems)
    if model is None or tick is None or refused:
        return None, problems
    # Defaults that follow from other keys are filled in.
    slider, values = document.slider, {each.name: getattr(document, each.name) for each in fields(document)}
    if slider is not None and slider.coupling == "two-way" and slider.cells is None:
        values["slider"] = replace(slider, cells=CELLS)
    values["output"] = replace(document.output, tick=tick)
    sizes, shown = given.table(_TABLE), in_order(problems)
    scenario = Scenario(
        **values,
        name=given.name,
        text=given.text,
        warnings=tuple(str(each) for each in shown if each.severity == "warning"),
        too_large="\n".join(str(each) for each in shown if each.forbids_run),
        physics=model,
        given=given.data,
        files=(*given.files, str(_size_file(given, sizes))) if "file" in sizes else given.files,
    )
    return scenario, problems


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
    full, known = list[str](), {key for kind in SECTIONS.values() for key in keys_of(kind)} - {*TOP, *SECTIONS}
    for change in changes:
        name, equals, value = change.partition("=")
        named = equals and name.strip() in known
        full.append(f"{'.'.join(place_of(name.strip(), {}, f'--set {name}', value))}={value}" if named else change)
    return tuple(full)


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
    raise ScenarioRefused(advised(f"{said}: no key {name}", did_you_mean(name, known)))
