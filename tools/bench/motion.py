"""The slider alone: error at equal ticks, and CPU time a tick."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from bench import checks, ours
from bench.case import Case, Drawn, doubles
from bench.clock import Task, Timing, interleaved
from bench.entrants import FASTEST
from bench.peers import naive_numpy, sliders

LENGTHS = {"lsim": 5_000, "RK4, numba": 100_000, "RK4, Python": 5_000, "solve_ivp": 300, "solve_ivp, exact force": 60}
"""Junctions in one repeat; some eleven ticks each."""

OUR_LENGTH = 100_000
OURS = "rubnoise"
EXACT = "solve_ivp, exact force"
MOVERS = {
    "lsim": sliders.lsim,
    "RK4, numba": sliders.rk4_numba,
    "RK4, Python": sliders.rk4_python,
    "solve_ivp": sliders.solve_ticks,
}


@dataclass(frozen=True)
class MotionTimings:
    """Timings by method, in units of ticks, and largest errors over the largest displacement."""

    timings: dict[str, Timing]
    errors: dict[str, float]

    def faults(self) -> Iterator[str]:
        """Yield a sentence for each method whose motion is wrong or unchecked; rubnoise's is right to nine digits."""
        for name in self.timings:
            bound = checks.OUR_MOTION_BOUND if name == OURS else checks.MOTION_BOUND
            yield from checks.beyond(f"slider, {name}", "displacement", self.errors.get(name), bound)


def errors(known: checks.Truth) -> dict[str, float]:
    """Return each tool's error on a small run; the peers are given the exact areas at the ticks."""
    made = {name: move(known.case, known.area) for name, move in MOVERS.items()}
    made[EXACT] = sliders.solve_exactly(known.case, known.birth, known.diameter)
    made[OURS] = doubles(ours.in_memory(known.case, FASTEST)["slider"]["displacement"])
    return {name: checks.relative_error(x, known.displacement) for name, x in made.items()}


def measured(repeats: int) -> MotionTimings:
    """Return times and errors of each tool's slider.

    Ours is the difference of a run in memory with the slider and one without, which holds the force's integrals too.
    """
    found = interleaved(_tasks(), repeats)
    whole, bare = found.pop("with"), found.pop("without")
    seconds = tuple(a - b for a, b in zip(whole.seconds, bare.seconds, strict=True))
    return MotionTimings({OURS: Timing(seconds, whole.units), **found}, errors(checks.truth()))


def _tasks() -> dict[str, Task]:
    case = Case(junctions=OUR_LENGTH)
    tasks = {
        "with": Task(partial(ours.in_memory, case, FASTEST), case.tick_count),
        "without": Task(partial(ours.in_memory, case, FASTEST, slider=False), case.tick_count),
    }
    for name, junctions in LENGTHS.items():
        short = Case(junctions=junctions)
        birth, diameter = Drawn(short, seed=1).rows()
        if name == EXACT:
            tasks[name] = Task(partial(sliders.solve_exactly, short, birth, diameter), short.tick_count)
        else:
            area, _ = naive_numpy.superpose(short, birth, diameter)
            tasks[name] = Task(partial(MOVERS[name], short, area), short.tick_count)
    return tasks
