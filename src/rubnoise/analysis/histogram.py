"""The histogram of a record, or of a stream of values, as a density with errors for ticks that are not independent."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.records import FEWEST_BATCHES, batch_length, error_of_mean
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
    width = np.diff(bounds)
    share = np.histogram(values, bounds)[0] / values.size
    error, outside = np.full(width.size, inf), 1.0 - float(share.sum())
    found = Histogram(edges=bounds, density=share / width, standard_error=error, outside=outside)
    length = batch_length(values, tick, "histogram", found)

    def shares(parts: Doubles) -> Doubles:
        return np.stack([np.histogram(part, bounds)[0] for part in parts]) / length

    return replace(found, standard_error=error_of_mean(values, length, shares) / width)


def _edges(values: Doubles, edges: ArrayLike | int) -> Doubles:
    if not isinstance(edges, int):
        bounds = np.asarray(edges, dtype=np.float64)
        if bounds.ndim != 1 or bounds.size < 2 or not bool(np.all(np.diff(bounds) > 0.0)):
            raise ValueError("the edges of a histogram must rise")
        return bounds
    low, high = float(values.min()), float(values.max())
    return np.linspace(low, high if high > low else low + 1.0, edges + 1)


class HistogramSum:
    """The density of a stream of values over bins of one width, which may come in pieces of any size.

    ``batch`` is the number of values of a stretch that is nearly independent of the next: errors come from the scatter
    of such stretches (see `rubnoise.analysis.histogram.histogram`). Except for rounding, a value at an edge counts in
    the bin above it; one at the last edge is outside.
    """

    def __init__(self, edges: Doubles, batch: int) -> None:
        self._edges = edges
        self._batch = batch
        self._counts = np.zeros(edges.size - 1, dtype=np.int64)
        self._stretch = np.zeros_like(self._counts)
        self._shares = np.zeros((2, edges.size - 1))
        self._taken = 0

    def add(self, values: Doubles) -> None:
        """Add the next values."""
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
