"""The Kolmogorov distance of a sample from its law, and the probability of such a distance."""

from math import sqrt

import numpy as np

from rubnoise.analysis.scores import figure, normal_deviate
from rubnoise.answer import Row
from rubnoise.arrays import Doubles

FEWEST = 10
"""Independent values from which a distance is given at all."""

_BINS = 1 << 18
_EXACT_UP_TO = 1000  # the limit's own error is some tenth of 1/sqrt(n)
_CONTINUOUS = 1e-3  # atom up to which small distances are as improbable as those of a continuous law
# Mean and standard deviation of D sqrt(n) for many values: sqrt(pi/2) ln 2, and sqrt(pi^2/12 - mean^2).
_MEAN, _STD = 0.868731, 0.260333


def kolmogorov_figure(name: str, distance: float, count: int, atom: float = 0.0) -> Row:
    """Return the figure of the largest distance between the distribution functions of independent values and their law.

    It has the mean and standard deviation of the distance for a right law. Its score is that of its tail probability; 0
    for small distances of few values, since only a bound is known there. A law with an ``atom`` gives smaller
    distances than a continuous one: the score of a large distance is safe, and a small one has the score 0.
    Source: Feller (1948), doi:10.1214/aoms/1177730243.
    """
    tail = distance_tail(distance, count)
    below = 1.0 - tail if count > _EXACT_UP_TO and atom <= _CONTINUOUS else 0.5
    root = sqrt(count)
    return figure(name, distance, _MEAN / root, _STD / root, normal_deviate(below, tail))


def distance_tail(distance: float, count: int) -> float:
    """Return P(D >= distance) for values of a continuous law: up to 1000 by the bound of both one-sided exact tails.

    The bound is close to the probability if that is small. Beyond 1000 values Kolmogorov's limit is used.
    """
    from scipy.special import kolmogorov, smirnov

    if count > _EXACT_UP_TO:
        return float(kolmogorov(distance * sqrt(count)))
    return min(1.0, 2.0 * float(smirnov(count, min(distance, 1.0))))


def sample_distance(values: Doubles, heights: Doubles, atom: float = 0.0) -> float:
    """Return D of values >= 0 at which the law's distribution function is ``heights``; at 0 it jumps to ``atom``."""
    order = np.argsort(values)
    at_zero = int((values == 0.0).sum())
    risen = heights[order][at_zero:]
    steps = np.arange(at_zero, values.size + 1) / values.size
    zero = abs(float(steps[0]) - atom) if at_zero or atom else 0.0
    if not risen.size:
        return zero
    return max(zero, float(np.max(steps[1:] - risen)), float(np.max(risen - steps[:-1])))


class UniformSample:
    """Values that should be uniform on [0, 1], counted in 2^18 bins, so that any number of them takes 2 MB.

    Their distance is taken at the edges of the bins only: never more than D, and less by at most 2^-18 and the share of
    a bin.
    """

    def __init__(self) -> None:
        self._counts = np.zeros(_BINS, dtype=np.int64)

    def add(self, values: Doubles) -> None:
        """Add values."""
        bins = np.minimum((np.clip(values, 0.0, 1.0) * _BINS).astype(np.int64), _BINS - 1)
        self._counts += np.bincount(bins, minlength=_BINS)

    @property
    def count(self) -> int:
        """Number of values."""
        return int(self._counts.sum())

    def distance(self) -> float:
        """Return the largest distance of the values' distribution function from the diagonal."""
        heights = np.cumsum(self._counts) / max(self.count, 1)
        return float(np.max(np.abs(heights - np.arange(1, _BINS + 1) / _BINS)))
