"""The layers of a scenario: the files that it extends, the file itself, and overrides by `--set`, merged deeply."""

import os
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, Final, Literal, Self

import numpy as np

from rubnoise.errors import ScenarioRefused
from rubnoise.regular_file import NotRegular, read_at_most
from rubnoise.scenario import limits
from rubnoise.scenario.problems import Path, Place, Problem
from rubnoise.scenario.source import Source
from rubnoise.units import is_of_pint

SET = "--set"

_MOST_PARTS: Final = 4
"""Parts of the longest keys, those below sweep.grid."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layers:
    """Sources from the most basic to the topmost, their merged data, and the problems found while merging."""

    sources: tuple[Source, ...]
    data: dict[str, Any]
    problems: tuple[Problem, ...]

    def source_of(self, path: Path) -> Source:
        """Return the topmost source with a key, or with the nearest table above it."""
        for known in (path[:n] for n in range(len(path), 0, -1)):
            for source in reversed(self.sources):
                if gives(source.data, known):
                    return source
        return self.main

    def origin_of(self, path: Path) -> Source:
        """Return the most basic source with a key, the first that names it."""
        return next((source for source in self.sources if gives(source.data, path)), self.main)

    @property
    def main(self) -> Source:
        """The requested file."""
        return next(source for source in reversed(self.sources) if not isinstance(source, Overlay))

    @property
    def files(self) -> tuple[str, ...]:
        """The files that were read, the most basic first."""
        return tuple(source.name for source in self.sources if not isinstance(source, Overlay | Values))

    def value_place(self, path: Path) -> Place:
        """Return the place of the value that counts for a key."""
        return self.source_of(path).value_place(path)

    def key_place(self, path: Path) -> Place:
        """Return the place where the key that counts is named."""
        return self.source_of(path).key_place(path)

    def problem(
        self,
        path: Path,
        message: str,
        hint: str = "",
        *,
        place: Place | None = None,
        severity: Literal["error", "warning"] = "error",
        forbids_run: bool = False,
    ) -> Problem:
        """Return what is wrong with a key, shown at its value if no other place is given."""
        shown = place or self.value_place(path)
        return Problem(path=path, message=message, place=shown, hint=hint, severity=severity, forbids_run=forbids_run)

    def topped(self, overlay: "Overlay", *, without: str) -> "Layers":
        """Return these layers with another one on top, and without a table."""
        data = _merged([self.data, overlay.data])
        kept = {key: value for key, value in data.items() if key != without}
        return replace(self, sources=(*self.sources, overlay), data=kept)


@dataclass(frozen=True)
class Overlay(Source):
    """Keys on top of a file; an overlay is not a file and has no format number."""


@dataclass(frozen=True)
class Setting(Overlay):
    """One `--set KEY=VALUE`; its text is that of the command line."""

    @property
    def _halves(self) -> tuple[tuple[str, ...], str]:
        key, _, value = self.text.partition("=")
        return tuple(part.strip() for part in key.split(".")), value

    @property
    def data(self) -> dict[str, Any]:
        """The value under its key, read as TOML if possible, otherwise as a string."""
        path, value = self._halves
        data: Any = override_value(value)
        for part in reversed(path):
            data = {part: data}
        return {} if self.problems else data

    @property
    def problems(self) -> tuple[Problem, ...]:
        """The problems of a text that is not KEY=VALUE."""
        path, _ = self._halves
        if len(self.text) > limits.LINE_CHARACTERS:
            message = f"more than {limits.LINE_CHARACTERS} characters"
        elif "=" not in self.text or not all(path) or len(path) > _MOST_PARTS:
            message = "not of the form KEY=VALUE, as in --set run.seed=7"
        elif path[0] == "extends":
            message = "extends belongs into a file"
        else:
            return ()
        return (Problem(path=(), message=message, place=self.key_place(())),)

    @property
    def _typed(self) -> tuple[str, int]:
        """What was typed, and how long the key is before its value."""
        return self.text, len(self.text.partition("=")[0])

    def value_place(self, path: Path) -> Place:  # noqa: ARG002  (one key or none)
        """Return the place of the value."""
        text, key = self._typed
        return Place(source=self.name, line=0, text=text, start=min(key + 1, len(text)), end=len(text), rank=self.rank)

    def key_place(self, path: Path) -> Place:  # noqa: ARG002  (one key)
        """Return the place of the key."""
        text, key = self._typed
        return Place(source=self.name, line=0, text=text, start=0, end=key, rank=self.rank)


class OptionOverride(str):
    """An override with its own option: `--seed 7` for `run.seed=7`."""

    __slots__ = ("option",)
    option: str

    def __new__(cls, option: str, key: str, value: object) -> Self:
        """Keep the option with its KEY=VALUE."""
        self = super().__new__(cls, f"{key}={value}")
        self.option = option
        return self


@dataclass(frozen=True)
class OptionSetting(Setting):
    """The source of an override with its own option; its name and its places are that option."""

    @property
    def _typed(self) -> tuple[str, int]:
        return f"{self.name} {self._halves[1]}", len(self.name)


@dataclass(frozen=True)
class Values(Source):
    """Values given in Python, which have no lines."""

    values: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def data(self) -> dict[str, Any]:
        """The values in copies of their tables, as Python objects."""
        return plain(self.values)

    def value_place(self, path: Path) -> Place:  # noqa: ARG002  (one key or none)
        """Return the name alone."""
        return Place(source=self.name, line=0, text="", start=0, end=0)


def from_file(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Layers:
    """Return the layers of a scenario file: the files that it extends, itself, the overrides."""
    return _layered(*_chain(FilePath(path), os.path.normpath(path)), overrides)


def from_text(text: str, name: str, overrides: Sequence[str] = ()) -> Layers:
    """Return the layers of a text, which cannot extend a file, since it is in no folder."""
    source = Source(name, text)
    refused = _not_extended(source, "a text has no folder to look in; load the file instead")
    return _layered([source], refused if "extends" in source.data else [], overrides)


def from_text_over(values: Mapping[str, Any], text: str, name: str, overrides: Sequence[str] = ()) -> Layers:
    """Return the layers of a text on top of values, which replace the file that it extends."""
    return _layered([Values(name, "", values=values), Source(name, text)], [], overrides)


def from_values(values: Mapping[str, Any], name: str) -> Layers:
    """Return the one layer of values given in Python."""
    source = Values(name, "", values=values)
    return Layers(sources=(source,), data=source.data, problems=())


def _layered(files: list[Source], problems: list[Problem], overrides: Sequence[str]) -> Layers:
    # In a report the file that was asked for comes first, then what it extends, then the settings.
    files = [replace(source, rank=len(files) - 1 - n) for n, source in enumerate(files)]
    settings = [_setting(text, len(files) + n) for n, text in enumerate(overrides)]
    sources = (*files, *settings)
    ranks = {source.name: source.rank for source in reversed(sources)}
    problems = [replace(p, place=replace(p.place, rank=ranks[p.place.source])) for p in problems]
    return Layers(
        sources=sources,
        data={key: value for key, value in _merged(source.data for source in sources).items() if key != "extends"},
        problems=(*problems, *(problem for source in sources for problem in source.problems)),
    )


def _setting(text: str, rank: int) -> Setting:
    if isinstance(text, OptionOverride):
        return OptionSetting(text.option, text, rank)
    return Setting(f"{SET} {text.partition('=')[0].strip()}", text, rank)


def _chain(path: FilePath, name: str) -> tuple[list[Source], list[Problem]]:
    """Return a file's sources, the most basic first, and the problems of how they extend one another."""
    sources, seen = [Source(name, _text_of_file(path, name))], [os.path.realpath(path)]
    while isinstance(base := sources[0].data.get("extends"), str):
        path = _extended(path.parent, base)
        try:
            text, identity = _text_of_file(path, base), os.path.realpath(path)
        except ScenarioRefused as refusal:
            return sources, _not_extended(sources[0], str(refusal))
        if identity in seen:
            return sources, _not_extended(sources[0], "extends a file that extends this one")
        if sum(len(source.text.encode()) for source in (*sources, Source(base, text))) > limits.CHAIN_BYTES:
            return sources, _not_extended(
                sources[0], f"with it more than {limits.CHAIN_BYTES // 1024} kB extend one another"
            )
        if len(sources) > limits.EXTENDS_DEPTH:
            return sources, _not_extended(sources[0], f"more than {limits.EXTENDS_DEPTH} files extend one another")
        sources.insert(0, Source(os.path.normpath(path), text))
        seen.append(identity)
    return sources, _not_extended(sources[0], "needs the name of a file") if "extends" in sources[0].data else []


