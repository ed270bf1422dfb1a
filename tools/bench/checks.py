"""Correctness before speed: each entrant makes small runs of the same junctions, which are compared with references."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import h5py
import numpy as np

from bench import oracle, ours
from bench.case import Case, Doubles, Given, Output, doubles
from bench.entrants import AREAS, BIRTHS, IN_MEMORY, OURS, RUNS, Entrant

SMALL = Case(junctions=150)
MOST_TICKS = 3000
"""Of a check beside the small one, unless three mean lives need more: the references are slow."""

AREA_BOUND = 1e-9
"""Of the largest area: every peer has the same formula, and rounding is all that may be left."""

LIFE_BOUND = 1e-9
"""Of the distance, for births and deaths that are sums of gaps."""

MOTION_BOUND = 0.01
"""Of the largest displacement, for methods with an error of their own, which the table is there to show."""

OUR_MOTION_BOUND = 1e-9


@dataclass(frozen=True)
class Truth:
    """A small run: junctions drawn by rubnoise, area and displacement at the ticks by the references."""

    case: Case
    birth: Doubles
    diameter: Doubles
    area: Doubles
    displacement: Doubles


class Wrong(Exception):  # noqa: N818  (a message for a person, printed as it is)
    """Something was computed wrong, or was timed and never checked; its arguments are a sentence each."""


@dataclass(frozen=True)
class Verdict:
    """Relative errors of one entrant on one case, as far as it answers.

    ``part`` is "runs", "in memory", "areas" or "births", and says which answers there have to be.
    """

    part: str
    name: str
    area: float | None = None
    motion: float | None = None
    life: float | None = None
    case: Case = SMALL

    def faults(self) -> Iterator[str]:
        """Yield a sentence for each answer that is missing or off by more than its bound."""
        motion = OUR_MOTION_BOUND if self.name.startswith(OURS) else MOTION_BOUND
        answers = (("area", self.area, AREA_BOUND), ("motion", self.motion, motion), ("life", self.life, LIFE_BOUND))
        who = f"{self.part}, {self.name}, {self.case.mean_count:g} junctions, {self.case.ticks_per_life:g} ticks a life"
        for what, error, bound in answers:
            if error is not None or what in NEEDED[self.part]:
                yield from beyond(who, what, error, bound)

    @property
    def passed(self) -> bool:
        """Whether every answer that there has to be is there, and every error is within its bound."""
        return not any(self.faults())


NEEDED = {
    "runs": ("area", "motion", "life"),
    "in memory": ("area", "life"),
    "areas": ("area", "life"),
    "births": ("life",),
}


def beyond(who: str, what: str, error: float | None, bound: float) -> Iterator[str]:
    """Yield a sentence if there is no error, or if it is not within its bound; one that is not a number is not."""
    if error is None:
        yield f"{who}: the {what} was never checked"
    elif not error <= bound:
        yield f"{who}: the {what} is off by {error:.1e}, more than {bound:.0e}"


def truth(case: Case = SMALL) -> Truth:
    """Return a run's junctions with what the references make of them."""
    junctions = ours.in_memory(case, "events")["junctions"]
    birth, diameter = doubles(junctions["birth_distance"]), doubles(junctions["diameter"])
    return Truth(
        case=case,
        birth=birth,
        diameter=diameter,
        area=oracle.area(case, birth, diameter),
        displacement=oracle.displacement(case, birth, diameter),
    )


def cases(counts: Iterable[float], ticks: Iterable[float]) -> tuple[Case, ...]:
    """Return the cases on which whole runs are checked: the small one, and one for each point at which time is taken.

    The sums go different ways for different numbers of ticks and of junctions, so each of them is checked.
    """
    points = [*product(counts, [SMALL.ticks_per_life]), *product([SMALL.mean_count], ticks)]
    return (SMALL, *(_small(*point) for point in points))


def _small(mean_count: float, ticks_per_life: float) -> Case:
    lives = max(3.0, min(150.0 / mean_count, MOST_TICKS / ticks_per_life))
    return Case(mean_count, ticks_per_life, round(lives * mean_count))


def verdicts(folder: Path, wanted: tuple[Case, ...] = (SMALL,)) -> Iterator[Verdict]:
    """Yield a verdict on each entrant: runs into files and in memory in every case, areas and births in the first."""
    for case in wanted:
        known = truth(case)
        for entrant in RUNS:
            yield judged("runs", entrant.name, whole_run(entrant, known, folder), known)
        for entrant in IN_MEMORY:
            made = entrant.call(known.case, Given(known.birth, known.diameter))
            yield judged("in memory", entrant.name, made or Output(), known)
    known = truth(wanted[0])
    for part, entrants in (("areas", AREAS), ("births", BIRTHS)):
        for entrant in entrants:
            made = entrant.call(known.case, Given(known.birth, known.diameter))
            yield judged(part, entrant.name, made or Output(), known)


def judged(part: str, name: str, made: Output, known: Truth) -> Verdict:
    """Return the errors of what an entrant has made of the junctions of the truth."""
    return Verdict(
        part,
        name,
        area=None if made.area is None else relative_error(made.area, known.area),
        motion=None if made.displacement is None else relative_error(made.displacement, known.displacement),
        life=life_error(made, known),
        case=known.case,
    )


def relative_error(found: Doubles, right: Doubles) -> float:
    """Return the largest error over the largest value; inf for an answer of another length."""
    if found.shape != right.shape:
        return float("inf")
    return float(np.abs(found - right).max() / np.abs(right).max())


def life_error(made: Output, known: Truth) -> float | None:
    """Return the largest error of births and deaths over the distance; libraries of queues report only the dead."""
    if made.birth is None or made.death is None:
        return None
    death = known.birth + 2.0 * known.diameter
    dead = death <= known.case.distance
    whole = made.birth.size == known.birth.size
    if not whole and made.birth.size != int(dead.sum()):
        return float("inf")
    kept = slice(None) if whole else dead
    errors = np.abs(made.birth - known.birth[kept]), np.abs(made.death - death[kept])
    return float(max(each.max() for each in errors) / known.case.distance)


def whole_run(entrant: Entrant, known: Truth, folder: Path) -> Output:
    """Return what a whole run of the truth's junctions has left in its file: that counts, not what it returns."""
    path = folder / "check.h5"
    entrant.call(known.case, Given(known.birth, known.diameter), path)
    with h5py.File(path) as file:
        return ours.output(file, slider=True)
