"""What is wrong with the points of a sweep, each thing told once, with the points that have it."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from rubnoise.scenario.problems import Problem
from rubnoise.scenario.scenario import Scenario

_NUMBERS = re.compile(r"[0-9][0-9.,e+-]*")
_SHOWN_CHARACTERS = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class Examined:
    """A point that was looked at: its swept values, its scenario where it has one, and its problems."""

    values: Mapping[str, Any]
    scenario: Scenario | None
    problems: Sequence[Problem]


def gathered(points: Sequence[Examined]) -> list[Problem]:
    """Return the problems of all points, those alike but for their numbers as one.

    A problem of every point, or of every point with the value at which it stands, is told as in a file of its own;
    any other one names the first point that has it and says how many more have.
    """
    alike: dict[tuple[object, ...], list[tuple[Problem, Examined]]] = {}
    for point in points:
        for problem in dict.fromkeys(point.problems):
            kind = _NUMBERS.sub("#", problem.message)
            alike.setdefault((problem.path, problem.place, problem.severity, kind), []).append((problem, point))
    return [_told(found, points) for found in alike.values()]


def in_words(values: Mapping[str, Any]) -> str:
    """Return swept values as they are told: `interface.mean_junction_count = 20, ...`."""
    return ", ".join(f"{key} = {str(value)[:_SHOWN_CHARACTERS]}" for key, value in values.items())


def _told(found: Sequence[tuple[Problem, Examined]], points: Sequence[Examined]) -> Problem:
    problem, first = found[0]
    everywhere = sum(point.values.get(problem.key) == first.values.get(problem.key) for point in points)
    if len(found) == everywhere and all(other.message == problem.message for other, _ in found):
        return problem
    where = in_words(first.values)
    more = len(found) - 1
    others = f", and at {more:,} more point{'s' if more > 1 else ''}" if more else ""
    return replace(problem, message=f"{problem.message}, at {where}{others}")
