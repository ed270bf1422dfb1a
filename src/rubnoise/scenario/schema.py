"""The JSON schema of scenario files, for editors."""

from typing import Any

from rubnoise.scenario.document import Document

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a scenario file, with what is available in this version.

    A file that extends another may leave needed keys to it, so they are demanded only of one that does not.
    """
    schema = Document.model_json_schema()
    sections = schema["$defs"]
    needed = {name: section.pop("required") for name, section in sections.items() if "required" in section}
    required = [name for name in schema.pop("required") if name != "format"]
    schema["properties"]["extends"] = {
        "type": "string",
        "description": "A scenario file to build on, relative to this.",
    }
    return {
        "$schema": _DIALECT,
        **_without_noise(schema),
        "required": ["format"],
        "if": {"not": {"required": ["extends"]}},
        "then": _complete(required, needed),
    }


def _complete(required: list[str], needed: dict[str, list[str]]) -> dict[str, Any]:
    one_damping = {"oneOf": [{"required": ["damping"]}, {"required": ["damping_ratio"]}]}
    properties: dict[str, Any] = {name.lower(): {"required": keys} for name, keys in needed.items()}
    properties["slider"] |= one_damping
    with_slider = {"required": ["strength"], "properties": {"sliding": {"required": ["speed"]}}}
    return {"required": required, "properties": properties, "dependentSchemas": {"slider": with_slider}}


def _without_noise(node: Any) -> Any:
    """Drop titles, which repeat the keys, and nulls, which TOML lacks: an optional key is one that may be left out."""
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
