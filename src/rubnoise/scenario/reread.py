"""Read a text with its overrides again, to compare it with a run that was made from it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario.keys import SWEEP
from rubnoise.scenario.layers import Layers, from_text, from_text_over, from_values
from rubnoise.scenario.points import Case, points_of
from rubnoise.scenario.problems import report
from rubnoise.scenario.reading import checked, examined, replaced, stored_sizes
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.source import Source
from rubnoise.scenario.sweep import PointOverlay
from rubnoise.scenario.sweep_table import Axis, Table, read_table

NAME: Final = "scenario_toml"
_FIRST_CALIBRATION: Final = "exact"  # what a text without the key meant when older runs were made


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
    self_contained = "extends" not in Source(NAME, text).data
    given = from_text(text, NAME, overrides) if self_contained else from_text_over(run, text, NAME, overrides)
    interface = given.data.get("interface")
    unsaid = isinstance(interface, dict) and "calibration" not in interface
    if unsaid and run["interface"].get("calibration") == _FIRST_CALIBRATION:
        given = from_text(text, NAME, [*overrides, f"interface.calibration={_FIRST_CALIBRATION}"])
    if SWEEP in given.data:
        return _point(given, run, self_contained=self_contained)
    return Reread(resolved=checked(given, stored_sizes(run)).resolved(), self_contained=self_contained)


def as_made(scenario: Scenario, made: Mapping[str, Any]) -> Scenario:
    """Return a scenario with the defaults of the time of its run, whose resolved scenario is ``made``.

    If neither has the calibration, it was exact, and not today's default.
    """
    interface = made.get("interface")
    first = isinstance(interface, Mapping) and interface.get("calibration") == _FIRST_CALIBRATION
    if not first or "calibration" in scenario.given.get("interface", {}):
        return scenario
    return replace(replaced(scenario, {"interface.calibration": _FIRST_CALIBRATION}), text=scenario.text)


def _point(given: Layers, run: Mapping[str, Any], *, self_contained: bool) -> Reread:
    table, wrong = read_table(given)
    if given.problems or wrong:
        raise ScenarioRefused(report([*given.problems, *wrong]))
    choice = PointOverlay(NAME, "", origin=given, axes=table.axes, indices=_indices(table, run))
    scenario = checked(given.topped(choice, without=SWEEP), stored_sizes(run))
    replicates = points_of([Case(values=choice.values, scenario=scenario)], table.settings.most_replicates)
    seeds = frozenset(point.seed for point in replicates)
    return Reread(
        resolved=scenario.resolved(), seeds=seeds if self_contained else frozenset(), self_contained=self_contained
    )


def _indices(table: Table, run: Mapping[str, Any]) -> tuple[int, ...]:
    """Return the number of the run's value on each axis; values side by side have one number."""
    found = [_numbers(axis, run) for axis in table.grid]
    if table.side_by_side:
        common = set.intersection(*(set(_numbers(axis, run)) for axis in table.side_by_side))
        found += [sorted(common)] * len(table.side_by_side)
    for axis, numbers in zip(table.axes, found, strict=True):
        if not numbers:
            section, key = map(str, axis.path)
            raise ScenarioRefused(f"{NAME}: {axis.key}: none of its values is that of the run, {run[section].get(key)}")
    return tuple(numbers[0] for numbers in found)


def _numbers(axis: Axis, run: Mapping[str, Any]) -> list[int]:
    return [number for number, value in enumerate(axis.values) if _is_of(axis, value, run)]


def _is_of(axis: Axis, value: Any, run: Mapping[str, Any]) -> bool:
    """Whether a run has the given value of a key."""
    section, key = map(str, axis.path)
    changed = from_values({**run, section: {**run.get(section, {}), key: value}}, NAME)
    scenario, _ = examined(changed)
    return scenario is not None and scenario.resolved()[section].get(key) == run[section].get(key)
