"""What a file holds by name, compared with what it should hold: groups, columns, how they are stored, attributes."""

import json
from collections.abc import Callable, Mapping
from typing import Any, Final

from rubnoise.analysis.verifying.findings import Notes
from rubnoise.analysis.verifying.forms import digits_form
from rubnoise.storage.inventory import DATASET, Inventory, stored_texts
from rubnoise.storage.schema import HASH

Rule = Callable[[str], str | None]
"""Returns what a text should be, in words or as it should stand there; None where it is right."""

Rules = Mapping[tuple[str, str], Rule]
"""Rules by the path of an object and the name of its attribute; other attributes are as they are expected."""

OF_HDF5: Final = frozenset(("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"))
"""Attributes that HDF5 writes itself, in types of its own choice."""

LONGEST: Final = 160
"""Characters of a value that are shown."""


def compare_structure(notes: Notes, found: Inventory, expected: Inventory) -> None:
    """Note where a file lacks a group or a column, has another one, or stores it otherwise."""
    for path in dict.fromkeys([*expected, *found]):
        there, right = found.get(path, {}), expected.get(path, {})
        notes.say(path, found=there.get("kind", "missing"), expected=right.get("kind", "nothing of this name"))
        if there.get("kind") == right.get("kind") == DATASET:
            for about in ("type", "shape", "storage", "sources"):
                notes.say(f"{path} {about}", found=there[about], expected=right[about])


def compare_attributes(
    notes: Notes, rules: Rules, found: Inventory, expected: Inventory, *, free: tuple[str, ...] = ()
) -> None:
    """Note where an attribute is missing, unknown or not what it should be; hashes of columns are asked their form.

    Of ``free`` objects the numbers come and go: of those that are not expected the type is asked alone.
    """
    for path in (path for path in expected if path in found):
        there, right = found[path]["attributes"], expected[path]["attributes"]
        for name in dict.fromkeys([*right, *there]):
            if path in free and name not in right:
                form = (there[name]["type"], there[name]["shape"])
                notes.say(f"{path} {name} type", found=form, expected=("<f8", []))
            elif name in right and name in there:
                rule = rules.get((path, name)) or (digits_form if name == HASH else None)
                _compare(notes, f"{path} {name}", rule, there[name], right[name])
            else:
                notes.say(
                    f"{path} {name}",
                    found=shown(there[name]["value"]) if name in there else "missing",
                    expected=shown(right[name]["value"]) if name in right else "no attribute of this name",
                )


def shown(value: Any) -> str:
    """Return a value as text, cut where it is long."""
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}... ({len(text)} characters)"


def _compare(notes: Notes, place: str, rule: Rule | None, there: Mapping[str, Any], right: Mapping[str, Any]) -> None:
    value, name = there["value"], place.rpartition(" ")[2]
    if rule is not None and isinstance(value, str):
        should = rule(value)
        notes.say(place, found=shown(value), expected=shown(value) if should is None else should)
        right = stored_texts({name: value})[name]
    elif json.dumps(value) != json.dumps(right["value"]):
        notes.say(place, found=shown(value), expected=shown(right["value"]))
        return
    form = ("type", "shape")
    same = name in OF_HDF5 or all(there[about] == right[about] for about in form)
    found, expected = ([each[about] for about in form] for each in (there, right))
    notes.say(f"{place} type", found=expected if same else found, expected=expected)
