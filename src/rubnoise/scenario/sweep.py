"""A sweep: one file for many runs. Each point is a complete scenario, checked, with a seed and a name."""

import json
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from hashlib import sha256
from itertools import chain, islice, product
from math import prod
from typing import Any, Final, NamedTuple

import numpy as np

from rubnoise.errors import Refused, ScenarioRefused, did_you_mean
from rubnoise.figure_names import QUANTITIES
from rubnoise.scenario import keys, layers
from rubnoise.scenario.document import FEWEST, SECTIONS, SWEEP, SWEEP_RUNS, Keep, Sweeping
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.keys import GRID, ZIP
from rubnoise.scenario.reading import ReadSizes, checked, examined
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.text import Layers, Path, Problem, in_order, report
from rubnoise.tables import fields_as_text

_NOT_THE_CONTACT = ("title", "output", "run")
"""What a scenario says about writing and running: a point keeps its seed when only this changes."""
_NOT_THE_FIELD = ("coupling", "cells")
"""Keys of the slider that change only when each distance is reached: points that differ in them alone share seeds."""
_NOT_THE_SIZES = ("file", "column", "hash")  # where diameters were read: their values are all that counts


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """The values of the swept keys at one point, as written, and the whole scenario there."""

    values: Mapping[str, Any]
    scenario: Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Point(Case):
    """One run of a sweep: a case with the number of its replicate (from 0), its name, and its seed in the scenario."""

    replicate: int
    run_id: str
    seed: int


def points_of(cases: Iterable[Case], replicates: int, first: int = 0) -> tuple[Point, ...]:
    """Return the runs of every case from replicate ``first`` on, the replicates of a case one after another.

    The seed of a replicate is 53 bits from the seed in the scenario and the physics of the scenario. It does not depend
    on the order of points, on the other swept values, on output and title, or on the coupling: one-way and two-way
    sliders meet the same junctions. From numpy's SeedSequence, whose numbers are the same in every version (O'Neill's
    seed_seq_fe).
    """
    found = []
    for case in cases:
        scenario, resolved = case.scenario, case.scenario.resolved()
        slider = {key: value for key, value in resolved.get("slider", {}).items() if key not in _NOT_THE_FIELD}
        digest = sha256(canonical({**resolved, "slider": slider}, without=_NOT_THE_CONTACT)).digest()
        words = np.frombuffer(digest, ">u4").tolist()
        for replicate in range(first, replicates):
            sequence = np.random.SeedSequence(scenario.run.seed, spawn_key=(*words, replicate))
            seed = int(sequence.generate_state(1, np.uint64)[0]) >> 11
            seeded = replace(scenario, run=replace(scenario.run, seed=seed))
            name = name_of(resolved, seed)
            found.append(Point(values=case.values, replicate=replicate, run_id=name, seed=seed, scenario=seeded))
    return tuple(found)


def run_id(scenario: Scenario) -> str:
    """Return the name of a run, 16 hexadecimal digits of the SHA-256 of its scenario with the seed."""
    return name_of(scenario.resolved(), scenario.run.seed)


def name_of(resolved: Mapping[str, Any], seed: int) -> str:
    """Return the name of a resolved scenario's run with a seed. Neither its title nor its engine changes the name."""
    run = resolved["run"] | {"seed": seed, "engine": keys_of(SECTIONS["run"])["engine"].default}
    return sha256(canonical({**resolved, "run": run}, without=("title",))).hexdigest()[:16]


def canonical(resolved: Mapping[str, Any], without: Collection[str]) -> bytes:
    """Return the canonical JSON text of a resolved scenario: keys sorted, defaults left out, in working units.

    Defaults are left out so that a key of a later version, with its default, changes no name and no seed. A calibration
    is left out if it is exact, the first default, or does what exact does: matched, for equal diameters.
    """
    left_out = ("exact", "matched") if resolved["diameter"]["law"] == "fixed" else ("exact",)
    kept = {name: value for name, value in resolved.items() if name not in without}
    for name, value in kept.items():
        if isinstance(value, dict):
            known: dict[str, tuple[Any, ...]] = {
                key: (about.default,) for key, about in keys_of(SECTIONS[name]).items()
            }
            known |= {"calibration": left_out} | {key: (value.get(key),) for key in _NOT_THE_SIZES}
            kept[name] = {key: each for key, each in value.items() if each not in known[key]}
    kept = {name: value for name, value in kept.items() if value != {}}
    return json.dumps(kept, sort_keys=True, separators=(",", ":"), ensure_ascii=True).encode()


SWEEP_POINTS: Final = 10_000  # a point takes a millisecond to check, and all are checked before the first runs

