"""A sweep: one file for many runs. Each point is a complete scenario, checked, with a seed and a name."""

import json
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from hashlib import sha256
from itertools import islice
from typing import Any

import numpy as np

from rubnoise.errors import Refused, ScenarioRefused
from rubnoise.figure_names import QUANTITIES
from rubnoise.scenario import layers
from rubnoise.scenario.document import SECTIONS, SWEEP, Keep, Sweeping
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.keys import ZIP
from rubnoise.scenario.reading import ReadSizes, examined, load
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.sweep_table import choices, read_table
from rubnoise.scenario.text import Layers, Problem, in_order, report
from rubnoise.tables import fields_as_text

_ID_DIGITS = 16
_NOT_THE_CONTACT = ("title", "output", "run")
"""What a scenario says about writing and running: a point keeps its seed when only this changes."""
_NOT_THE_FIELD = ("coupling", "cells")
"""Keys of the slider that change only when each distance is reached: points that differ in them alone share seeds."""
_NOT_THE_SIZES = ("file", "column", "hash")
"""Where diameters were read: their values are all that counts."""


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
    return sha256(canonical({**resolved, "run": run}, without=("title",))).hexdigest()[:_ID_DIGITS]


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


_NUMBERS = re.compile(r"[0-9][0-9.,e+-]*")
_SHOWN_CHARACTERS = 40


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
    return ", ".join(f"{key} = {str(value)[:_SHOWN_CHARACTERS]}" for key, value in values.items())


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

    def __repr__(self) -> str:
        return fields_as_text(self)


_ENGINE_OF_SWEEPS = "batch"
"""Many runs are made by the faster engine if the file names none; it gives the same bits."""


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


def loads_sweep(
    text: str, name: str = "<string>", overrides: Sequence[str] = (), read: ReadSizes | None = None
) -> Sweep:
    """Return the sweep of a TOML text, which cannot extend a file; raises ScenarioRefused."""
    return _checked(layers.from_text(text, name, overrides), read)


def load_either(
    path: str | os.PathLike[str], overrides: Sequence[str] = (), read: ReadSizes | None = None
) -> Scenario | Sweep:
    """Return the scenario or the sweep of a TOML file, whichever it is; raises ScenarioRefused as `load` does."""
    given = layers.from_file(path, overrides)
    return _checked(given, read) if SWEEP in given.data else load(path, overrides, read)


def _checked(given: Layers, read: ReadSizes | None) -> Sweep:
    if SWEEP not in given.data:
        ways = "rubnoise run makes this one run, and in Python grid={...} makes it many"
        alone = f"{given.name}: no sweep: it has no table [sweep]; {ways}"
        raise ScenarioRefused(report(given.problems) or alone)
    settings, axes, wrong = read_table(given)
    given = layers.filled(given, {"run": {"engine": _ENGINE_OF_SWEEPS}})
    one, read = layers.without(given, (SWEEP,)), read and cache(read)  # a file is read once, not at every point
    # Each value is shown where its list is.
    origins = {axis.path: given.origin(axis.swept_path) for axis in axes}
    points: list[Examined] = []
    for values in islice(choices(axes), _LOOKED_AT_BESIDE_A_WRONG_TABLE if wrong else None):
        data: dict[str, Any] = {}
        for axis, value in zip(axes, values, strict=True):
            data.setdefault(axis.path[0], {})[axis.path[1]] = value
        point = layers.laid(one, Layers(name=given.name, data=data, origins=origins))
        points.append(({axis.key: value for axis, value in zip(axes, values, strict=True)}, *examined(point, read)))
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
