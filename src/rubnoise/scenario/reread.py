"""Read a text with its overrides again, to compare it with a run that was made from it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario.document import SECTIONS
from rubnoise.scenario.fields import Field, keys_of
from rubnoise.scenario.layers import from_text, from_text_over
from rubnoise.scenario.points import Case, points_of
from rubnoise.scenario.problems import report
from rubnoise.scenario.reading import checked
from rubnoise.scenario.sweep import point_source
from rubnoise.scenario.sweep_keys import SWEEP
from rubnoise.scenario.sweep_table import Axis, Table, read_table
from rubnoise.scenario.text import read_toml
from rubnoise.units import Unfit

NAME: Final = "scenario_toml"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reread:
    """The resolved scenario of a text, and for a point of a sweep the seeds of its replicates.

    ``self_contained`` is False if the text extends a file that is missing: its keys are then taken from the run.
    """

    resolved: Mapping[str, Any]
    seeds: frozenset[int] = frozenset()
    self_contained: bool = True


def reread(text: str, run: Mapping[str, Any], overrides: Sequence[str] = ()) -> Reread:
    """Return the scenario of a text with overrides; for a sweep, the point with the swept values of the run.

    ``run`` is the resolved scenario of the run. Raises ScenarioRefused if the text is not a scenario, or its sweep
    has no such point.
    """

    def sizes(_path: str, _column: str | None) -> Sequence[float]:
        return [float(value) for value in run["diameter"].get("values", ())]

    self_contained = "extends" not in read_toml(NAME, text).data
    given = from_text(text, NAME, overrides) if self_contained else from_text_over(run, text, NAME, overrides)
    if SWEEP not in given.data:
        return Reread(resolved=checked(given, sizes).resolved(), self_contained=self_contained)
    table, wrong = read_table(given)
    if given.problems or wrong:
        raise ScenarioRefused(report([*given.problems, *wrong]))
    values, source = point_source(given, table, _indices(table, run))
    scenario = checked(given.topped(source, without=SWEEP), sizes)
    replicates = points_of([Case(values=values, scenario=scenario)], table.settings.largest)
    seeds = frozenset(point.seed for point in replicates if self_contained)
    return Reread(resolved=scenario.resolved(), seeds=seeds, self_contained=self_contained)


def _indices(table: Table, run: Mapping[str, Any]) -> tuple[int, ...]:
    """Return the number of the run's value on each axis; values side by side have one number."""
    found = [_numbers(axis, run) for axis in table.axes]
    zipped = [numbers for axis, numbers in zip(table.axes, found, strict=True) if axis in table.side_by_side]
    common = set.intersection(*zipped) if zipped else set()
    chosen = []
    for axis, numbers in zip(table.axes, found, strict=True):
        if not (fitting := common if axis in table.side_by_side else numbers):
            section, key = map(str, axis.path)
            raise ScenarioRefused(f"{NAME}: {axis.key}: none of its values is that of the run, {run[section].get(key)}")
        chosen.append(min(fitting))
    return tuple(chosen)


def _numbers(axis: Axis, run: Mapping[str, Any]) -> set[int]:
    """Return the numbers of the values that a run has."""
    section, key = map(str, axis.path)
    kind, here = keys_of(SECTIONS[section])[key].kind, run.get(section, {}).get(key)
    of_run = None if here is None else _read(kind, here)
    return {number for number, value in enumerate(axis.values) if of_run is not None and _read(kind, value) == of_run}


def _read(kind: Field, value: Any) -> Any:
    try:
        return kind.of_python(value)
    except Unfit:
        return None
