"""Runs of scenarios whose figures are known as plain numbers, and the record of how far off each figure is.

What is expected is written out from the scenario's own numbers, with nothing of the program that could be wrong in the
same way. RUBNOISE_SCORES names a file to which every score is added, a line each: `tools/mutants.py` reads it.
"""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rubnoise
from rubnoise.api.record import Record
from rubnoise.scenario import Scenario
from tests.verification.scores import BOUND, Figures, outside, seed_of

Doubles = NDArray[np.float64]

AREA, COUNT = 200.0, 20
EXACT_DIAMETER = sqrt(3.0 * AREA / COUNT)
"""In um: that of the mean life area d^2/3."""

PAPER_DIAMETER = sqrt(AREA / COUNT / 0.327)
"""In um: that of the paper's Eq. (6)."""


def scenario(**tables: Mapping[str, Any]) -> Scenario:
    """Return a contact of 200 um^2 and 20 junctions, played by the batch engine where nothing else is said."""
    interface = {"mean_real_contact_area": "200 um^2", "mean_junction_count": COUNT}
    run = {"engine": "batch"}
    return rubnoise.build(
        {"interface": interface | dict(tables.pop("interface", {})), "run": run | dict(tables.pop("run", {}))} | tables
    )


@cache
def record(name: str, given: Callable[[], Scenario]) -> Record:
    """Return a run of a scenario, with the seed that belongs to a name."""
    return rubnoise.simulate(given(), seed_of(f"sentinels/{name}"))


def judge(found: Figures) -> None:
    """Report every score to the caller, and refuse those beyond four standard errors."""
    if asked := os.environ.get("RUBNOISE_SCORES"):
        with Path(asked).open("a", encoding="utf-8") as file:
            file.writelines(f"{z:.2f}\t{name}\n" for name, z in found.items())
    assert not outside(found, BOUND)


@dataclass(frozen=True, slots=True, kw_only=True)
class Positive:
    """A normal law of a positive quantity, drawn again while it is not: its moments by a sum over its density."""

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[d^n]."""
        low = max(0.0, self.mean - 12.0 * self.std)
        step = (self.mean + 12.0 * self.std - low) / 400_000
        d = low + step * (np.arange(400_000) + 0.5)
        weight = np.exp(-0.5 * ((d - self.mean) / self.std) ** 2)
        return float(weight @ d**power / weight.sum())

    def scores(self, values: Doubles) -> Figures:
        """Return how far mean and standard deviation of independent values are from the law's."""
        first, second, third, fourth = (self.moment(n) for n in range(1, 5))
        variance = second - first**2
        kurtosis = (fourth - 4.0 * first * third + 6.0 * first**2 * second - 3.0 * first**4) / variance**2
        return {
            "mean": (values.mean() - first) / sqrt(variance / values.size),
            "std": (values.std() / sqrt(variance) - 1.0) / sqrt((kurtosis - 1.0) / (4.0 * values.size)),
        }


def correlation(one: Doubles, other: Doubles) -> float:
    """Return the correlation coefficient times sqrt(n), a unit normal for independent values; 0 of a constant."""
    if one.std() == 0.0 or other.std() == 0.0:
        return 0.0
    return float(np.corrcoef(one, other)[0, 1] * np.sqrt(one.size))
