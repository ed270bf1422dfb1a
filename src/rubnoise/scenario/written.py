"""What is written from the definitions of the keys: a template of a scenario, and the JSON schema that editors use."""

import tomllib
from collections.abc import Iterator, Mapping
from textwrap import wrap
from typing import Any, Final

from rubnoise.scenario import fields, layers
from rubnoise.scenario.document import SECTIONS, SWEEP, TOP, Document, Sweeping, presence
from rubnoise.scenario.fields import Choice, Field, Key, Measure, Number, Parts, Section, Sizes, about_of, keys_of
from rubnoise.scenario.keys import GRID
from rubnoise.scenario.layers import ALTERNATIVES, DAMPINGS, LOSSES, shipped
from rubnoise.scenario.sweep import SWEPT
from rubnoise.scenario.text import text_of, toml_value
from rubnoise.units import NUMBER

WIDTH: Final = 100
HEADING: Final = """\
# A rubnoise scenario in TOML. Write a quantity as a text with its unit, and a plain number as a number.
# A line that begins with # is a comment; remove the # to set an optional key. A key marked "Needed." is
# required. All other values are defaults, and you may delete their lines."""
EXTENDS: Final = "A scenario file to extend, relative to this one; keys in this file replace its keys."

VARIED: Final = "Each value of a key is combined with each value of the others; lists of [sweep.zip] go in parallel."

WITH_SLIDER: Final = ("strength", "slider")
"""Optional tables that the template sets, so that a first run has a motion to look at and to listen to."""

SET: Final = (
    ("interface", "mean_real_contact_area"),
    ("interface", "mean_junction_count"),
    ("sliding", "speed"),
    ("slider", "damping"),
)
"""Keys without a default that the template sets beside those that are needed."""


def template() -> str:
    """Return the text of a scenario that runs as it is, with all optional keys as comments."""
    lines = [HEADING, *_key("format", TOP["format"])]
    lines += [*_comment(EXTENDS), '#extends = "base.toml"']
    lines += _key("title", TOP["title"])
    for name, section in SECTIONS.items():
        optional = presence(name) == "optional"
        lines += _table_lines(name, section, "This table is optional." if optional else "")
    lines += _table_lines(SWEEP, Sweeping, "This table is optional; `rubnoise sweep` makes the runs.")
    lines += [*_comment(VARIED), f"#[{SWEEP}.{GRID}]", "#interface.mean_junction_count = [10, 20, 40]"]
    return "\n".join(lines) + "\n"


def _table_lines(name: str, section: type[Section], remark: str) -> Iterator[str]:
    """Yield the lines of a table; all lines of one with a remark are comments, but for those of a slider."""
    off = bool(remark) and name not in WITH_SLIDER
    yield ""
    yield from _comment(f"{' '.join(about_of(section).split())} {remark}".rstrip())
    yield f"{'#' if off else ''}[{name}]"
    for key, about in keys_of(section).items():
        unset = off or (not about.is_needed and about.default is None and (name, key) not in SET)
        yield from _key(key, about, off=unset)


def _key(key: str, about: Key, *, off: bool = False) -> Iterator[str]:
    words = about.kind.available if isinstance(about.kind, Choice) else ()
    choices = "" if all(word in about.about for word in words) else f"One of {', '.join(words)}."
    need = "Needed." if about.is_needed else ""
    yield from _comment(" ".join(filter(None, (about.about, choices, need, about.remark))))
    yield f"{'#' if off else ''}{key} = {toml_value(about.sample if about.default is None else about.default)}"


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in wrap(text, WIDTH - 2, break_long_words=False, break_on_hyphens=False)]


def copy_of(name: str) -> str:
    """Return the text of a shipped scenario as a complete file; the keys that it extends come before its own.

    Raises Refused, with near names, for an unknown name.
    """
    path = shipped(name)
    text = path.read_text(encoding="utf-8")
    if "extends" in tomllib.loads(text):
        comments = [f"{line}\n" for line in text.splitlines() if line.startswith("# ")]
        return "".join(comments) + text_of(layers.from_file(path).data)
    # A first line may name a schema, by a path that holds in the checkout alone.
    first, _, rest = text.partition("\n")
    return rest if first.startswith("#:schema") else text