SWEPT: Final = tuple(f"{name}.{key}" for name in SECTIONS for key in keys.KNOWN[name] if (name, key) != ("run", "seed"))
"""Every key that may be swept, with dots: all of a scenario but the seed."""


class _Axis(NamedTuple):
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


def _table(given: Layers) -> tuple[Sweeping, list[_Axis], list[Problem]]:
    """Return what is valid of the sweep in a file, and all its problems.

    Axes are those of the grid first, in the order written: a key of a base file keeps its place.
    """
    table = given.data[SWEEP]
    if not isinstance(table, dict):
        return Sweeping(), [], [given.problem((SWEEP,), "needs a table", "a line [sweep] with its keys below")]
    values, problems = keys.values_of(keys_of(Sweeping), given, (SWEEP,))
    settings = Sweeping(**values)
    if settings.precision is not None and "replicates" not in table:
        settings = replace(settings, replicates=FEWEST)
    problems += () if problems else _at_odds(given, settings)
    problems += [keys.unknown(given, (SWEEP, name)) for name in table if name not in keys.KNOWN[SWEEP]]
    axes: list[_Axis] = []
    order = list(given.origins)
    for name in (GRID, ZIP):
        if not isinstance(table.get(name, {}), Mapping):
            hint = f"a line [{SWEEP}.{name}] with keys below"
            problems.append(given.problem((SWEEP, name), "needs a table of keys", hint))
            continue
        for axis in sorted(_axes(name, table.get(name, {})), key=lambda axis: order.index(axis.swept_path)):
            refused = _refused(given, axis)
            problems += [refused] if refused else []
            axes += [] if refused else [axis]
    problems += _axes_at_odds(given, axes)
    return settings, axes, problems or list(_excess(given, settings, axes))


def _choices(axes: list[_Axis]) -> Iterator[tuple[Any, ...]]:
    """Yield the value of each axis at every point; the last key varies fastest, and values of zip go in parallel."""
    grid = [[(value,) for value in axis.values] for axis in axes if axis.table == GRID]
    rows = list(zip(*(axis.values for axis in axes if axis.table == ZIP), strict=False)) or [()]
    yield from (tuple(chain.from_iterable(picked)) for picked in product(*grid, rows))


def _at_odds(given: Layers, settings: Sweeping) -> Iterator[Problem]:
    if settings.precision is None:
        said = [key for key in ("quantity", "most_replicates") if key in given.table(SWEEP)]
        yield from (given.problem((SWEEP, key), "needs a precision", "add precision = 0.01") for key in said)
        return
    if settings.replicates < FEWEST:
        hint = f"replicates = {FEWEST}, or leave it out"
        yield given.problem((SWEEP, "replicates"), "too few to estimate the precision", hint)
    if settings.replicates > settings.most_replicates:
        hint = f"most_replicates = {settings.replicates} or more"
        yield given.problem((SWEEP, "most_replicates"), "fewer than the replicates to begin with", hint)


def _axes(name: str, table: Mapping[str, Any]) -> Iterator[_Axis]:
    """Yield every key of `[sweep.grid]` or `[sweep.zip]`, known or not."""
    for section, below in table.items():
        if isinstance(below, Mapping) and section in SECTIONS:
            yield from (_Axis((section, key), name, values) for key, values in below.items())
        else:
            yield _Axis((section,), name, below)


def _refused(given: Layers, axis: _Axis) -> Problem | None:
    """Return why a key with such values is not swept, if it is not."""
    path, place = axis.swept_path, given.key_place(axis.swept_path)
    if axis.path == ("run", "seed"):
        hint = "seeds follow from run.seed, the point and the replicate; replicates = 4 makes four of each"
        return given.problem(path, "is not swept", hint, place=place)
    if len(axis.path) == 1 or axis.key not in SWEPT:
        return given.problem(path, "unknown key", _suggestion(axis.key), place=place)
    if not isinstance(axis.values, list):
        return given.problem(path, "needs a list of values", f"a list in brackets: {axis.key} = [..., ...]")
    if not axis.values:
        return given.problem(path, "an empty list, which leaves no point", "give it values, or take the line away")
    return None


def _suggestion(key: str) -> str:
    named = [known for known in SWEPT if key in known.split(".")]
    if key in SWEPT:
        return f"write {key} without quotation marks: a dotted key stands for its table"
    usual = "a key of a scenario with its table, such as interface.mean_junction_count"
    return did_you_mean(key, SWEPT, named[:2]) or usual


