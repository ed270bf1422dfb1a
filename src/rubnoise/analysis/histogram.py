"""The histogram of a record as a density, with errors that know that its ticks are not independent."""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.batch_means import batch_length, error_of_mean
from rubnoise.arrays import Doubles

BINS = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class Histogram:
    """A density over bins: ``edges`` in the unit of the quantity, density and standard error in one over it.

    The density is the mean over its bin; what lies outside of the edges counts in none, so that it adds up to less than
    1 where the edges do not hold all. ``outside`` is that part.
    """

    edges: Doubles
    density: Doubles
    standard_error: Doubles
    outside: float

    @property
    def middles(self) -> Doubles:
        """The middles of the bins."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])


def histogram(values: Doubles, tick: float, edges: ArrayLike | int = BINS) -> Histogram:
    """Return the density of a record of equal ticks (um) over bins: their edges, or how many over its range.

    The error of a bin is that of batch means: how much the share of the bin differs from one stretch of the record to
    the next. Raises RecordTooShort, carrying the Histogram without errors, where the record has too few stretches, and
    ValueError for edges that do not rise.
    """
    bounds = _edges(values, edges)
    width = np.diff(bounds)
    share = np.histogram(values, bounds)[0] / values.size
    found = Histogram(
        edges=bounds,
        density=share / width,
        standard_error=np.full(width.size, inf),
        outside=1.0 - float(share.sum()),
    )
    length = batch_length(values, tick, "histogram", found)
    bins = np.searchsorted(bounds, values, side="right").astype(np.float64) - 1.0
    bins[values == bounds[-1]] = width.size - 1
    error = error_of_mean(bins, length, lambda parts: _shares(parts, width.size))
    return Histogram(edges=bounds, density=found.density, standard_error=error / width, outside=found.outside)


def _edges(values: Doubles, edges: ArrayLike | int) -> Doubles:
    if not isinstance(edges, int):
        bounds = np.asarray(edges, dtype=np.float64)
        if bounds.ndim != 1 or bounds.size < 2 or not bool(np.all(np.diff(bounds) > 0.0)):
            raise ValueError("the edges of a histogram must rise")
        return bounds
    low, high = float(values.min()), float(values.max())
    return np.linspace(low, high if high > low else low + 1.0, edges + 1)


def _shares(parts: Doubles, bins: int) -> Doubles:
    """Return the share of each bin in each stretch, a row a stretch."""
    counts = [np.bincount(row[(row >= 0) & (row < bins)].astype(np.int64), minlength=bins) for row in parts]
    return np.stack(counts) / parts.shape[1]