def _extended(folder: FilePath, base: str) -> FilePath:
    """Return the path of an extended file: relative to the folder, or the name of one that comes with rubnoise."""
    from rubnoise.scenario.shipped import by_name, shipped_names

    beside = folder / base
    return by_name(base) if base in shipped_names() and not os.path.lexists(beside) else beside


def _not_extended(source: Source, message: str) -> list[Problem]:
    return [Problem(path=("extends",), message=message, place=source.value_place(("extends",)))]


def _text_of_file(path: FilePath, name: str) -> str:
    """Return the text of a regular file within the limits; raises ScenarioRefused."""
    try:
        content = read_at_most(path, limits.FILE_BYTES + 1)
    except NotRegular as error:
        raise ScenarioRefused(f"{name}: {error.strerror}") from None
    except OSError as error:
        reason = error.strerror or str(error)
        raise ScenarioRefused(f"{name}: cannot be read: {reason[:1].lower()}{reason[1:]}") from None
    if len(content) > limits.FILE_BYTES:
        raise ScenarioRefused(f"{name}: larger than {limits.FILE_BYTES // 1024} kB")
    return _decoded(content, name)


def _decoded(content: bytes, name: str) -> str:
    try:
        return content.decode("utf-8-sig")  # some editors begin a file with a byte order mark
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ScenarioRefused(f"{name}:{line}: error: not UTF-8 text") from None


def override_value(value: str) -> Any:
    """Return the value of an override, read as TOML if possible, otherwise as a text."""
    try:
        data = tomllib.loads(f"value = {value}")
    except (tomllib.TOMLDecodeError, RecursionError):
        return value.strip()
    return data["value"] if data.keys() == {"value"} else value


def _merged(layers: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for layer in layers:
        _merge(merged, layer)
    return merged


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


def _merge(below: dict[str, Any], above: Mapping[str, Any]) -> None:
    for key, value in above.items():
        if not isinstance(value, Mapping):
            below[key] = value
            continue
        if not isinstance(below.get(key), dict):
            below[key] = {}
        _merge(below[key], value)


def gives(data: Any, path: Path) -> bool:
    """Whether tables hold a key."""
    for part in path:
        if not isinstance(data, dict) or part not in data:
            return False
        data = data[part]
    return True
