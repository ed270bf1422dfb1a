"""The autocovariance of a record in memory, and of a stream at chosen lags or at all lags up to a reach.

numpy's transforms have the bits and the speed of scipy's, and importing scipy takes longer than all of numpy.
"""

from collections.abc import Sequence

import numpy as np

from rubnoise.arrays import Doubles


def autocovariance(values: Doubles, reach: int) -> Doubles:
    """Return the autocovariance of a record at lags of 0 to ``reach`` ticks, in the square of its unit.

    R_j = (1/n) sum over i of (x_i - mean)(x_(i+j) - mean) of n values: dividing by n and not by n - j keeps the noise
    of long lags small, and makes R_j smaller than its expectation by a part j/n, and by the variance of the mean.
    Source: Priestley, Spectral Analysis and Time Series, section 5.3.
    """
    size = _fast_length(values.size + reach)
    power = np.square(np.abs(np.fft.rfft(values - values.mean(), size)))
    return np.asarray(np.fft.irfft(power, size)[: reach + 1] / values.size, dtype=np.float64)


def _fast_length(least: int) -> int:
    """Return the least number from ``least`` on without a prime factor above 5: its transform is fast."""
    found = 1 << (least - 1).bit_length()
    fives = 1
    while fives < found:
        odd = fives
        while odd < found:
            found = min(found, odd << (-(-least // odd) - 1).bit_length())
            odd *= 3
        fives *= 5
    return found


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
        """Add the next values."""
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


_STRETCHES_A_REACH = 4
_SHORTEST = 4096


class CovarianceSum:
    """Autocovariances at lags of 0 to ``reach`` ticks of a stream of values, which may come in pieces of any size.

    ``centre`` is about the mean, so that nothing is lost to cancellation. Memory holds a few times ``reach`` values,
    however long the stream is.
    """

    def __init__(self, reach: int, centre: float) -> None:
        self._reach = reach
        self._centre = centre
        self._stretch = max(_SHORTEST, _STRETCHES_A_REACH * reach)
        self._held: list[Doubles] = []
        self._waiting = 0
        self._head = np.empty(0)
        self._tail = np.zeros(reach)
        self._size = _fast_length(self._stretch + reach)
        self._waves = np.zeros(self._size // 2 + 1, dtype=np.complex128)
        self._count = 0
        self._total = 0.0

    def add(self, values: Doubles) -> None:
        """Add the next values."""
        new = values - self._centre
        if self._head.size < self._reach:
            self._head = np.concatenate([self._head, new[: self._reach - self._head.size]])
        self._count += new.size
        self._total += float(np.add.reduce(new))
        self._held.append(new)
        self._waiting += new.size
        if self._waiting >= self._stretch:
            self._multiply()

    def _multiply(self) -> None:
        """Add the products of values in memory with each other and with earlier ones: an overlap-save correlation."""
        row = np.concatenate([self._tail, *self._held])
        self._held, self._waiting = [], 0
        for first in range(self._reach, row.size, self._stretch):
            part = row[first : first + self._stretch]
            around = row[first - self._reach : first + part.size]
            self._waves += np.conj(np.fft.rfft(part, self._size)) * np.fft.rfft(around, self._size)
        self._tail = row[row.size - self._reach :]

    def covariances(self) -> Doubles:
        """Return the mean of (x_i - mean)(x_(i+j) - mean) over the n - j pairs of each lag j; nan for a lag without."""
        self._multiply()
        products = np.fft.irfft(self._waves, self._size)[self._reach :: -1]
        pairs = np.maximum(self._count - np.arange(self._reach + 1), 0).astype(np.float64)
        mean = self._total / max(self._count, 1)
        head = np.pad(self._head, (0, self._reach - self._head.size))
        missing = np.concatenate([[0.0], np.cumsum(head + self._tail[::-1])])
        ends = 2.0 * self._total - missing
        return (products - mean * ends) / np.where(pairs > 0.0, pairs, np.nan) + mean * mean
