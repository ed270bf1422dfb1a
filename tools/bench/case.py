"""The input of all tools in the benchmark: one contact, one slider, ticks, and junctions to draw."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import sqrt
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

AREA = 200.0
LIFE_MEAN = 0.327
RELATIVE_SPREAD = 0.0362
"""Of the diameters: 0.2 um at 20 junctions, as the paper has it, and as many percent at any other number."""

STRENGTH = 250.0
SPEED = 1000.0
MASS, STIFFNESS, DAMPING = 0.005, 300.0, 0.05

SEED = 1
"""The seed of the run whose junctions all tools get."""


@dataclass(frozen=True)
class Case:
    """Figure 5 of the paper (um, s, kg) from an empty start and at rest, for a number of junctions born.

    ``mean_count`` is N_jm, ``ticks_per_life`` the ticks in a mean life, ``junctions`` the mean number of births.
    """

    mean_count: float = 20.0
    ticks_per_life: float = 221.0
    junctions: int = 1000

    @cached_property
    def mean_diameter(self) -> float:
        """d_m = sqrt(A_rm / (0.327 N_jm)) in um."""
        return sqrt(AREA / self.mean_count / LIFE_MEAN)

    @property
    def diameter_std(self) -> float:
        """Standard deviation of the diameters in um."""
        return RELATIVE_SPREAD * self.mean_diameter

    @property
    def mean_gap(self) -> float:
        """s_jm = 2 d_m / N_jm in um."""
        return 2.0 * self.mean_diameter / self.mean_count

    @cached_property
    def tick(self) -> float:
        """Distance in um from tick to tick, in few digits so that a scenario can say it."""
        return float(f"{2.0 * self.mean_diameter / self.ticks_per_life:.4g}")

    @cached_property
    def tick_count(self) -> int:
        """Number of ticks after the one at 0."""
        return int(self.junctions * self.mean_gap / self.tick)

    @property
    def distance(self) -> float:
        """Sliding distance in um: half a tick beyond the last tick, so that rounding moves no tick out of the run."""
        return (self.tick_count + 0.5) * self.tick

    @property
    def ticks(self) -> Doubles:
        """Distances of all ticks in um."""
        return np.arange(self.tick_count + 1, dtype=np.float64) * self.tick

    @property
    def step(self) -> float:
        """Time in s from tick to tick."""
        return self.tick / SPEED

    def of(self, junctions: int) -> Self:
        """Return the same contact for another number of births."""
        return replace(self, junctions=junctions)


class Draws(Protocol):
    """Where the junctions of a run come from; ``seed`` is for who draws them itself."""

    @property
    def seed(self) -> int: ...  # noqa: D102

    def rows(self) -> tuple[Doubles, Doubles]:
        """Return births and diameters in um of every junction of the run, in order of birth."""
        ...


@dataclass
class Drawn:
    """Random junctions of a case."""

    case: Case
    seed: int

    def rows(self) -> tuple[Doubles, Doubles]:
        """Return a Poisson process of births up to the end of the run, and normal diameters, redrawn until positive."""
        case, random = self.case, np.random.default_rng(self.seed)
        count = int(case.junctions + 10.0 * sqrt(case.junctions) + 10)
        birth = np.cumsum(random.exponential(case.mean_gap, count))
        birth = birth[birth <= case.distance]
        diameter = random.normal(case.mean_diameter, case.diameter_std, birth.size)
        while (wrong := diameter <= 0.0).any():
            diameter[wrong] = random.normal(case.mean_diameter, case.diameter_std, int(wrong.sum()))
        return birth, diameter


@dataclass(frozen=True, kw_only=True)
class Output:
    """What a tool has left in its file: area and displacement at the ticks (um^2, um), and junctions (um)."""

    area: Doubles
    displacement: Doubles
    birth: Doubles
    death: Doubles


def doubles(values: Any) -> Doubles:
    """Return values as an array of doubles."""
    return np.asarray(values, dtype=np.float64)
