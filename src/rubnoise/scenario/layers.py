"""The layers of a scenario: files, shipped or not, that it extends, itself, and overrides, merged deeply."""

import os
import tomllib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from pathlib import Path
from pathlib import Path as FilePath
from typing import Any, Final, Self

import numpy as np

from rubnoise.errors import Refused, ScenarioRefused, advised, did_you_mean, refusing_files
from rubnoise.regular_file import read_at_most
from rubnoise.scenario.document import FORMAT
from rubnoise.scenario.text import FILE_BYTES, LONGEST_LINE, Layers, Origin, Place, Problem, paths_of, read_toml, report
from rubnoise.units import is_of_pint

_PACKAGE = Path(__file__).parents[1]
_HOMES = (_PACKAGE / "shipped_scenarios", _PACKAGE.parents[1] / "scenarios")
"""Where an installed package keeps them, and where a checkout does."""


def _files() -> dict[str, Path]:
    """Return the path of every shipped scenario by its name, such as ``paper/fig5``, in alphabetical order."""
    home = next((home for home in _HOMES if home.is_dir()), _PACKAGE)
    return {path.relative_to(home).with_suffix("").as_posix(): path for path in sorted(home.glob("*/*.toml"))}


def shipped_names() -> tuple[str, ...]:
    """Return the names of all shipped scenarios, such as ``paper/fig5``, in alphabetical order."""
    return tuple(_files())


def shipped(name: str) -> Path:
    """Return the path of a scenario by its name, with or without ``.toml``; raises Refused, with near names."""
    files, wanted = _files(), _bare(name)
    if wanted in files:
        return files[wanted]
    raise Refused(advised(f"{name}: no scenario of rubnoise's", _advice(wanted)))


def _bare(name: str) -> str:
    return name.removesuffix(".toml").removeprefix("scenarios/")


def _advice(name: str) -> str:
    names = shipped_names()
    return did_you_mean(name, names, [each for each in names if each.rpartition("/")[2] == name], most=3)


def named(source: str | os.PathLike[str]) -> Path:
    """Return the path for a path or a name: an existing file, otherwise a shipped scenario, otherwise the path itself.

    Raises Refused, with near names, for a word without ``.toml`` that is neither.
    """
    path, text = Path(source), os.fspath(source)
    try:
        there = os.path.lexists(path)
    except ValueError:
        return path  # reading it says what is wrong
    if there or not isinstance(source, str | Path) or path.is_absolute():
        return path
    if _bare(text) in shipped_names():
        return shipped(text)
    if path.suffix or not (advice := _advice(text)):
        return path
    raise Refused(f"{text}: neither a file nor a scenario of rubnoise's; {advice}")


def shipped_titles() -> dict[str, str]:
    """Return the title of every shipped scenario by its name; one without a title has that of the file it extends."""
    return {name: _title(path) for name, path in _files().items()}


def _title(path: Path) -> str:
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    if "title" in data:
        return str(data["title"])
    return _title(path.parent / data["extends"]) if "extends" in data else ""


# Layers.
EXTENDS_DEPTH: Final = 8
_MOST_PARTS: Final = 4
"""Parts of the longest keys, those below sweep.grid."""

DAMPINGS: Final = (("damping",), ("damping_ratio",))
LOSSES: Final = (("restitution",), ("impact_damping",))
"""Ways to say what a slider or a load that weighs loses: of first order, and in free motion, which may have both."""

ALTERNATIVES: Final[Mapping[str, tuple[tuple[tuple[str, ...], ...], ...]]] = {
    "interface": ((("mean_real_contact_area",), ("load", "hardness")), (("mean_junction_count",), ("patch_area",))),
    "slider": (DAMPINGS,),
}
"""Ways to say one thing, by table: a scenario has exactly one of them, with all of its keys."""

EITHER: Final[Mapping[tuple[str, str], tuple[str, ...]]] = {
    **{
        (table, key): tuple(other for other_way in ways if other_way != way for other in other_way)
        for table, several in {**ALTERNATIVES, "load": (DAMPINGS, LOSSES)}.items()
        for ways in several
        for way in ways
        for key in way
    },
    ("diameter", "values"): ("file", "column", "hash"),
    **dict.fromkeys([("diameter", "file"), ("diameter", "column")], ("values", "hash")),
}
"""Other ways to say what a key says: a layer that has the key takes them out of the layers below."""


