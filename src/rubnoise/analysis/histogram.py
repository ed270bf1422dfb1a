"""The histogram of a record, or of a stream of values, as a density with errors for ticks that are not independent."""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.records import FEWEST_BATCHES, batch_length
from rubnoise.arrays import Doubles
from rubnoise.tables import fields_as_text

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

    def __repr__(self) -> str:
        return fields_as_text(self)

    @property
    def middles(self) -> Doubles:
        """The middles of the bins."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])


def histogram(values: Doubles, tick: float, edges: ArrayLike | int = BINS) -> Histogram:
    """Return the density of a record of equal ticks (um) over bins: their edges, or their number over its range.

    The error of a bin is that of batch means: the scatter of the bin's share over stretches of the record. Raises
    RecordTooShort, with the Histogram without errors, if the record has too few stretches, and ValueError for edges
    that do not increase.
    """
    bounds = _edges(values, edges)
    total = HistogramSum(bounds, values.size)
    total.add(values)
    total = HistogramSum(bounds, batch_length(values, tick, "histogram", total.histogram()))
    total.add(values)
    return total.histogram()


def _edges(values: Doubles, edges: ArrayLike | int) -> Doubles:
    if not isinstance(edges, int):
        bounds = np.asarray(edges, dtype=np.float64)
        if bounds.ndim != 1 or bounds.size < 2 or not bool(np.all(np.diff(bounds) > 0.0)):
            raise ValueError("the edges of a histogram must rise")
        return bounds
    low, high = float(values.min()), float(values.max())
    return np.linspace(low, high if high > low else low + 1.0, edges + 1)


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
