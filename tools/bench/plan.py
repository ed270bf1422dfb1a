"""The plan of the measurements: all of them for the page, or a short version in a minute or two."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

from bench.case import Case
from bench.entrants import NAIVE_NUMPY, NAIVE_SIMPY, SUPERPOSED, Entrant


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Repeats of everything, and the points at which growth and memory are looked at.

    ``counts`` are N_jm, ``ticks`` and, of the pulse kernel, ``kernel_ticks`` those of a mean life, ``lengths``,
    ``memory`` and, of our runs with a slider that pushes back and off the centre line, ``two_way`` and ``off_centre``
    numbers of junctions; ``swept`` is the number of short runs in a sweep. Whole runs need ticks that are fine enough
    for each tool's slider.
    """

    quick: bool
    repeats: int
    growth_repeats: int
    counts: tuple[float, ...]
    ticks: tuple[float, ...]
    kernel_ticks: tuple[float, ...]
    lengths: tuple[int, ...]
    memory: tuple[int, ...]
    swept: int
    two_way: int
    two_way_repeats: int
    off_centre: int
    off_centre_repeats: int
    longest: Mapping[str, int]

    def junctions(self, entrant: Entrant) -> int:
        """Return how many junctions an entrant is given in one repeat."""
        return entrant.quick_junctions if self.quick else entrant.junctions

    def case(self, entrant: Entrant, mean_count: float = 20.0, ticks_per_life: float = 221.0) -> Case:
        """Return an entrant's case: at most twice the ticks that it has at 20 junctions and 221 ticks a life."""
        junctions = self.junctions(entrant)
        ticks = junctions * 221.0 / 20.0
        return Case(mean_count, ticks_per_life, min(junctions, round(2.0 * ticks * mean_count / ticks_per_life)))

    def reaches(self, name: str, junctions: int) -> bool:
        """Whether an entrant is asked for a run of so many junctions."""
        return junctions <= self.longest.get(name, inf)


FULL = Plan(
    quick=False,
    repeats=21,
    growth_repeats=3,
    counts=(10.0, 100.0, 1000.0),
    ticks=(10.0, 30.0, 220.0, 2200.0),
    kernel_ticks=(3.0, 10.0, 30.0, 220.0, 2200.0),
    lengths=(10_000, 100_000, 1_000_000),
    memory=(100, 100_000, 1_000_000, 10_000_000),
    swept=500,
    two_way=100_000,
    two_way_repeats=7,
    off_centre=100_000,
    off_centre_repeats=7,
    longest={NAIVE_SIMPY: 10_000, NAIVE_NUMPY: 100_000, SUPERPOSED: 100_000},
)
QUICK = Plan(
    quick=True,
    repeats=3,
    growth_repeats=1,
    counts=(10.0, 100.0),
    ticks=(30.0, 220.0),
    kernel_ticks=(3.0, 30.0, 220.0),
    lengths=(1_000, 10_000, 100_000),
    memory=(100_000,),
    swept=100,
    two_way=20_000,
    two_way_repeats=1,
    off_centre=20_000,
    off_centre_repeats=1,
    longest={NAIVE_SIMPY: 1_000, NAIVE_NUMPY: 1_000, SUPERPOSED: 1_000},
)
