"""CPU time per junction: whole runs, the area alone, births alone, and how they grow."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import count
from pathlib import Path

from bench.case import Case, Drawn
from bench.clock import Task, Timing, interleaved
from bench.entrants import Entrant
from bench.plan import Plan

Timings = dict[str, Timing]
Growth = dict[str, dict[float, Timing]]
"""By entrant, then by the number that grows."""


def task(entrant: Entrant, case: Case, path: Path | None) -> Task:
    """Return a run of an entrant as a task, in units of junctions; into a file where there is a path.

    Each repeat has a seed of its own, so that no tool finds what was drawn for the one before.
    """
    seeds = count(1)

    def call() -> None:
        draws = Drawn(case, seed=next(seeds))
        entrant.call(case, draws, *([path] if path else []))

    # Each tool writes a new file, so that removing an old one is not measured.
    return Task(call, case.junctions, partial(path.unlink, missing_ok=True) if path else lambda: None)


def warm(entrants: Iterable[Entrant], path: Path | None) -> None:
    """Let each tool load and compile what it needs."""
    for entrant in entrants:
        task(entrant, Case(junctions=100), path).call()


def timed(entrants: Sequence[Entrant], plan: Plan, path: Path | None = None) -> Timings:
    """Return the timings of all tools on the contact of Figure 5."""
    warm(entrants, path)
    return interleaved({each.name: task(each, plan.case(each), path) for each in entrants}, plan.repeats)


def growths(entrants: Sequence[Entrant], plan: Plan, path: Path) -> dict[str, Growth]:
    """Return the timings of whole runs over N_jm, ticks in a life, and length."""
    grow = partial(_growth, entrants, plan, path)
    return {
        "count": grow(plan.counts, lambda each, count: plan.case(each, mean_count=count)),
        "ticks": grow(plan.ticks, lambda each, ticks: plan.case(each, ticks_per_life=ticks)),
        "length": grow(plan.lengths, lambda each, length: _of_length(plan, each, int(length))),
    }


def over_ticks(entrants: Sequence[Entrant], plan: Plan, points: Sequence[float]) -> Growth:
    """Return the timings of what is kept in memory, over ticks in a life."""
    warm(entrants, None)
    return _growth(entrants, plan, None, points, lambda each, ticks: plan.case(each, ticks_per_life=ticks))


def _of_length(plan: Plan, entrant: Entrant, junctions: int) -> Case | None:
    return Case(junctions=junctions) if plan.reaches(entrant.name, junctions) else None


def _growth(
    entrants: Sequence[Entrant],
    plan: Plan,
    path: Path | None,
    points: Sequence[float],
    case_of: Callable[[Entrant, float], Case | None],
) -> Growth:
    found: Growth = {each.name: {} for each in entrants}
    for point in points:
        cases = {each: case_of(each, point) for each in entrants}
        tasks = {each.name: task(each, case, path) for each, case in cases.items() if case}
        for name, timing in interleaved(tasks, plan.growth_repeats).items():
            found[name][point] = timing
    return found
