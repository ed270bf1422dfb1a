"""The pulse kernel alone: ns for each tick of each junction, beside C, numba and nothing but square roots."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.case import Case, Doubles, Drawn
from bench.checks import AREA_BOUND, beyond, relative_error
from bench.clock import Task, Timing, interleaved
from bench.peers import c_kernel, naive_numpy, numba_loops
from rubnoise.simulation.kernel import sum_at_places
from rubnoise.simulation.state import LiveRows

CASE = Case(junctions=20_000)
REPETITIONS = 3
"""Rounds in one repeat, so that a repeat is long beside the clock's step."""

ROOTS = "C, square roots alone"
WAYS = {"C, the same polynomial": "polynomial", "C, textbook formula": "textbook", ROOTS: "roots"}
OURS = "rubnoise"
NUMBA = "numba loops"
Fill = Callable[[Doubles], None]


@dataclass(frozen=True)
class KernelTimings:
    """Timings by kernel, in units of (junction, tick), and largest errors over the largest area."""

    timings: dict[str, Timing]
    errors: dict[str, float]

    def faults(self) -> Iterator[str]:
        """Yield a sentence for each kernel whose area is wrong or unchecked; the square roots alone make no area."""
        for name in self.timings:
            if name != ROOTS:
                yield from beyond(f"pulse kernel, {name}", "area", self.errors.get(name), AREA_BOUND)


def fills(case: Case, birth: Doubles, diameter: Doubles) -> dict[str, Fill]:
    """Return each tool's way of adding the areas of junctions to the ticks."""
    weight = diameter * diameter
    count = np.zeros(case.ticks.size)
    found: dict[str, Fill] = {
        OURS: _by_the_door(case, birth, diameter, weight),
        NUMBA: lambda total: numba_loops.add_pulses(birth, diameter, case.tick, total, count),
    }
    if c_kernel.available():
        for name, way in WAYS.items():
            found[name] = _of_c(case, c_kernel.deposit(way), birth, diameter)
    return found


def _by_the_door(case: Case, birth: Doubles, diameter: Doubles, weight: Doubles) -> Fill:
    """Return our way, as in a run."""
    whole = np.full(birth.size, np.inf)
    rows = LiveRows(
        junction=np.arange(birth.size), birth=birth, diameter=diameter, strength=np.ones(birth.size), departure=whole
    )

    def fill(total: Doubles) -> None:
        total += sum_at_places("lens", rows, weight, 0, case.ticks.size, case.tick)

    return fill


def _of_c(case: Case, deposit: c_kernel.Deposit, birth: Doubles, diameter: Doubles) -> Fill:
    ticks = case.ticks
    return lambda total: deposit(case, ticks, birth, diameter, total)


def measured(repeats: int) -> KernelTimings:
    """Return times and errors of each tool's kernel on the contact of Figure 5."""
    return _measured(CASE, repeats, lambda _: True)


def measured_over_ticks(repeats: int, ticks: Sequence[float]) -> dict[float, KernelTimings]:
    """Return times and errors of our kernel and of plain loops, by the ticks in a mean life."""
    some = (OURS, NUMBA)
    return {each: _measured(replace(CASE, ticks_per_life=each), repeats, some.__contains__) for each in ticks}


def _measured(case: Case, repeats: int, takes_part: Callable[[str], bool]) -> KernelTimings:
    birth, diameter = Drawn(case, seed=1).rows()
    right, _ = naive_numpy.superpose(case, birth, diameter)
    errors, tasks = {}, {}
    units = REPETITIONS * 2.0 * float(diameter.sum()) / case.tick
    for name, fill in fills(case, birth, diameter).items():
        if takes_part(name):
            total = np.zeros(right.size)
            fill(total)
            if name != ROOTS:
                errors[name] = relative_error(total, right)
            tasks[name] = Task(_repeated(fill, total), units)
    return KernelTimings(interleaved(tasks, repeats), errors)


def _repeated(fill: Fill, total: Doubles) -> Callable[[], None]:
    def call() -> None:
        for _ in range(REPETITIONS):
            fill(total)

    return call
