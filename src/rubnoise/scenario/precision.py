"""How precisely a sweep shall know a quantity at each of its points, and how many runs that takes."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, fsum, inf, isfinite, sqrt
from typing import Final

QUANTITIES: Final[dict[str, str]] = {
    "real_contact_area_mean": "",
    "real_contact_area_std": "",
    "real_contact_area_skewness": "",
    "real_contact_area_excess_kurtosis": "",
    "junction_count_mean": "",
    "junction_count_std": "",
    "friction_force_mean": "strength",
    "friction_force_std": "strength",
    "displacement_mean": "slider",
    "displacement_std": "slider",
    "velocity_std": "slider",
    "one_way_validity": "slider",
}
"""The figures of a run, and the table that a scenario needs for each."""

ONE_WAY_ONLY: Final = "one_way_validity"
"""The figure that a run with two-way coupling does not have."""

FEWEST: Final = 8
"""Runs from which their scatter says how precise their mean is: to some 27 %, 1/sqrt(2 (n - 1))."""

_SPARE: Final = 1.1
_AT_LEAST: Final = 0.125


@dataclass(frozen=True, slots=True, kw_only=True)
class Precision:
    """The relative standard error to which the mean of a quantity over replicates shall be known, and the most runs."""

    relative: float
    quantity: str
    most_replicates: int

    def reached(self, values: Sequence[float]) -> float:
        """Return s / (sqrt(n) |mean|) of replicates, s their standard deviation; nan among them is left out.

        Of fewer than two it is inf, of values that are all the same 0.
        """
        finite = [value for value in values if isfinite(value)]
        if len(finite) < 2:
            return inf
        mean = fsum(finite) / len(finite)
        error = sqrt(fsum((value - mean) ** 2 for value in finite) / (len(finite) * (len(finite) - 1)))
        if error == 0.0:
            return 0.0
        return error / abs(mean) if mean else inf

    def wanted(self, values: Sequence[float]) -> int:
        """Return how many replicates a point should have, from what those show that it has: as many when it is met.

        At most twice as many at a time, since few of them know little of their scatter.
        """
        have, reached = len(values), self.reached(values)
        if reached <= self.relative or have >= self.most_replicates:
            return have
        needed = min(2.0, _SPARE * (reached / self.relative) ** 2)
        return min(self.most_replicates, ceil(have * max(needed, 1.0 + _AT_LEAST)))
