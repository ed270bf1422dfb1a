"""The `[sweep]` table: which keys take which values, and what is wrong with it before any point is looked at."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from math import prod
from typing import Any

from rubnoise.scenario import limits
from rubnoise.scenario.fields import did_you_mean
from rubnoise.scenario.keys import SECTIONS, SWEEP
from rubnoise.scenario.layers import Layers, Setting
from rubnoise.scenario.problems import Path, Place, Problem
from rubnoise.scenario.sweep_settings import Settings, Sweeping, read_settings

GRID, ZIP = "grid", "zip"
TOP_KEYS = (*Sweeping.model_fields, GRID, ZIP)
NOT_SWEPT: dict[Path, str] = {
    ("run", "seed"): "seeds follow from run.seed, the point and the replicate; replicates = 4 makes four of each",
}
"""Keys that no sweep varies, and why."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One swept key: its path in a scenario, the table it is swept in, and its values as written."""

    path: Path
    table: str
    values: tuple[Any, ...]

    @property
    def key(self) -> str:
        """The key as written in TOML, with dots."""
        return ".".join(map(str, self.path))

    @property
    def swept_path(self) -> Path:
        """Where the list of values stands in the file."""
        return (SWEEP, self.table, *self.path)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A `[sweep]` table that is right as far as it goes: the axes of grid and zip in the order written."""

    grid: tuple[Axis, ...] = ()
    side_by_side: tuple[Axis, ...] = ()
    settings: Settings = field(default_factory=Settings)

    @property
    def axes(self) -> tuple[Axis, ...]:
        """All axes."""
        return (*self.grid, *self.side_by_side)

    @property
    def point_count(self) -> int:
        """The number of points, without replicates."""
        return self._rows * prod(len(axis.values) for axis in self.grid)

    @property
    def _rows(self) -> int:
        return min((len(axis.values) for axis in self.side_by_side), default=1)

    def choices(self) -> Iterator[tuple[int, ...]]:
        """Yield for every point which value of each axis it takes; the last key varies fastest."""
        for *firsts, row in product(*(range(len(axis.values)) for axis in self.grid), range(self._rows)):
            yield (*firsts, *(row for _ in self.side_by_side))


def read_table(layers: Layers) -> tuple[Table, list[Problem]]:
    """Return the sweep of a scenario's layers, as much of it as is right, and everything that is wrong with it."""
    table = layers.data[SWEEP]
    if not isinstance(table, dict):
        return Table(), [_at(layers, (SWEEP,), "needs a table", "a line [sweep] with its keys below")]
    problems = [_unknown(layers, name) for name in table if name not in TOP_KEYS]
    settings, wrong = read_settings(layers, table)
    problems += wrong
    axes: dict[str, tuple[Axis, ...]] = {}
    for name in (GRID, ZIP):
        found = list(_keys(layers, name, table.get(name, {})))
        problems += [each for each in found if isinstance(each, Problem)]
        axes[name] = _as_written(layers, [each for each in found if isinstance(each, Axis)])
    read = Table(grid=axes[GRID], side_by_side=axes[ZIP], settings=settings)
    problems += [*_lengths(layers, read), *_doubles(layers, read), *_overruled(layers, read)]
    return read, problems or list(_excess(layers, read))


def _at(layers: Layers, path: Path, message: str, hint: str = "", place: Place | None = None) -> Problem:
    return Problem(path=path, message=message, place=place or layers.value_place(path), hint=hint)


def _unknown(layers: Layers, name: str) -> Problem:
    path = (SWEEP, name)
    homes = [f"{SWEEP}.{GRID}.{key}" for key in known_keys() if name in key.split(".")]
    hint = f"did you mean {' or '.join(homes[:2])}?" if homes else did_you_mean(name, TOP_KEYS)
    return _at(layers, path, "unknown key", hint or f"known here: {', '.join(TOP_KEYS)}", layers.key_place(path))


def known_keys() -> tuple[str, ...]:
    """Return every key that may be swept, with dots."""
    paths = ((name, key) for name, section in SECTIONS.items() for key in section.model_fields)
    return tuple(".".join(path) for path in paths if path not in NOT_SWEPT)


