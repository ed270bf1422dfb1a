"""Running moments of what a run records, gathered while its rows pass by."""

from dataclasses import dataclass, field
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.record.rows import LandmarkKind, Phase
from rubnoise.record.sink import Columns

WATCHED = {
    "trace": {"real_contact_area": 4, "junction_count": 2, "friction_force": 2},
    "slider": {"displacement": 2, "velocity": 2},
}
"""Which columns are tallied, by group, and to which power."""

COUNTED = {"slider": {"phase": len(Phase)}, "landmarks": {"kind": len(LandmarkKind)}}
"""Columns of few whole numbers of which each is counted, by group, and how many there are."""

TALLIED = {group: {**WATCHED.get(group, {}), **COUNTED.get(group, {})} for group in {**WATCHED, **COUNTED}}
"""All columns from which a tally is made."""


@dataclass(slots=True)
class Moments:
    """Count, mean and the sums of the second to fourth powers about the mean of a stream of values.

    With ``powers`` 2 the third and fourth are left out, and skewness and kurtosis with them.

    Panels are merged by the pairwise formulas of Chan, Golub and LeVeque (1983) and Pebay (2008), so that nothing is
    lost to cancellation however long the run.
    """

    powers: int = 4
    count: int = 0
    mean: float = 0.0
    second: float = 0.0
    third: float = 0.0
    fourth: float = 0.0

    def add(self, values: NDArray[Any]) -> None:
        """Take in one panel of values of any kind of number."""
        if not values.size:
            return
        # Only who runs a model waits for the compiler to be loaded, and no one who opens its result.
        from rubnoise.record.central_sums import central_sums

        whole = values if values.flags.writeable else values.copy()
        mean, second, third, fourth = central_sums(whole, self.powers)
        self._merge(values.size, mean, second, third, fourth)

    def _merge(self, count: int, mean: float, second: float, third: float, fourth: float) -> None:
        before, total = self.count, self.count + count
        step = mean - self.mean
        part, share = step / total, before * count / total
        fourth += step**2 * part**2 * share * (before**2 - before * count + count**2)
        fourth += 6.0 * part**2 * (before**2 * second + count**2 * self.second)
        fourth += 4.0 * part * (before * third - count * self.third)
        third += step**2 * part * share * (before - count)
        third += 3.0 * part * (before * second - count * self.second)
        self.fourth += fourth
        self.third += third
        self.second += second + step**2 * share
        self.mean += part * count
        self.count = total

    @property
    def variance(self) -> float:
        """Mean square deviation from the mean."""
        return self.second / self.count if self.count else 0.0

    @property
    def std(self) -> float:
        """Root of the variance."""
        return sqrt(self.variance)

    @property
    def skewness(self) -> float:
        """Third standardised moment; 0 for values that do not vary."""
        return self.third / self.count / self.variance**1.5 if self.variance > 0.0 else 0.0

    @property
    def excess_kurtosis(self) -> float:
        """Fourth standardised moment less 3; 0 for values that do not vary."""
        return self.fourth / self.count / self.variance**2 - 3.0 if self.variance > 0.0 else 0.0


@dataclass(frozen=True, slots=True)
class Tally:
    """A sink that keeps only the moments of the columns it watches, or how often each number comes, by name."""

    moments: dict[str, Moments] = field(default_factory=dict)
    counts: dict[str, list[int]] = field(default_factory=dict)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Take in rows of a group (see Sink)."""
        del first_row
        for name, powers in WATCHED.get(group, {}).items():
            if name in columns:
                seen = self.moments.setdefault(name, Moments(powers=powers))
                seen.add(columns[name])
        for name, numbers in COUNTED.get(group, {}).items():
            if name in columns:
                counts = self.counts.setdefault(name, [0] * numbers)
                for number in range(numbers):
                    counts[number] += int(np.count_nonzero(columns[name] == number))