def from_file(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Layers:
    """Return the layers of a scenario file: the files that it extends, itself, the overrides."""
    return _layered(*_chain(FilePath(path), os.path.normpath(path)), overrides)


def from_text(text: str, name: str, overrides: Sequence[str] = ()) -> Layers:
    """Return the layers of a text, which cannot extend a file, since it is in no folder."""
    source = read_toml(name, text)
    refused = _not_extended(source, "a text has no folder to look in; load the file instead")
    return _layered([source], refused if "extends" in source.data else [], overrides)


def from_values(name: str, *values: Mapping[str, Any]) -> Layers:
    """Return the layers of values given in Python.

    In all but the first one None takes a key away, and a quantity needs a unit, as in a setting.
    """
    nowhere = Place(source=name, line=0, text="", start=0, end=0)
    first, *others = (
        Layers(
            name=name,
            data=plain(each),
            origins=dict.fromkeys(((), *paths_of(each)), Origin(nowhere, nowhere, "setting" if n else "values")),
        )
        for n, each in enumerate(values)
    )
    return _stacked([first, *others], first, [])


def _layered(files: list[Layers], problems: list[Problem], overrides: Sequence[str]) -> Layers:
    # In a report the requested file comes first, then what it extends, then the settings.
    settings = [_setting(text, len(files) + n) for n, text in enumerate(overrides)]
    return _stacked([*files, *settings], files[-1], problems)


def _stacked(sources: list[Layers], main: Layers, problems: list[Problem]) -> Layers:
    """Return sources laid over each other, the most basic first, with the name and the text of the requested one.

    Each file has a format. Raises ScenarioRefused for a newer one, in which the other keys may well be right.
    """
    problems = [*problems, *(problem for source in sources for problem in source.problems)]
    versions = [(source, source.data.get("format")) for source in sources]
    newer = [
        source.problem(("format",), f"needs a rubnoise that reads format {version}; this one reads format {FORMAT}")
        for source, version in versions
        if isinstance(version, int) and version > FORMAT
    ]
    if newer:
        raise ScenarioRefused(report([*problems, *newer]))
    missing = [source for source, version in versions if version is None and source.files and not problems]
    hint = "the first line of the file: format = 1"
    problems += [source.problem(("format",), "missing", hint, place=source.key_place(())) for source in missing]
    merged = without(reduce(laid, sources), ("extends",))
    return replace(merged, name=main.name, text=main.text, problems=tuple(problems))


def laid(below: Layers, above: Layers) -> Layers:
    """Return layers with another one on top, without what this one says in another way."""
    origins = {path: origin._replace(layer=below.depth) for path, origin in above.origins.items()}
    return replace(
        below,
        data=_laid(below.data, above.data),
        origins={**below.origins, **origins},
        files=(*below.files, *above.files),
        depth=below.depth + 1,
    )


def filled(layers: Layers, tables: Mapping[str, Any]) -> Layers:
    """Return layers on top of tables, which fill in what they do not give."""
    return replace(layers, data=_laid(tables, layers.data))


def without(layers: Layers, *paths: tuple[str, ...]) -> Layers:
    """Return layers without some keys or tables."""
    return replace(layers, data=_without(layers.data, paths))


class OptionOverride(str):
    """An override with its own option: `--seed 7` for `run.seed=7`."""

    __slots__ = ("option",)
    option: str

    def __new__(cls, option: str, key: str, value: object) -> Self:
        """Keep the option with its KEY=VALUE."""
        self = super().__new__(cls, f"{key}={value}")
        self.option = option
        return self


def _setting(text: str, rank: int) -> Layers:
    """Return the key of one `--set KEY=VALUE`, whose value is TOML if possible, otherwise a text."""
    key, _, value = text.partition("=")
    path = tuple(part.strip() for part in key.split("."))
    name = text.option if isinstance(text, OptionOverride) else f"--set {key.strip()}"
    shown, end = (f"{name} {value}", len(name)) if isinstance(text, OptionOverride) else (text, len(key))
    place = Place(source=name, line=0, text=shown, start=0, end=end, rank=rank)
    if wrong := _wrong_setting(text, path):
        return Layers(name=name, data={}, origins={}, problems=(Problem(path=(), message=wrong, place=place),))
    data: Any = override_value(value)
    for part in reversed(path):
        data = {part: data}
    origin = Origin(place, replace(place, start=min(end + 1, len(shown)), end=len(shown)), "setting")
    return Layers(name=name, data=data, origins=dict.fromkeys(paths_of(data), origin))


def _wrong_setting(text: str, path: tuple[str, ...]) -> str:
    if len(text) > LONGEST_LINE:
        return f"more than {LONGEST_LINE} characters"
    if "=" not in text or not all(path) or len(path) > _MOST_PARTS:
        return "not of the form KEY=VALUE, as in --set run.seed=7"
    return "extends belongs into a file" if path[0] == "extends" else ""


def override_value(value: str) -> Any:
    """Return the value of an override, read as TOML if possible, otherwise as a text."""
    try:
        data = tomllib.loads(f"value = {value}")
    except (tomllib.TOMLDecodeError, RecursionError):
        return value.strip()
    return data["value"] if data.keys() == {"value"} else value


def _chain(path: FilePath, name: str) -> tuple[list[Layers], list[Problem]]:
    """Return a file's sources, the most basic first, and the problems of how they extend one another."""
    sources, seen = [read_toml(name, _text_of_file(path, name))], [os.path.realpath(path)]
    while isinstance(base := sources[0].data.get("extends"), str):
        try:
            # A base file is relative to the folder, or one that comes with rubnoise.
            beside = path.parent / base
            path = shipped(base) if base in shipped_names() and not os.path.lexists(beside) else beside
            text = _text_of_file(path, base)
        except Refused as refusal:
            return sources, _not_extended(sources[0], str(refusal))
        if os.path.realpath(path) in seen:
            return sources, _not_extended(sources[0], "extends a file that extends this one")
        if len(sources) > EXTENDS_DEPTH:
            return sources, _not_extended(sources[0], f"more than {EXTENDS_DEPTH} files extend one another")
        sources.insert(0, read_toml(os.path.normpath(path), text, rank=len(sources)))
        seen.append(os.path.realpath(path))
    return sources, _not_extended(sources[0], "needs the name of a file") if "extends" in sources[0].data else []


def _not_extended(source: Layers, message: str) -> list[Problem]:
    return [source.problem(("extends",), message)]


def _text_of_file(path: FilePath, name: str) -> str:
    with refusing_files(name, ScenarioRefused):
        content = read_at_most(path, FILE_BYTES + 1)
    if len(content) > FILE_BYTES:
        raise ScenarioRefused(f"{name}: larger than {FILE_BYTES // 1024} kB")
    try:
        return content.decode("utf-8-sig")  # some editors begin a file with a byte order mark
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ScenarioRefused(f"{name}:{line}: error: not UTF-8 text") from None


def plain(value: Any) -> Any:
    """Return copies of tables, with numbers and texts of numpy (also in 0-d arrays) as Python's."""
    if isinstance(value, Mapping):
        return {key: plain(each) for key, each in value.items()}
    if isinstance(value, np.generic | np.ndarray) and value.ndim == 0:
        item = value.item()
        return float(item) if isinstance(item, np.floating) else item  # extended doubles, which Python lacks
    if is_of_pint(value) and str(value.units) in ("dimensionless", ""):
        return plain(value.magnitude)
    return value


def _laid(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables with those of another layer on top, without what this one says in another way."""
    tables = {name: table for name, table in above.items() if isinstance(table, Mapping)}
    said = {(name, key) for name, table in tables.items() for key, value in table.items() if value is not None}
    anew = {(path[0], other) for path in said for other in EITHER.get(path, ())} - said
    return _merged(_without(below, anew), above)


def _without(data: Mapping[str, Any], paths: Collection[tuple[str, ...]]) -> dict[str, Any]:
    kept = {name: table for name, table in data.items() if (name,) not in paths}
    tables = {name: table for name, table in kept.items() if isinstance(table, Mapping)}
    return kept | {
        name: {key: value for key, value in table.items() if (name, key) not in paths} for name, table in tables.items()
    }


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    found = dict(below)
    for key, value in above.items():
        there = found.get(key)
        inside = there if isinstance(there, Mapping) else {}
        found[key] = _merged(inside, value) if isinstance(value, Mapping) else value
    return {key: value for key, value in found.items() if value is not None}
