"""Correctness before speed: each tool makes small runs of the same junctions, which are compared with references.

These are the slow references of tests/oracle, which share no code with rubnoise nor with any other tool.
"""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import h5py
import numpy as np

from bench import ours
from bench.case import DAMPING, MASS, SEED, SPEED, STIFFNESS, STRENGTH, Case, Doubles, Output, doubles

if "tests" not in sys.modules:
    # A peer's package brings a folder of this name into the environment, which would hide the project's.
    sys.modules["tests"] = ModuleType("tests")
    sys.modules["tests"].__path__ = [str(Path(__file__).resolve().parents[2] / "tests")]

from tests.oracle.sliders import Oscillator, theta_motion
from tests.oracle.slow_contact import Rows, traces

OURS = "rubnoise, "
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

    seed: int = SEED

    def rows(self) -> tuple[Doubles, Doubles]:
        """Return births and diameters, so that a tool can make this run."""
        return self.birth, self.diameter


class Wrong(Exception):  # noqa: N818  (a message for a person, printed as it is)
    """Something was computed wrong, or was timed and never checked; its arguments are a sentence each."""


@dataclass(frozen=True)
class Verdict:
    """Relative errors of one tool on one case."""

    name: str
    area: float
    motion: float
    life: float
    case: Case = SMALL

    def faults(self) -> Iterator[str]:
        """Yield a sentence for each answer that is off by more than its bound, or not a number."""
        motion = OUR_MOTION_BOUND if self.name.startswith(OURS) else MOTION_BOUND
        who = f"{self.name}, {self.case.ticks_per_life:g} ticks a life"
        for what, bound in (("area", AREA_BOUND), ("life", LIFE_BOUND), ("motion", motion)):
            error = getattr(self, what)
            if not error <= bound:
                yield f"{who}: the {what} is off by {error:.1e}, more than {bound:.0e}"


def truth(case: Case = SMALL) -> Truth:
    """Return a run's junctions with what the references make of them."""
    junctions = ours.in_memory(case, "events")["junctions"]
    birth, diameter = doubles(junctions["birth_distance"]), doubles(junctions["diameter"])
    rows = Rows(birth=birth, diameter=diameter, strength=np.full(birth.size, STRENGTH), death=birth + 2.0 * diameter)
    slider = Oscillator(mass=MASS, stiffness=STIFFNESS, damping=DAMPING)
    return Truth(
        case=case,
        birth=birth,
        diameter=diameter,
        area=traces(rows, case.ticks)[0],
        displacement=theta_motion(slider, SPEED, case.ticks, rows, (0.0, 0.0)).displacement,
    )


def cases(ticks: Iterable[float]) -> tuple[Case, ...]:
    """Return the cases on which whole runs are checked: the small one, and one for each number of ticks in a life."""
    found = []
    for each in ticks:
        lives = max(3.0, min(150.0 / SMALL.mean_count, MOST_TICKS / each))
        found.append(Case(ticks_per_life=each, junctions=round(lives * SMALL.mean_count)))
    return (SMALL, *found)


def judged(name: str, made: Output, known: Truth) -> Verdict:
    """Return the errors of what a tool has made of the junctions of the truth."""
    area, motion = relative_error(made.area, known.area), relative_error(made.displacement, known.displacement)
    return Verdict(name, area, motion, life_error(made, known), known.case)


def relative_error(found: Doubles, right: Doubles) -> float:
    """Return the largest error over the largest value; inf for an answer of another length."""
    if found.shape != right.shape:
        return float("inf")
    return float(np.abs(found - right).max() / np.abs(right).max())


def life_error(made: Output, known: Truth) -> float:
    """Return the largest error of births and deaths over the distance; inf if their number is another."""
    if made.birth.size != known.birth.size:
        return float("inf")
    errors = np.abs(made.birth - known.birth), np.abs(made.death - known.birth - 2.0 * known.diameter)
    return float(max(each.max() for each in errors) / known.case.distance)


def written(path: Path) -> Output:
    """Return what a whole run has left in its file: that counts, not what it returns."""
    with h5py.File(path) as file:
        return ours.output(file)
