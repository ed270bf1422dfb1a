"""A record that comes in pieces: its autocovariance, and its density with standard errors.

Batch means give a standard error from the record alone: the means m of B parts are nearly independent, so the error of
their mean is sqrt(sum of (m - mean)^2 / (B (B - 1))).
Source: Law and Kelton, Simulation Modeling and Analysis, section 9.5.3.
"""

from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles, Integers
from rubnoise.inference.signal import autocovariance
from rubnoise.tables import fields_as_text


def longer(length: float, error: float, largest_error: float) -> float:
    """Return the length in um at which a standard error falls to another: it falls as 1/sqrt(length)."""
    return length * (error / largest_error) ** 2


FEWEST_BATCHES = 30  # batches from which a standard error is given: it is then known to 13 %, 1/sqrt(2 n)

MOST_BATCHES = 256
LENGTHS_A_BATCH = 10.0
"""Integrated autocorrelation lengths to a batch: what neighbours share then takes a few per cent off the error."""

_WINDOW = 5.0


def integrated_autocorrelation(values: Doubles) -> float:
    """Return 1 + 2 sum of the autocorrelation, in ticks: the number of ticks that are worth one independent value.

    The sum ends at the first lag beyond five times itself, after which only noise would add up. 1 for constant values,
    inf if the record ends before that lag.
    Source: Sokal (1997), doi:10.1007/978-1-4899-0319-8_6.
    """
    covariance = autocovariance(values, values.size - 1)
    if covariance[0] <= 0.0:
        return 1.0
    lengths = 2.0 * np.cumsum(covariance) / covariance[0] - 1.0
    enough = np.flatnonzero(np.arange(values.size) >= _WINDOW * np.maximum(lengths, 1.0))
    return max(1.0, float(lengths[enough[0]])) if enough.size else inf


def batch_length(values: Doubles) -> int:
    """Return the ticks to a batch: ten integrated autocorrelation lengths, or a 256th of the record if that is more.

    The whole record is one if fewer than 30 batches fit.
    """
    length = max(LENGTHS_A_BATCH * integrated_autocorrelation(values), values.size / MOST_BATCHES)
    if length * FEWEST_BATCHES > values.size:
        return values.size
    return min(ceil(length), values.size // FEWEST_BATCHES)


class CovarianceSum:
    """Autocovariances at some lags (ticks, rising) of a stream of values, which may come in pieces of any size.

    ``centre`` is about the mean, so that nothing is lost to cancellation. Memory holds a piece and the longest lag.
    """

    def __init__(self, lags: Integers, centre: float) -> None:
        self._lags, self._centre, self._reach = lags, centre, int(lags[-1])
        self._head = self._tail = np.empty(0)
        self._products = np.zeros(lags.size)
        self._count, self._total = 0, 0.0

    def add(self, values: Doubles) -> None:
        """Add the next values."""
        row = np.concatenate([self._tail, values - self._centre])
        for place, lag in enumerate(self._lags.tolist()):
            begin = max(self._tail.size, lag)
            # Not by BLAS, whose sums depend on the number of its threads.
            self._products[place] += np.add.reduce(row[begin:] * row[begin - lag : max(row.size - lag, 0)])
        if self._head.size < self._reach:
            self._head = np.append(self._head, row[self._tail.size :])[: self._reach]
        self._count += values.size
        self._total += float(np.add.reduce(row[self._tail.size :]))
        self._tail = row[max(row.size - self._reach, 0) :]

    def covariances(self) -> Doubles:
        """Return the mean of (x_i - mean)(x_(i+j) - mean) over the n - j pairs of each lag j; nan for a lag without."""
        pairs = np.maximum(self._count - self._lags, 0).astype(np.float64)
        mean = self._total / max(self._count, 1)
        missing = np.append(0.0, np.cumsum(self._head + self._tail[::-1]))
        ends = 2.0 * self._total - missing[np.minimum(self._lags, self._head.size)]
        return (self._products - mean * ends) / np.where(pairs > 0.0, pairs, np.nan) + mean * mean


BINS = 60


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Histogram:
    """A density over bins: ``edges`` in the unit of the quantity, density and standard error in one over it.

    The density is the mean over its bin. Values outside of the edges are in no bin, so the density adds up to less than
    1 if there are any; ``outside`` is their share.
    """

    edges: Doubles
    density: Doubles
    standard_error: Doubles
    outside: float

    __repr__ = fields_as_text

    @property
    def middles(self) -> Doubles:
        """The middles of the bins."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])


def histogram(values: Doubles, edges: ArrayLike | int = BINS) -> Histogram:
    """Return the density of a record of equal ticks over bins: their edges, or their number over its range.

    The error of a bin is that of batch means: the scatter of the bin's share over stretches of the record, inf if it
    has too few of them. Raises ValueError for edges that do not rise.
    """
    if isinstance(edges, int):
        low, high = float(values.min()), float(values.max())
        bounds = np.linspace(low, high if high > low else low + 1.0, edges + 1)
    else:
        bounds = np.asarray(edges, dtype=np.float64)
        if bounds.ndim != 1 or bounds.size < 2 or not bool(np.all(np.diff(bounds) > 0.0)):
            raise ValueError("the edges of a histogram must rise")
    total = HistogramSum(bounds, batch_length(values))
    total.add(values)
    return total.histogram()


class HistogramSum:
    """The density of a stream of values over bins, which may come in pieces of any size.

    ``batch`` is the number of values of a stretch that is nearly independent of the next: errors come from the scatter
    of such stretches.
    """

    def __init__(self, edges: Doubles, batch: int) -> None:
        self._edges, self._batch, self._taken = edges, batch, 0
        self._rest = np.empty(0)
        self._sums = np.zeros((2, edges.size - 1))

    def add(self, values: Doubles) -> None:
        """Add the next values."""
        row, self._taken = np.concatenate([self._rest, values]), self._taken + values.size
        whole = row.size // self._batch * self._batch
        for part in row[:whole].reshape(-1, self._batch):
            share = self._share(part)
            self._sums += share, np.square(share)
        self._rest = row[whole:]

    def _share(self, part: Doubles) -> Doubles:
        return np.asarray(np.histogram(part, self._edges)[0] / self._batch, dtype=np.float64)

    def histogram(self) -> Histogram:
        """Return the density so far; errors are inf before the thirtieth stretch is complete."""
        stretches, width = self._taken // self._batch, np.diff(self._edges)
        share = (self._sums[0] + self._share(self._rest)) * (self._batch / max(self._taken, 1))
        error = np.full(width.size, inf)
        if stretches >= FEWEST_BATCHES:
            mean, square = self._sums / stretches
            error = np.sqrt(np.maximum(square - mean**2, 0.0) / (stretches - 1))
        return Histogram(
            edges=self._edges, density=share / width, standard_error=error / width, outside=1.0 - float(share.sum())
        )
