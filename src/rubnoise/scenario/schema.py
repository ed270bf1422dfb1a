"""The JSON schema of scenario files, which editors use."""

from typing import Any

from rubnoise.scenario.document import Document
from rubnoise.scenario.keys import ALTERNATIVES, DAMPINGS, LOSSES, SECTIONS, SWEEP
from rubnoise.scenario.sweep_table import Sweeping, known_keys

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a scenario file of this version.

    Required keys may be missing in a file that extends another, or that sweeps them; other files must have them.
    """
    schema = Document.model_json_schema()
    sections = schema["$defs"]
    needed = {name: section.pop("required") for name, section in sections.items() if "required" in section}
    required = [name for name in schema.pop("required") if name != "format"]
    schema["properties"]["extends"] = {
        "type": "string",
        "description": "A scenario file to build on, relative to this.",
    }
    schema["properties"][SWEEP] = _sweep()
    return {
        "$schema": _DIALECT,
        **_without_noise(schema),
        "required": ["format"],
        "if": {"not": {"anyOf": [{"required": ["extends"]}, {"required": [SWEEP]}]}},
        "then": _complete(required, needed),
    }


def _sweep() -> dict[str, Any]:
    properties = {
        **Sweeping.model_json_schema()["properties"],
        "grid": _lists() | {"description": "Lists of values; every combination is a point."},
        "zip": _lists() | {"description": "Lists of equal length, in parallel."},
    }
    return _object_with(properties) | {"description": "Many runs from one file: the values that vary."}


def _lists() -> dict[str, Any]:
    """Return the tables of a scenario with a list of values for every key."""
    tables: dict[str, dict[str, Any]] = {name: {} for name in SECTIONS}
    for name, _, key in (known.partition(".") for known in known_keys()):
        items = {"$ref": f"#/$defs/{SECTIONS[name].__name__}/properties/{key}"}
        tables[name][key] = {"type": "array", "minItems": 1, "items": items}
    return _object_with({name: _object_with(keys) for name, keys in tables.items() if keys})


def _object_with(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": False, "properties": properties}


def _complete(required: list[str], needed: dict[str, list[str]]) -> dict[str, Any]:
    properties: dict[str, Any] = {name.lower(): {"required": keys} for name, keys in needed.items()}
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
    return {"required": required, "properties": properties, "dependentSchemas": dependent}


def _one_of(ways: tuple[tuple[str, ...], ...]) -> dict[str, Any]:
    return {"oneOf": [{"required": list(way)} for way in ways]}


def _without_noise(node: Any) -> Any:
    """Drop titles, which repeat the keys, and nulls, which TOML does not have: an optional key may be left out."""
    if isinstance(node, list):
        return [_without_noise(item) for item in node]
    if not isinstance(node, dict):
        return node
    kept = {key: value for key, value in node.items() if not _is_noise(key, value)}
    if "anyOf" in kept:
        (only,) = [item for item in kept.pop("anyOf") if item != {"type": "null"}]
        kept |= only
    return {key: _without_noise(value) for key, value in kept.items()}


def _is_noise(key: str, value: Any) -> bool:
    return (key == "title" and isinstance(value, str)) or (
        key == "default" and (value is None or isinstance(value, dict))
    )
