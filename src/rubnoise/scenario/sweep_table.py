"""The `[sweep]` table: the swept keys and their values, the number of runs of each point, and their precision."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from math import prod
from typing import Any, Final

from rubnoise.scenario import keys
from rubnoise.scenario.document import SECTIONS
from rubnoise.scenario.fields import did_you_mean, keys_of
from rubnoise.scenario.keys import GRID, ZIP
from rubnoise.scenario.layers import Layers, gives
from rubnoise.scenario.sweep_keys import FEWEST, SWEEP, SWEEP_RUNS, Sweeping
from rubnoise.scenario.text import Path, Problem

SWEEP_POINTS: Final = 10_000
"""A point takes a millisecond to check, and all are checked before the first runs."""

_ONLY_WITH_PRECISION: Final = ("quantity", "most_replicates")


def _at_odds(layers: Layers, table: Mapping[str, Any], settings: Sweeping) -> Iterator[Problem]:
    if settings.precision is None:
        for key in _ONLY_WITH_PRECISION:
            if key in table:
                yield layers.problem((SWEEP, key), "needs a precision", "add precision = 0.01")
        return
    if settings.replicates < FEWEST:
        hint = f"replicates = {FEWEST}, or leave it out"
        yield layers.problem((SWEEP, "replicates"), "too few to estimate the precision", hint)
    if settings.replicates > settings.most_replicates:
        hint = f"most_replicates = {settings.replicates} or more"
        yield layers.problem((SWEEP, "most_replicates"), "fewer than the replicates to begin with", hint)


_SEED: Final = ("run", "seed")  # the one key that no sweep varies


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
        """The place of the list of values in the file."""
        return (SWEEP, self.table, *self.path)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """The valid part of a `[sweep]` table: its axes, those of grid first, in the order written; and its settings."""

    axes: tuple[Axis, ...] = ()
    settings: Sweeping = field(default_factory=Sweeping)

    @property
    def side_by_side(self) -> tuple[Axis, ...]:
        """The axes whose values go in parallel."""
        return tuple(axis for axis in self.axes if axis.table == ZIP)

    @property
    def lengths(self) -> list[int]:
        """The number of values of each axis of the grid, and that of the values in parallel."""
        together = min((len(axis.values) for axis in self.side_by_side), default=1)
        return [*(len(axis.values) for axis in self.axes if axis.table == GRID), together]

    def choices(self) -> Iterator[tuple[int, ...]]:
        """Yield for every point the number of its value on each axis; the last key varies fastest."""
        for *firsts, row in product(*map(range, self.lengths)):
            yield (*firsts, *(row for _ in self.side_by_side))


def read_table(layers: Layers) -> tuple[Table, list[Problem]]:
    """Return the valid part of the sweep in a scenario's layers, and all its problems."""
    table = layers.data[SWEEP]
    if not isinstance(table, dict):
        return Table(), [layers.problem((SWEEP,), "needs a table", "a line [sweep] with its keys below")]
    wrong: list[Problem] = []
    settings = Sweeping(**keys.values_of(keys_of(Sweeping), layers, (SWEEP,), table, wrong))
    if settings.precision is not None and "replicates" not in table:
        settings = replace(settings, replicates=FEWEST)
    problems = [*wrong, *(_at_odds(layers, table, settings) if not wrong else ())]
    problems += [keys.unknown(layers, (SWEEP, name)) for name in table if name not in keys.KNOWN[SWEEP]]
    axes: list[Axis] = []
    for name in (GRID, ZIP):
        found = list(_keys(layers, name, table.get(name, {})))
        problems += [each for each in found if isinstance(each, Problem)]
        swept = [each for each in found if isinstance(each, Axis)]
        axes += sorted(swept, key=lambda axis: _position(layers, axis.swept_path))
    read = Table(axes=tuple(axes), settings=settings)
    problems += _axes_at_odds(layers, read)
    return read, problems or list(_excess(layers, read))


def known_keys() -> tuple[str, ...]:
    """Return every key that may be swept, with dots."""
    return tuple(f"{name}.{key}" for name in SECTIONS for key in keys.KNOWN[name] if (name, key) != _SEED)


