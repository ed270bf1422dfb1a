"""Running moments of the columns of a run, and its slips, computed from its chunks."""

from dataclasses import dataclass
from math import inf, nan, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.record.rows import LandmarkKind

WATCHED = {
    "trace": {"real_contact_area": 4, "junction_count": 2, "friction_force": 2},
    "slider": {"displacement": 2, "velocity": 2},
    "load": {"separation": 2, "velocity": 2, "load": 2},
}
"""Columns of which moments are taken, by group, and up to which power."""


@dataclass(slots=True)
class Moments:
    """Count, mean and the sums of the second to fourth powers about the mean of a stream of values.

    With ``powers`` 2 the third and fourth sums are left out, and with them skewness and kurtosis.

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
        """Add values of any numeric type, some at a time, so that they stay in the processor's cache."""
        for part in slices(0, values.size):
            mean = float(values[part].mean())
            away = values[part] - mean
            square = np.square(away)
            higher = ((square * away).sum(), np.square(square).sum()) if self.powers > 2 else (0.0, 0.0)
            self._merge(away.size, mean, float(square.sum()), *map(float, higher))

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
        """Third standardised moment; 0 for constant values."""
        return self.third / self.count / self.variance**1.5 if self.variance > 0.0 else 0.0

    @property
    def excess_kurtosis(self) -> float:
        """Fourth standardised moment less 3; 0 for constant values."""
        return self.fourth / self.count / self.variance**2 - 3.0 if self.variance > 0.0 else 0.0


@dataclass(slots=True)
class Slips:
    """The number of slips of a two-way slider that are longer than a length in um, from chunks of /landmarks.

    A slip goes from a breakaway to the next stick; its length is that of its path, back and forth added up.
    """

    longer_than: float = inf
    count: int = 0
    _begin: float = nan
    _path: float = 0.0
    _place: float = nan

    def add(self, kind: NDArray[Any], distance: NDArray[Any]) -> None:
        """Add rows of /landmarks."""
        if not kind.size:
            return
        steps = np.abs(np.diff(distance, prepend=self._place))
        path = self._path + np.cumsum(np.nan_to_num(steps))
        last = np.maximum.accumulate(np.where(kind == LandmarkKind.SLIP, np.arange(kind.size), -1))
        begins = np.where(last >= 0, path[last], self._begin)
        self.count += int(np.count_nonzero((path - begins)[kind == LandmarkKind.STICK] > self.longer_than))
        self._begin, self._path, self._place = float(begins[-1]), float(path[-1]), float(distance[-1])
