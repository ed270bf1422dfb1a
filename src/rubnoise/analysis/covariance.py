"""The autocovariance of a record, and how far it may well be off."""

from collections.abc import Sequence

import numpy as np

from rubnoise.arrays import Doubles


def autocovariance(values: Doubles, reach: int) -> Doubles:
    """Return the autocovariance of a record at lags of 0 to ``reach`` ticks, in the square of its unit.

    R_j = (1/n) sum over i of (x_i - mean)(x_(i+j) - mean) of n values: dividing by n and not by n - j keeps the noise
    of long lags down, and makes R_j smaller than it is expected by a part j/n, and by the variance of the mean.
    Source: Priestley, Spectral Analysis and Time Series, section 5.3.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    size = next_fast_len(values.size + reach, real=True)
    power = np.square(np.abs(rfft(values - values.mean(), size)))
    return np.asarray(irfft(power, size)[: reach + 1] / values.size, dtype=np.float64)


class LaggedProducts:
    """Autocovariances at chosen lags of a stream of values, which may come in pieces of any size.

    Lags are in ticks; ``centre`` is about the mean, so that nothing is lost to cancellation.
    """

    def __init__(self, lags: Sequence[int], centre: float) -> None:
        self._lags = tuple(lags)
        self._centre = centre
        self._tail = np.empty(0)
        self._count = 0
        self._total = 0.0
        self._sums = np.zeros((len(self._lags), 3))

    def add(self, values: Doubles) -> None:
        """Take in the values that follow those before."""
        new = values - self._centre
        known = self._tail.size
        row = np.concatenate([self._tail, new])
        for line, lag in enumerate(self._lags):
            first = max(known - lag, 0)
            earlier, later = row[first : max(first, row.size - lag)], row[first + lag :]
            self._sums[line] += float((earlier * later).sum()), float(earlier.sum()), float(later.sum())
        self._count += new.size
        self._total += float(new.sum())
        self._tail = row[max(0, row.size - max(self._lags, default=0)) :]

    def covariances(self) -> Doubles:
        """Return the mean of (x_i - mean)(x_(i+j) - mean) over the n - j pairs of each lag j; nan for a lag without."""
        mean = self._total / max(self._count, 1)
        pairs = np.array([max(self._count - lag, 0) for lag in self._lags], dtype=np.float64)
        products, earlier, later = self._sums.T
        return (products - mean * (earlier + later)) / np.where(pairs > 0.0, pairs, np.nan) + mean * mean
