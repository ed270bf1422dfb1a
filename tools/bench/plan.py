"""The plan of the measurements: all of them for the page, or a short version in a minute or two."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path

from bench.case import Case
from bench.entrants import Entrant


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Repeats of everything, and the points at which growth and memory are looked at; plan.toml says more of each."""

    quick: bool
    repeats: int
    growth_repeats: int
    counts: Sequence[float]
    ticks: Sequence[float]
    kernel_ticks: Sequence[float]
    lengths: Sequence[int]
    memory: Sequence[int]
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


_PLANS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
FULL, QUICK = (Plan(quick=name == "quick", **_PLANS[name]) for name in ("full", "quick"))
