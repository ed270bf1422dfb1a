"""The JSON schema of scenario files, which editors use."""

from collections.abc import Mapping
from inspect import cleandoc
from typing import Any

from rubnoise.scenario.document import SECTIONS, TOP, Document, presence
from rubnoise.scenario.fields import Key, Section, keys_of
from rubnoise.scenario.keys import ALTERNATIVES, DAMPINGS, LOSSES
from rubnoise.scenario.sweep_keys import SWEEP, Sweeping
from rubnoise.scenario.sweep_table import known_keys

_NO_MEAN = ("calibration", "patch_area")  # what does not go with a mean diameter
_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a scenario file of this version.

    Required keys may be missing in a file that extends another, or that sweeps them; other files must have them.
    """
    needed = {name: [key for key, about in keys_of(kind).items() if about.is_needed] for name, kind in SECTIONS.items()}
    return {
        "$schema": _DIALECT,
        "$defs": {kind.__name__: _table(kind) for kind in sorted(SECTIONS.values(), key=lambda each: each.__name__)},
        **_table(Document),
        "properties": {
            **_properties(TOP),
            **{name: {"$ref": f"#/$defs/{kind.__name__}"} for name, kind in SECTIONS.items()},
            "extends": {"type": "string", "description": "A scenario file to build on, relative to this."},
            SWEEP: _sweep(),
        },
        "required": ["format"],
        "if": {"not": {"anyOf": [{"required": ["extends"]}, {"required": [SWEEP]}]}},
        "then": _complete(
            [name for name in SECTIONS if presence(name) == "needed"],
            {name: keys for name, keys in needed.items() if keys},
        ),
    }


def _table(section: type[Section]) -> dict[str, Any]:
    return _object_with(_properties(keys_of(section))) | {"description": cleandoc(section.__doc__ or "")}


def _properties(keys: Mapping[str, Key]) -> dict[str, Any]:
    defaults = {name: {} if about.default is None else {"default": about.default} for name, about in keys.items()}
    return {name: defaults[name] | {"description": about.about} | about.kind.describe() for name, about in keys.items()}


def _sweep() -> dict[str, Any]:
    properties = {
        **_properties(keys_of(Sweeping)),
        "grid": _lists() | {"description": "Lists of values; every combination is a point."},
        "zip": _lists() | {"description": "Lists of equal length, in parallel."},
    }
    return _object_with(properties) | {"description": "Many runs from one file: the values that vary."}


def _lists() -> dict[str, Any]:
    """Return the tables of a scenario with a list of values for every key."""
    tables: dict[str, dict[str, Any]] = {name: {} for name in SECTIONS}
    for name, key in (known.split(".") for known in known_keys()):
        items = {"$ref": f"#/$defs/{SECTIONS[name].__name__}/properties/{key}"}
        tables[name][key] = {"type": "array", "minItems": 1, "items": items}
    return _object_with({name: _object_with(keys) for name, keys in tables.items() if keys})


def _object_with(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": False, "properties": properties}


def _complete(required: list[str], needed: dict[str, list[str]]) -> dict[str, Any]:
    properties: dict[str, Any] = {name: {"required": keys} for name, keys in needed.items()}
    for name, several in ALTERNATIVES.items():
        properties[name] = properties.get(name, {}) | {"allOf": [_one_of(each) for each in several]}
    properties["load"] |= {
        "if": {"properties": {"motion": {"const": "free"}}, "required": ["motion"]},
        "then": _one_of(LOSSES) | {"not": {"required": [key for way in DAMPINGS for key in way]}},
        "else": _one_of(DAMPINGS) | {"not": {"anyOf": [{"required": list(way)} for way in LOSSES]}},
    }
    with_slider = {"required": ["strength"], "properties": {"sliding": {"required": ["speed"]}}}
    weighing = {"interface": {"required": ["load", "hardness"]}, "sliding": {"required": ["speed"]}}
    dependent = {"slider": with_slider, "load": {"properties": weighing}}
    areas, counts = ALTERNATIVES["interface"]
    with_mean = _one_of((*areas, counts[0])) | {"not": {"anyOf": [{"required": [each]} for each in _NO_MEAN]}}
    return {
        "required": required,
        "properties": properties,
        "dependentSchemas": dependent,
        "if": {"properties": {"diameter": {"required": ["mean"]}}, "required": ["diameter"]},
        "then": {"properties": {"interface": with_mean}},
        "else": {"properties": {"interface": properties.pop("interface")}},
    }


def _one_of(ways: tuple[tuple[str, ...], ...]) -> dict[str, Any]:
    return {"oneOf": [{"required": list(way)} for way in ways]}
