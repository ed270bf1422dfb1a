"""The `[sweep]` table: the swept keys and their values, the number of runs of each point, and their precision."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain, product
from math import prod
from typing import Any, Final

from rubnoise.scenario import keys
from rubnoise.scenario.document import FEWEST, SECTIONS, SWEEP, SWEEP_RUNS, Sweeping
from rubnoise.scenario.fields import did_you_mean, keys_of
from rubnoise.scenario.keys import GRID, ZIP
from rubnoise.scenario.text import Layers, Path, Problem

SWEEP_POINTS: Final = 10_000
"""A point takes a millisecond to check, and all are checked before the first runs."""

SWEPT: Final = tuple(f"{name}.{key}" for name in SECTIONS for key in keys.KNOWN[name] if (name, key) != ("run", "seed"))
"""Every key that may be swept, with dots: all of a scenario but the seed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One swept key: its path in a scenario, the table it is swept in, and its values as written."""

    path: Path
    table: str
    values: Any

    @property
    def key(self) -> str:
        """The key as written in TOML, with dots."""
        return ".".join(self.path)

    @property
    def swept_path(self) -> Path:
        """The place of the list of values in the file."""
        return (SWEEP, self.table, *self.path)


def read_table(layers: Layers) -> tuple[Sweeping, list[Axis], list[Problem]]:
    """Return what is valid of the sweep in a scenario's layers, and all its problems.

    Axes are those of the grid first, in the order written: a key of a base file keeps its place.
    """
    table = layers.data[SWEEP]
    if not isinstance(table, dict):
        return Sweeping(), [], [layers.problem((SWEEP,), "needs a table", "a line [sweep] with its keys below")]
    problems: list[Problem] = []
    settings = Sweeping(**keys.values_of(keys_of(Sweeping), layers, (SWEEP,), table, problems))
    if settings.precision is not None and "replicates" not in table:
        settings = replace(settings, replicates=FEWEST)
    problems += () if problems else _at_odds(layers, settings)
    problems += [keys.unknown(layers, (SWEEP, name)) for name in table if name not in keys.KNOWN[SWEEP]]
    axes: list[Axis] = []
    order = list(layers.origins)
    for name in (GRID, ZIP):
        if not isinstance(table.get(name, {}), Mapping):
            hint = f"a line [{SWEEP}.{name}] with keys below"
            problems.append(layers.problem((SWEEP, name), "needs a table of keys", hint))
            continue
        for axis in sorted(_axes(name, table.get(name, {})), key=lambda axis: order.index(axis.swept_path)):
            refused = _refused(layers, axis)
            problems += [refused] if refused else []
            axes += [] if refused else [axis]
    problems += _axes_at_odds(layers, axes)
    return settings, axes, problems or list(_excess(layers, settings, axes))


def choices(axes: list[Axis]) -> Iterator[tuple[Any, ...]]:
    """Yield the value of each axis at every point; the last key varies fastest, and values of zip go in parallel."""
    grid = [[(value,) for value in axis.values] for axis in axes if axis.table == GRID]
    rows = list(zip(*(axis.values for axis in axes if axis.table == ZIP), strict=False)) or [()]
    yield from (tuple(chain.from_iterable(picked)) for picked in product(*grid, rows))


def _at_odds(layers: Layers, settings: Sweeping) -> Iterator[Problem]:
    if settings.precision is None:
        given = [key for key in ("quantity", "most_replicates") if key in layers.table(SWEEP)]
        yield from (layers.problem((SWEEP, key), "needs a precision", "add precision = 0.01") for key in given)
        return
    if settings.replicates < FEWEST:
        hint = f"replicates = {FEWEST}, or leave it out"
        yield layers.problem((SWEEP, "replicates"), "too few to estimate the precision", hint)
    if settings.replicates > settings.most_replicates:
        hint = f"most_replicates = {settings.replicates} or more"
        yield layers.problem((SWEEP, "most_replicates"), "fewer than the replicates to begin with", hint)


def _axes(name: str, table: Mapping[str, Any]) -> Iterator[Axis]:
    """Yield every key of `[sweep.grid]` or `[sweep.zip]`, known or not."""
    for section, below in table.items():
        if isinstance(below, Mapping) and section in SECTIONS:
            yield from (Axis(path=(section, key), table=name, values=values) for key, values in below.items())
        else:
            yield Axis(path=(section,), table=name, values=below)


def _refused(layers: Layers, axis: Axis) -> Problem | None:
    """Return why a key with such values is not swept, if it is not."""
    path, place = axis.swept_path, layers.key_place(axis.swept_path)
    if axis.path == ("run", "seed"):
        hint = "seeds follow from run.seed, the point and the replicate; replicates = 4 makes four of each"
        return layers.problem(path, "is not swept", hint, place=place)
    if len(axis.path) == 1 or axis.key not in SWEPT:
        return layers.problem(path, "unknown key", _suggestion(axis.key), place=place)
    if not isinstance(axis.values, list):
        return layers.problem(path, "needs a list of values", f"a list in brackets: {axis.key} = [..., ...]")
    if not axis.values:
        return layers.problem(path, "an empty list, which leaves no point", "give it values, or take the line away")
    return None


def _suggestion(key: str) -> str:
    if key in SWEPT:
        return f"write {key} without quotation marks: a dotted key stands for its table"
    named = [known for known in SWEPT if key in known.split(".")]
    nearest = f"did you mean {' or '.join(named[:2])}?" if named else did_you_mean(key, SWEPT)
    return nearest or "a key of a scenario with its table, such as interface.mean_junction_count"


def _axes_at_odds(layers: Layers, axes: list[Axis]) -> Iterator[Problem]:
    """Refuse unequal lists in parallel, keys swept twice, and a `--set` of a key that the sweep sets at every point."""
    first: Axis | None = None
    for axis in axes:
        if axis.table == ZIP:
            first = first or axis
            if len(axis.values) != len(first.values):
                message = f"{len(axis.values)} values beside the {len(first.values)} of {first.key}"
                hint = "lists of [sweep.zip] go in parallel and need equal length"
                yield layers.problem(axis.swept_path, message, hint)
            if any(other.path == axis.path and other.table == GRID for other in axes):
                message, place = "swept in [sweep.grid] and in [sweep.zip]", layers.key_place(axis.swept_path)
                yield layers.problem(axis.swept_path, message, "keep one of the two", place=place)
        origin = layers.origins.get(axis.path)
        if origin and origin.kind == "setting":
            hint = f'to change its values: --set "{".".join(axis.swept_path)}=[...]"'
            yield layers.problem(axis.path, "the sweep gives it a value at every point", hint, place=origin.key)


def _excess(layers: Layers, settings: Sweeping, axes: list[Axis]) -> Iterator[Problem]:
    together = min((len(axis.values) for axis in axes if axis.table == ZIP), default=1)
    points = together * prod(len(axis.values) for axis in axes if axis.table == GRID)
    runs = points * settings.largest
    if points > SWEEP_POINTS or runs > SWEEP_RUNS:
        message = f"too many: {points:,} points, {runs:,} runs with replicates; "
        message += f"at most {SWEEP_POINTS:,} points and {SWEEP_RUNS:,} runs"
        fewer = "fewer values or replicates" if settings.precision is None else "fewer values or most_replicates"
        yield layers.problem((SWEEP,), message, f"{fewer}, or several sweeps", place=layers.key_place((SWEEP,)))