def _keys(layers: Layers, name: str, table: Any) -> Iterator[Axis | Problem]:
    """Yield an axis or a problem for every key of `[sweep.grid]` or `[sweep.zip]`."""
    if not isinstance(table, Mapping):
        yield _at(layers, (SWEEP, name), "needs a table of keys", f"a line [{SWEEP}.{name}] with keys below")
        return
    for section, below in table.items():
        inner = below if isinstance(below, Mapping) and section in SECTIONS else {None: below}
        for key, values in inner.items():
            yield _axis(layers, name, (section,) if key is None else (section, key), values)


def _axis(layers: Layers, name: str, path: Path, values: Any) -> Axis | Problem:
    place = (SWEEP, name, *path)
    key = ".".join(map(str, path))
    if path in NOT_SWEPT:
        return _at(layers, place, "is not swept", NOT_SWEPT[path], layers.key_place(place))
    if len(path) == 1 or path[1] not in SECTIONS[str(path[0])].model_fields:
        return _at(layers, place, "unknown key", _suggestion(key), layers.key_place(place))
    if not isinstance(values, list):
        return _at(layers, place, "needs a list of values", f"a list in brackets: {key} = [..., ...]")
    if not values:
        return _at(layers, place, "an empty list, which leaves no point", "give it values, or take the line away")
    return Axis(path=path, table=name, values=tuple(values))


def _suggestion(key: str) -> str:
    if key in known_keys():
        return f"write {key} without quotation marks: a dotted key stands for its table"
    named = [known for known in known_keys() if key in known.split(".")]
    nearest = f"did you mean {' or '.join(named[:2])}?" if named else did_you_mean(key, known_keys())
    return nearest or "a key of a scenario with its table, such as interface.mean_junction_count"


def _as_written(layers: Layers, axes: list[Axis]) -> tuple[Axis, ...]:
    """Return axes in the order of the text, which a dotted key that comes back to a table would upset.

    A key that a base file names keeps its place when its values are changed.
    """

    def position(axis: Axis) -> tuple[int, int, int]:
        source = layers.origin_of(axis.swept_path)
        place = source.key_place(axis.swept_path)
        return layers.sources.index(source), place.line, place.start

    return tuple(sorted(axes, key=position))


def _lengths(layers: Layers, table: Table) -> Iterator[Problem]:
    for axis in table.side_by_side[1:]:
        first = table.side_by_side[0]
        if len(axis.values) != len(first.values):
            message = f"{len(axis.values)} values beside the {len(first.values)} of {first.key}"
            yield _at(layers, axis.swept_path, message, "lists of [sweep.zip] go in parallel and need equal length")


def _doubles(layers: Layers, table: Table) -> Iterator[Problem]:
    gridded = {axis.path for axis in table.grid}
    for axis in table.side_by_side:
        if axis.path in gridded:
            message = "swept in [sweep.grid] and in [sweep.zip]"
            yield _at(layers, axis.swept_path, message, "keep one of the two", layers.key_place(axis.swept_path))


def _overruled(layers: Layers, table: Table) -> Iterator[Problem]:
    """Refuse a `--set` of a key that the sweep sets anew at every point."""
    for axis in table.axes:
        source = layers.source_of(axis.path)
        if isinstance(source, Setting) and _given(source.data, axis.path):
            hint = f'to change its values: --set "{".".join(map(str, axis.swept_path))}=[...]"'
            yield _at(layers, axis.path, "the sweep gives it a value at every point", hint, source.key_place(axis.path))


def _given(data: Any, path: Path) -> bool:
    return str(path[0]) in data and isinstance(data[path[0]], dict) and path[1] in data[path[0]]


def _excess(layers: Layers, table: Table) -> Iterator[Problem]:
    points, runs = table.point_count, table.point_count * table.settings.most_replicates
    if points > limits.SWEEP_POINTS or runs > limits.SWEEP_RUNS:
        message = (
            f"too many: {points:,} points, {runs:,} runs with replicates; "
            f"at most {limits.SWEEP_POINTS:,} points and {limits.SWEEP_RUNS:,} runs"
        )
        fewer = "fewer values or replicates" if table.settings.precision is None else "fewer values or most_replicates"
        hint = f"{fewer}, or several sweeps"
        yield _at(layers, (SWEEP,), message, hint, layers.key_place((SWEEP,)))
