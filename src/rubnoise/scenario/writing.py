"""Write a scenario file together with the files that it extends: one file that needs no other."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from rubnoise.scenario import layers


def as_toml(path: Path) -> str:
    """Return the merged keys of a file and of the files that it extends, as the text of one file."""
    given = layers.from_file(path)
    comments = [f"{line}\n" for line in given.main.text.splitlines() if line.startswith("# ")]
    return "".join(comments) + text_of(given.data)


def text_of(scenario: Mapping[str, Any]) -> str:
    """Return the keys of a scenario as the text of a file."""
    top = [f"{key} = {toml_value(value)}" for key, value in scenario.items() if not isinstance(value, Mapping)]
    tables = [
        line for name, table in scenario.items() if isinstance(table, Mapping) for line in _table_lines(name, table)
    ]
    return "\n".join([*top, *tables]) + "\n"


def _table_lines(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys of a table with simple values, then the tables in it; no key needs quotes."""
    inner = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    plain = {key: value for key, value in table.items() if key not in inner}
    if plain or not inner:
        yield from ("", f"[{name}]", *(f"{key} = {toml_value(value)}" for key, value in plain.items()))
    for key, value in inner.items():
        yield from _table_lines(f"{name}.{key}", value)


_IN_A_LINE: Final = 32  # lines of a file have a length at most


def toml_value(value: Any) -> str:
    """Return a text, number, boolean, or a list or table of these as TOML, which differs from JSON in one character."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {toml_value(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        each = list(map(toml_value, value))
        rows = [", ".join(each[at : at + _IN_A_LINE]) for at in range(0, len(each), _IN_A_LINE)]
        return "[" + ", ".join(rows) + "]" if len(rows) < 2 else "[\n    " + ",\n    ".join(rows) + ",\n]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
