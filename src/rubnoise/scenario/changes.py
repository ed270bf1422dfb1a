"""One scenario made from another by other values of some keys."""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario.document import Document
from rubnoise.scenario.fields import did_you_mean
from rubnoise.scenario.keys import ALTERNATIVES, SECTIONS
from rubnoise.scenario.problems import Path
from rubnoise.scenario.reading import build_changed
from rubnoise.scenario.scenario import Scenario

EITHER = {
    (table, key): tuple(other for way in ways if key not in way for other in way)
    for table, several in ALTERNATIVES.items()
    for ways in several
    for key in (key for way in ways for key in way)
}
EITHER |= {("diameter", "values"): ("file", "column", "hash")}
EITHER |= {("diameter", key): ("values", "hash") for key in ("file", "column")}
"""Other ways to say what a key says: setting it takes their keys away."""


def replaced(scenario: Scenario, changes: Mapping[str, Any]) -> Scenario:
    """Return a scenario with other values of some keys (see Scenario.replace)."""
    values: dict[str, Any] = {"format": 1, **deepcopy(dict(scenario.given))}
    # The seed and the engine may have been changed since the file was read.
    values["run"] = dict(scenario.resolved()["run"])
    places = [(*_place(name, value, values), value) for name, value in changes.items()]
    named = {key for _, key, _ in places}
    for table, key, value in places:
        if not table:
            _set(values, key, value)
        elif value is None and table not in values:
            continue
        else:
            there = values.get(table)
            values[table] = dict(there) if isinstance(there, Mapping) else {}
            for other in EITHER.get((table, key), ()) if value is not None else ():
                if other not in named:
                    values[table].pop(other, None)
            _set(values[table], key, value)
    changed = build_changed(values, {path for place in places for path in _paths(*place)})
    return replace(changed, text=changed.to_toml())


def _paths(table: str, key: str, value: Any) -> Iterator[Path]:
    """Yield each changed key with its table: of a table that is given as a whole, each key in it."""
    if table:
        yield table, key
    elif isinstance(value, Mapping):
        yield from ((key, inner) for inner in value)


def _set(table: dict[str, Any], key: str, value: Any) -> None:
    if value is None:
        table.pop(key, None)
    elif isinstance(value, Mapping) and isinstance(table.get(key), Mapping):
        table[key] = {**table[key], **value}
    else:
        table[key] = value


def _place(name: str, value: Any, values: Mapping[str, Any]) -> tuple[str, str]:
    """Return the table of a key, empty at the top, and the key in it; raises ScenarioRefused for no such key.

    A key of several tables is that of the only one that a scenario has.
    """
    table, dot, key = name.partition(".")
    if dot:
        return table, key
    homes = [section for section, kind in SECTIONS.items() if name in kind.model_fields]
    if name in Document.model_fields and not (homes and isinstance(value, str)):  # `load` is a table and a key
        return "", name
    homes = [section for section in homes if section in values] or homes
    if len(homes) == 1:
        return homes[0], name
    if homes:
        meant = " or ".join(f'"{home}.{name}"' for home in homes)
        raise ScenarioRefused(f"replace: {name} is a key of several tables: say {meant}")
    known = (*Document.model_fields, *(key for kind in SECTIONS.values() for key in kind.model_fields))
    hint = did_you_mean(name, tuple(dict.fromkeys(known)))
    raise ScenarioRefused(f"replace: no key {name}" + (f"; {hint}" if hint else ""))
