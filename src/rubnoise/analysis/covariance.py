"""The autocovariance of a record in memory, and of a stream, at all lags up to a reach.

numpy's transforms have the bits and the speed of scipy's, and importing scipy takes longer than all of numpy.
"""

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
    """Return the least power of two from ``least`` on, whose transform is fast."""
    return 1 << (least - 1).bit_length()


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
