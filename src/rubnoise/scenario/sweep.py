"""A sweep: one file for many runs, each checked as a complete scenario."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import islice
from typing import Any

from rubnoise.errors import Refused, ScenarioRefused
from rubnoise.figure_names import QUANTITIES
from rubnoise.scenario import layers
from rubnoise.scenario.keys import SWEEP
from rubnoise.scenario.layers import Layers
from rubnoise.scenario.points import Case, Point, points_of, run_id
from rubnoise.scenario.problems import Path, Place, Problem, in_order, report
from rubnoise.scenario.reading import ReadSizes, examined, load
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.sweep_table import Keep, Precision, Table, read_table
from rubnoise.scenario.text import Source
from rubnoise.tables import fields_as_text

_NUMBERS = re.compile(r"[0-9][0-9.,e+-]*")
_SHOWN_CHARACTERS = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class Examined:
    """A checked point: its swept values, its scenario if it has one, and its problems."""

    values: Mapping[str, Any]
    scenario: Scenario | None
    problems: Sequence[Problem]


def gathered(points: Sequence[Examined]) -> list[Problem]:
    """Return the problems of all points; problems that differ only in numbers are joined.

    A problem of every point, or of every point with a certain value, is reported as for a single scenario; any other
    problem names the first point that has it and counts the others.
    """
    alike: dict[tuple[object, ...], list[tuple[Problem, Examined]]] = {}
    for point in points:
        for problem in dict.fromkeys(point.problems):
            kind = _NUMBERS.sub("#", problem.message)
            alike.setdefault((problem.path, problem.place, problem.severity, kind), []).append((problem, point))
    return [_reported(found, points) for found in alike.values()]


def in_words(values: Mapping[str, Any]) -> str:
    """Return swept values in printed form: `interface.mean_junction_count = 20, ...`."""
    return ", ".join(f"{key} = {str(value)[:_SHOWN_CHARACTERS]}" for key, value in values.items())


def _reported(found: Sequence[tuple[Problem, Examined]], points: Sequence[Examined]) -> Problem:
    problem, first = found[0]
    everywhere = sum(point.values.get(problem.key) == first.values.get(problem.key) for point in points)
    if len(found) == everywhere and all(other.message == problem.message for other, _ in found):
        return problem
    where = in_words(first.values)
    more = len(found) - 1
    others = f", and at {more:,} more point{'s' if more > 1 else ''}" if more else ""
    return replace(problem, message=f"{problem.message}, at {where}{others}")


_LOOKED_AT_BESIDE_A_WRONG_TABLE = 100


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Sweep:
    """A file with a `[sweep]` table: its points, each a complete scenario, and the number of runs of each.

    ``keys`` are the swept keys with dots, ``side_by_side`` those of them in `[sweep.zip]`, ``warnings`` are texts about
    doubtful values. ``keep`` says what is kept of a run; with a ``precision`` each point gets as many more replicates
    as it needs.
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
    precision: Precision | None = None

    def __repr__(self) -> str:
        return fields_as_text(self)


_ENGINE_OF_SWEEPS = "batch"
"""Many runs are made by the faster engine if the file names none; it gives the same bits."""


def point_source(given: Layers, table: Table, indices: tuple[int, ...]) -> tuple[dict[str, Any], Source]:
    """Return the swept values of a point by their dotted keys, and as a source to lay on top of the file.

    Each value is shown where its list is. The engine is that of sweeps if the file names none.
    """
    run = given.data.get("run", {})
    unsaid = isinstance(run, dict) and "engine" not in run
    data: dict[str, Any] = {"run": {"engine": _ENGINE_OF_SWEEPS}} if unsaid else {}
    values = {}
    places: dict[Path, tuple[Place, Place]] = {(): (given.key_place(()), given.value_place(()))}
    for axis, index in zip(table.axes, indices, strict=True):
        values[axis.key] = axis.values[index]
        data.setdefault(str(axis.path[0]), {})[axis.path[1]] = axis.values[index]
        places[axis.path] = given.key_place(axis.swept_path), given.value_place(axis.swept_path)
    for name in data:
        places[name,] = given.key_place((name,)), given.value_place((name,))
    return values, Source(name=given.main.name, kind="setting", data=data, places=places)


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
        alone = f"{given.main.name}: no sweep: it has no table [sweep]; {ways}"
        raise ScenarioRefused(report(given.problems) or alone)
    table, wrong = read_table(given)
    read = read and cache(read)  # a file is read once, not at every point
    most = _LOOKED_AT_BESIDE_A_WRONG_TABLE if wrong else None
    looked_at = [_examined(given, table, indices, read) for indices in islice(table.choices(), most)]
    found = gathered(looked_at)
    if wrong:
        # What is missing may be meant by a key of the sweep that is not right yet.
        found = [problem for problem in found if not problem.is_missing]
    problems = [*given.problems, *wrong, *found]
    cases = [Case(values=each.values, scenario=each.scenario) for each in looked_at if each.scenario is not None]
    if not wrong and len(cases) == len(looked_at):
        problems += [*_repeated(given, cases), *_without_quantity(given, table.precision, cases)]
    if any(problem.severity == "error" for problem in problems):
        raise ScenarioRefused(report(problems))
    return Sweep(
        name=given.main.name,
        text=given.main.text,
        title=cases[0].scenario.title,
        keys=tuple(axis.key for axis in table.axes),
        side_by_side=tuple(axis.key for axis in table.side_by_side),
        cases=tuple(cases),
        replicates=table.settings.replicates,
        keep=table.settings.keep,
        precision=table.precision,
        warnings=tuple(map(str, in_order(problems))),
    )


def _examined(given: Layers, table: Table, indices: tuple[int, ...], read: ReadSizes | None) -> Examined:
    values, source = point_source(given, table, indices)
    scenario, problems = examined(given.topped(source, without=SWEEP), read)
    return Examined(values=values, scenario=scenario, problems=problems)


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


def _without_quantity(given: Layers, precision: Precision | None, cases: Sequence[Case]) -> Iterator[Problem]:
    """Refuse a precision of a quantity that a point does not have."""
    needs = QUANTITIES[precision.quantity].needs if precision else ""
    lacking = next((case for case in cases if needs and getattr(case.scenario, needs) is None), None)
    if precision and lacking:
        message = f"{precision.quantity} is no quantity of a run without [{needs}]"
        yield given.problem((SWEEP, "quantity"), message, f"a table [{needs}]")
    one_way = precision is not None and QUANTITIES[precision.quantity].one_way
    if precision and one_way and any(case.scenario.physics.is_two_way for case in cases):
        message = f"{precision.quantity} is no quantity of a run with two-way coupling"
        yield given.problem((SWEEP, "quantity"), message, "velocity_std is one")