def _keys(layers: Layers, name: str, table: Any) -> Iterator[Axis | Problem]:
    """Yield an axis or a problem for every key of `[sweep.grid]` or `[sweep.zip]`."""
    if not isinstance(table, Mapping):
        yield layers.problem((SWEEP, name), "needs a table of keys", f"a line [{SWEEP}.{name}] with keys below")
        return
    for section, below in table.items():
        inner = below if isinstance(below, Mapping) and section in SECTIONS else {None: below}
        for swept, values in inner.items():
            yield _axis(layers, name, (section,) if swept is None else (section, swept), values)


def _axis(layers: Layers, name: str, path: Path, values: Any) -> Axis | Problem:
    place = (SWEEP, name, *path)
    key = ".".join(map(str, path))
    if path == _SEED:
        hint = "seeds follow from run.seed, the point and the replicate; replicates = 4 makes four of each"
        return layers.problem(place, "is not swept", hint, place=layers.key_place(place))
    if len(path) == 1 or path[1] not in keys.KNOWN[str(path[0])]:
        return layers.problem(place, "unknown key", _suggestion(key), place=layers.key_place(place))
    if not isinstance(values, list):
        return layers.problem(place, "needs a list of values", f"a list in brackets: {key} = [..., ...]")
    if not values:
        return layers.problem(place, "an empty list, which leaves no point", "give it values, or take the line away")
    return Axis(path=path, table=name, values=tuple(values))


def _suggestion(key: str) -> str:
    if key in known_keys():
        return f"write {key} without quotation marks: a dotted key stands for its table"
    named = [known for known in known_keys() if key in known.split(".")]
    nearest = f"did you mean {' or '.join(named[:2])}?" if named else did_you_mean(key, known_keys())
    return nearest or "a key of a scenario with its table, such as interface.mean_junction_count"


def _position(layers: Layers, path: Path) -> tuple[int, int, int]:
    """Return where a key is first named: data have another order if a dotted key comes back to a table.

    So a key that a base file names keeps its place when its values are changed.
    """
    rank, source = next((rank, each) for rank, each in enumerate(layers.sources) if gives(each.data, path))
    place = source.key_place(path)
    return rank, place.line, place.start


def _axes_at_odds(layers: Layers, table: Table) -> Iterator[Problem]:
    """Refuse unequal lists in parallel, keys swept twice, and a `--set` of a key that the sweep sets at every point."""
    gridded = {axis.path for axis in table.axes if axis.table == GRID}
    for axis in table.side_by_side:
        first = table.side_by_side[0]
        if len(axis.values) != len(first.values):
            message = f"{len(axis.values)} values beside the {len(first.values)} of {first.key}"
            yield layers.problem(axis.swept_path, message, "lists of [sweep.zip] go in parallel and need equal length")
        if axis.path in gridded:
            message, place = "swept in [sweep.grid] and in [sweep.zip]", layers.key_place(axis.swept_path)
            yield layers.problem(axis.swept_path, message, "keep one of the two", place=place)
    for axis in table.axes:
        source = layers.source_of(axis.path)
        if source.kind == "setting" and gives(source.data, axis.path):
            hint = f'to change its values: --set "{".".join(map(str, axis.swept_path))}=[...]"'
            place = source.key_place(axis.path)
            yield layers.problem(axis.path, "the sweep gives it a value at every point", hint, place=place)


def _excess(layers: Layers, table: Table) -> Iterator[Problem]:
    points = prod(table.lengths)
    runs = points * table.settings.largest
    if points > SWEEP_POINTS or runs > SWEEP_RUNS:
        message = (
            f"too many: {points:,} points, {runs:,} runs with replicates; "
            f"at most {SWEEP_POINTS:,} points and {SWEEP_RUNS:,} runs"
        )
        fewer = "fewer values or replicates" if table.settings.precision is None else "fewer values or most_replicates"
        hint = f"{fewer}, or several sweeps"
        yield layers.problem((SWEEP,), message, hint, place=layers.key_place((SWEEP,)))
