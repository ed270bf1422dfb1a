"""Who was alive at the start: as many, as large and as old as in a contact that has always been sliding."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.comparing.findings import Finding
from rubnoise.analysis.comparing.judging import poisson_figure
from rubnoise.analysis.comparing.size_distribution import size_distribution
from rubnoise.analysis.kolmogorov import FEWEST, kolmogorov_figure, sample_distance
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.theory.occupancy import mean_count
from rubnoise.theory.quadrature import size_range
from rubnoise.theory.regular_births import need_random_births

Doubles = NDArray[np.float64]


class Start:
    """Gathers the rows of junctions that were alive at the start."""

    def __init__(self) -> None:
        self._births: list[Doubles] = []
        self._diameters: list[Doubles] = []

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Take in a panel of /junctions."""
        there = (columns["state"] & JunctionState.ALIVE_AT_START) != 0
        self._births.append(columns["birth_distance"][there])
        self._diameters.append(columns["diameter"][there])

    @property
    def diameters(self) -> Doubles:
        """Their diameters in um."""
        return np.concatenate([np.empty(0), *self._diameters])

    @property
    def ages(self) -> Doubles:
        """Their ages as a share of their lives."""
        return -np.concatenate([np.empty(0), *self._births]) / (2.0 * self.diameters)


def start_findings(model: Model, start: Start) -> list[Finding]:
    """Return number, ages and diameters at the start beside their laws; raises Refused unless births are random.

    The number is Poisson(lam E[2d]), ages are uniform over a life, diameters have a density proportional to d f(d); an
    empty start has nobody, and nothing to compare.
    """
    if model.start != "stationary":
        return []
    need_random_births(model, "who is alive at the start")
    diameters = start.diameters
    found: list[Finding] = [poisson_figure("start_count", diameters.size, mean_count(model))]
    if diameters.size < FEWEST:
        return found  # as few as the contact has: no length would bring more
    ages = np.sort(start.ages)
    found.append(kolmogorov_figure("start_age_kolmogorov", sample_distance(ages, ages), ages.size))
    low, high = size_range(model.sizes)
    if low < high:
        distance = sample_distance(diameters, size_distribution(model.sizes, alive=True)(diameters))
        found.append(kolmogorov_figure("start_diameter_kolmogorov", distance, diameters.size))
    return found
