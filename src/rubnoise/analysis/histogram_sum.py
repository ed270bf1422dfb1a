"""The histogram of a stream of values between fixed edges, with errors from stretches of it."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.batch_means import FEWEST_BATCHES
from rubnoise.analysis.histogram import Histogram
from rubnoise.arrays import Doubles


class HistogramSum:
    """The density of a stream of values over bins of one width, which may come in pieces of any size.

    ``batch`` is how many values make a stretch that is as good as independent of the next: from the differences
    between such stretches come the errors (see `rubnoise.analysis.histogram.histogram`). A value at an edge counts
    above it, but for rounding; one at the last edge is outside.
    """

    def __init__(self, edges: Doubles, batch: int) -> None:
        self._edges = edges
        self._batch = batch
        self._counts = np.zeros(edges.size - 1, dtype=np.int64)
        self._stretch = np.zeros_like(self._counts)
        self._shares = np.zeros((2, edges.size - 1))
        self._taken = 0

    def add(self, values: Doubles) -> None:
        """Take in the values that follow those before."""
        bins = self._bins_of(values)
        first = 0
        while first < values.size:
            room = self._batch - self._taken % self._batch
            self._add_to_stretch(bins[first : first + room])
            first += room

    def _bins_of(self, values: Doubles) -> NDArray[np.int64]:
        """Return 1 + the bin of each value, 0 and one more than the bins for those outside."""
        count = self._edges.size - 1
        places = (values - self._edges[0]) * (count / (self._edges[-1] - self._edges[0]))
        places += 1.0
        # Cut off below at 0, where truncating is rounding down.
        return np.clip(places, 0.0, count + 1.0, out=places).astype(np.int64)

    def _add_to_stretch(self, bins: NDArray[np.int64]) -> None:
        counts = np.bincount(bins, minlength=self._counts.size + 2)[1:-1]
        self._counts += counts
        self._stretch += counts
        self._taken += bins.size
        if self._taken % self._batch == 0:
            share = self._stretch / self._batch
            self._shares += share, np.square(share)
            self._stretch[:] = 0

    def histogram(self) -> Histogram:
        """Return the density so far; errors are inf before the thirtieth stretch is complete."""
        width = np.diff(self._edges)
        share = self._counts / max(self._taken, 1)
        return Histogram(
            edges=self._edges,
            density=share / width,
            standard_error=self._error() / width,
            outside=1.0 - float(share.sum()),
        )

    def _error(self) -> Doubles:
        stretches = self._taken // self._batch
        if stretches < FEWEST_BATCHES:
            return np.full(self._counts.size, inf)
        mean, square = self._shares / stretches
        return np.sqrt(np.maximum(square - mean**2, 0.0) / (stretches - 1))