def _axes_at_odds(given: Layers, axes: list[_Axis]) -> Iterator[Problem]:
    """Refuse unequal lists in parallel, keys swept twice, and a `--set` of a key that the sweep sets at every point."""
    first: _Axis | None = None
    for axis in axes:
        if axis.table == ZIP:
            first = first or axis
            if len(axis.values) != len(first.values):
                message = f"{len(axis.values)} values beside the {len(first.values)} of {first.key}"
                hint = "lists of [sweep.zip] go in parallel and need equal length"
                yield given.problem(axis.swept_path, message, hint)
            if any(other.path == axis.path and other.table == GRID for other in axes):
                message, place = "swept in [sweep.grid] and in [sweep.zip]", given.key_place(axis.swept_path)
                yield given.problem(axis.swept_path, message, "keep one of the two", place=place)
        origin = given.origins.get(axis.path)
        if origin and origin.kind == "setting":
            hint = f'to change its values: --set "{".".join(axis.swept_path)}=[...]"'
            yield given.problem(axis.path, "the sweep gives it a value at every point", hint, place=origin.key)


def _excess(given: Layers, settings: Sweeping, axes: list[_Axis]) -> Iterator[Problem]:
    together = min((len(axis.values) for axis in axes if axis.table == ZIP), default=1)
    points = together * prod(len(axis.values) for axis in axes if axis.table == GRID)
    runs = points * settings.largest
    if points > SWEEP_POINTS or runs > SWEEP_RUNS:
        message = f"too many: {points:,} points, {runs:,} runs with replicates; "
        message += f"at most {SWEEP_POINTS:,} points and {SWEEP_RUNS:,} runs"
        fewer = "fewer values or replicates" if settings.precision is None else "fewer values or most_replicates"
        yield given.problem((SWEEP,), message, f"{fewer}, or several sweeps", place=given.key_place((SWEEP,)))


_NUMBERS = re.compile(r"[0-9][0-9.,e+-]*")


Examined = tuple[Mapping[str, Any], Scenario | None, Sequence[Problem]]
"""A checked point: its swept values, its scenario if it has one, and its problems."""


def gathered(points: Sequence[Examined]) -> Iterator[Problem]:
    """Yield the problems of all points; problems that differ only in numbers are joined.

    A problem of every point, or of every point with a certain value, is reported as for a single scenario; any other
    problem names the first point that has it and counts the others.
    """
    alike: dict[tuple[object, ...], list[tuple[Problem, Mapping[str, Any]]]] = {}
    for values, _, problems in points:
        for problem in dict.fromkeys(problems):
            kind = _NUMBERS.sub("#", problem.message)
            alike.setdefault((problem.path, problem.place, problem.severity, kind), []).append((problem, values))
    for found in alike.values():
        problem, first = found[0]
        everywhere = sum(values.get(problem.key) == first.get(problem.key) for values, _, _ in points)
        if len(found) == everywhere and all(other.message == problem.message for other, _ in found):
            yield problem
        else:
            more = len(found) - 1
            others = f", and at {more:,} more point{'s' if more > 1 else ''}" if more else ""
            yield replace(problem, message=f"{problem.message}, at {in_words(first)}{others}")


def in_words(values: Mapping[str, Any]) -> str:
    """Return swept values in printed form: `interface.mean_junction_count = 20, ...`."""
    return ", ".join(f"{key} = {str(value)[:40]}" for key, value in values.items())


_LOOKED_AT_BESIDE_A_WRONG_TABLE = 100


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Sweep:
    """A file with a `[sweep]` table: its points, each a complete scenario, and the number of runs of each.

    ``keys`` are the swept keys with dots, ``side_by_side`` those of them in `[sweep.zip]`, ``warnings`` are texts about
    doubtful values. ``keep`` says what is kept of a run; with settings of a ``precision`` each point gets as many more
    replicates as it needs.
    """

    name: str
    text: str = field(repr=False)
    title: str
    keys: tuple[str, ...]
    side_by_side: tuple[str, ...]
    cases: tuple[Case, ...]
    replicates: int
    warnings: tuple[str, ...]
    keep: Keep = "runs"
    precision: Sweeping | None = None

    __repr__ = fields_as_text


def expand(sweep: Sweep) -> tuple[Point, ...]:
    """Return every run of a sweep: its points in the order written, the replicates of each one after another.

    >>> import rubnoise
    >>> first = rubnoise.expand(rubnoise.load_sweep("paper/fig9"))[0]
    >>> first.values, first.replicate
    ({'interface.mean_junction_count': 10}, 0)
    """
    if not isinstance(sweep, Sweep):
        raise Refused("expand: a Sweep is needed, as rubnoise.load_sweep reads it; a scenario is one run")
    return points_of(sweep.cases, sweep.replicates)