_NO_MEAN = ("calibration", "patch_area")  # what does not go with a mean diameter
_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a scenario file of this version.

    Required keys may be missing in a file that extends another, or that sweeps them; other files must have them.
    """
    return {
        "$schema": _DIALECT,
        "$defs": {kind.__name__: _table(kind) for kind in sorted(SECTIONS.values(), key=lambda each: each.__name__)},
        **_table(Document),
        "properties": {
            **_properties(TOP),
            **{name: {"$ref": f"#/$defs/{kind.__name__}"} for name, kind in SECTIONS.items()},
            "extends": {"type": "string", "description": "A scenario file to build on, relative to this."},
            SWEEP: _sweep_table(),
        },
        "required": ["format"],
        "if": {"not": {"anyOf": [{"required": ["extends"]}, {"required": [SWEEP]}]}},
        "then": _complete(),
    }


def _table(section: type[Section]) -> dict[str, Any]:
    return _object_with(_properties(keys_of(section))) | {"description": about_of(section)}


def _properties(keys: Mapping[str, Key]) -> dict[str, Any]:
    defaults = {name: {} if about.default is None else {"default": about.default} for name, about in keys.items()}
    return {name: defaults[name] | {"description": about.about} | _schema(about.kind) for name, about in keys.items()}


def _schema(kind: Field) -> dict[str, Any]:
    size = {"type": ["number", "string"]}
    if isinstance(kind, Measure):
        return {"type": "string", "pattern": rf"^\s*{NUMBER} *\S.*$", "examples": [each.example for each in kind.kinds]}
    if isinstance(kind, Number):
        bounds = {"minimum": kind.possible.low, "maximum": kind.possible.high}
        return {"type": "integer" if kind.whole else "number", **bounds}
    if isinstance(kind, Choice):
        return {"enum": list(kind.available)}
    if isinstance(kind, Sizes):
        return {"type": "array", "minItems": 1, "maxItems": fields.MOST, "items": size}
    if isinstance(kind, Parts):
        part = _object_with({"law": {"enum": list(fields.LAWS_OF_PARTS)}, "mean": size, "spread": {"type": "string"}})
        return {"type": "array", "minItems": 1, "items": part | {"required": ["law", "mean"]}}
    return {"type": "string", "maxLength": fields.TITLE_CHARACTERS}


def _sweep_table() -> dict[str, Any]:
    """Return the table [sweep]; grid and zip have a list of values for every key of a scenario."""
    tables: dict[str, dict[str, Any]] = {name: {} for name in SECTIONS}
    for name, key in (known.split(".") for known in SWEPT):
        items = {"$ref": f"#/$defs/{SECTIONS[name].__name__}/properties/{key}"}
        tables[name][key] = {"type": "array", "minItems": 1, "items": items}
    lists = _object_with({name: _object_with(keys) for name, keys in tables.items()})
    properties = {
        **_properties(keys_of(Sweeping)),
        "grid": lists | {"description": "Lists of values; every combination is a point."},
        "zip": lists | {"description": "Lists of equal length, in parallel."},
    }
    return _object_with(properties) | {"description": "Many runs from one file: the values that vary."}


def _object_with(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": False, "properties": properties}


def _complete() -> dict[str, Any]:
    """Return what a file that is complete in itself must have."""
    needed = {name: [key for key, about in keys_of(kind).items() if about.is_needed] for name, kind in SECTIONS.items()}
    properties: dict[str, Any] = {name: {"required": keys} for name, keys in needed.items() if keys}
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
        "required": [name for name in SECTIONS if presence(name) == "needed"],
        "properties": properties,
        "dependentSchemas": dependent,
        "if": {"properties": {"diameter": {"required": ["mean"]}}, "required": ["diameter"]},
        "then": {"properties": {"interface": with_mean}},
        "else": {"properties": {"interface": properties.pop("interface")}},
    }


def _one_of(ways: tuple[tuple[str, ...], ...]) -> dict[str, Any]:
    return {"oneOf": [{"required": list(way)} for way in ways]}
