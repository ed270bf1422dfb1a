"""Correctness before speed: everybody makes one small run of the same junctions, and is held against the references."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from bench import oracle, ours
from bench.case import Case, Doubles, Given, Output, doubles
from bench.entrants import OURS, Entrant, areas, births, runs

SMALL = Case(junctions=150)
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


@dataclass(frozen=True)
class Verdict:
    """Relative errors of one entrant where it answers, and whether they are within bounds."""

    name: str
    area: float | None = None
    motion: float | None = None
    life: float | None = None

    @property
    def passed(self) -> bool:
        """Whether there is an answer, and every error is within its bound; one that is not a number is not."""
        motion = OUR_MOTION_BOUND if self.name.startswith(OURS) else MOTION_BOUND
        bounds = ((self.area, AREA_BOUND), (self.motion, motion), (self.life, LIFE_BOUND))
        answered = [(error, bound) for error, bound in bounds if error is not None]
        return bool(answered) and all(error <= bound for error, bound in answered)


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


def verdicts(engines: tuple[str, ...], folder: Path) -> Iterator[Verdict]:
    """Yield a verdict on everybody: whole runs first, then areas, then births."""
    known = truth()
    for entrant in runs(engines):
        yield judged(entrant.name, whole_run(entrant, known, folder), known)
    for entrant in (*areas(engines), *births()):
        made = entrant.call(known.case, Given(known.birth, known.diameter))
        yield judged(entrant.name, made or Output(), known)


def judged(name: str, made: Output, known: Truth) -> Verdict:
    """Return the errors of what somebody has made of the junctions of the truth."""
    return Verdict(
        name,
        area=relative_error(made.area, known.area),
        motion=relative_error(made.displacement, known.displacement),
        life=life_error(made, known),
    )


def relative_error(found: Doubles | None, right: Doubles) -> float | None:
    """Return the largest error over the largest value: None where there is no answer, inf for one of another length."""
    if found is None:
        return None
    if found.shape != right.shape:
        return float("inf")
    return float(np.abs(found - right).max() / np.abs(right).max())


def life_error(made: Output, known: Truth) -> float | None:
    """Return the largest error of births and deaths over the distance; libraries of queues tell of the dead only."""
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