def load_sweep(path: str | os.PathLike[str], overrides: Sequence[str] = (), read: ReadSizes | None = None) -> Sweep:
    """Return the sweep of a TOML file, with overrides of the form `KEY=VALUE` on top; ``read`` is as for `load`.

    Raises ScenarioRefused with every problem of every point, each with its line, and for a file that is no sweep.
    """
    return _checked(layers.from_file(path, overrides), read)


def loads_sweep(text: str, name: str = "<string>", read: ReadSizes | None = None) -> Sweep:
    """Return the sweep of a TOML text, which cannot extend a file; raises ScenarioRefused."""
    return _checked(layers.from_text(text, name), read)


def load_either(
    path: str | os.PathLike[str], overrides: Sequence[str] = (), read: ReadSizes | None = None
) -> Scenario | Sweep:
    """Return the scenario or the sweep of a TOML file, whichever it is; raises ScenarioRefused as `load` does."""
    given = layers.from_file(path, overrides)
    return _checked(given, read) if SWEEP in given.data else checked(given, read)


def _checked(given: Layers, read: ReadSizes | None) -> Sweep:
    if SWEEP not in given.data:
        ways = "rubnoise run makes this one run, and in Python grid={...} makes it many"
        alone = f"{given.name}: no sweep: it has no table [sweep]; {ways}"
        raise ScenarioRefused(report(given.problems) or alone)
    settings, axes, wrong = _table(given)
    # Many runs are made by the faster engine if the file names none; it gives the same bits.
    given = layers.filled(given, {"run": {"engine": "batch"}})
    one, read = layers.without(given, (SWEEP,)), read and cache(read)  # a file is read once, not at every point
    # Each value is shown where its list is.
    origins = {axis.path: given.origin(axis.swept_path) for axis in axes}
    points: list[Examined] = []
    for values in islice(_choices(axes), _LOOKED_AT_BESIDE_A_WRONG_TABLE if wrong else None):
        data: dict[str, Any] = {axis.path[0]: {} for axis in axes}
        for axis, value in zip(axes, values, strict=True):
            data[axis.path[0]][axis.path[1]] = value
        point = layers.laid(one, Layers(name=given.name, data=data, origins=origins))
        points.append((dict(zip((axis.key for axis in axes), values, strict=True)), *examined(point, read)))
    # What is missing may be meant by a key of the sweep that is not right yet.
    found = [problem for problem in gathered(points) if not (wrong and problem.is_missing)]
    problems = [*given.problems, *wrong, *found]
    cases = [Case(values=values, scenario=scenario) for values, scenario, _ in points if scenario is not None]
    if not wrong and len(cases) == len(points):
        problems += [*_repeated(given, cases), *_without_quantity(given, settings, cases)]
    if any(problem.severity == "error" for problem in problems):
        raise ScenarioRefused(report(problems))
    return Sweep(
        name=given.name,
        text=given.text,
        title=cases[0].scenario.title,
        keys=tuple(axis.key for axis in axes),
        side_by_side=tuple(axis.key for axis in axes if axis.table == ZIP),
        cases=tuple(cases),
        replicates=settings.replicates,
        keep=settings.keep,
        precision=None if settings.precision is None else settings,
        warnings=tuple(map(str, in_order(problems))),
    )


def _repeated(given: Layers, cases: Sequence[Case]) -> Iterator[Problem]:
    """Refuse points that are the same run, since their results would count twice."""
    first: dict[str, int] = {}
    for number, case in enumerate(cases, 1):
        before = first.setdefault(run_id(case.scenario), number)
        if before != number:
            message = f"points {before} and {number} are the same run ({in_words(case.values)})"
            hint = "take one away; replicates = 2 makes two runs of each point, with seeds of their own"
            yield given.problem((SWEEP,), message, hint, place=given.key_place((SWEEP,)))
            return


def _without_quantity(given: Layers, settings: Sweeping, cases: Sequence[Case]) -> Iterator[Problem]:
    if settings.precision is None:
        return
    name, about = settings.quantity, QUANTITIES[settings.quantity]
    if about.needs and any(getattr(case.scenario, about.needs) is None for case in cases):
        message = f"{name} is no quantity of a run without [{about.needs}]"
        yield given.problem((SWEEP, "quantity"), message, f"a table [{about.needs}]")
    if about.one_way and any(case.scenario.physics.is_two_way for case in cases):
        message = f"{name} is no quantity of a run with two-way coupling"
        yield given.problem((SWEEP, "quantity"), message, "velocity_std is one")
