"""What the ticks of two segments of a record have to do with each other once they are windowed and transformed."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.births import PoissonBirths
from rubnoise.model import Model
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.quadrature import size_range

Doubles = NDArray[np.float64]
Complex = NDArray[np.complex128]

_NOTHING = 1e-17
_NEARER, _TRIALS = 0.8, 120


def tick_covariance(model: Model, tick: float, count: int) -> Doubles:
    """Return R(j h) in um^4 for j = 0 ... count - 1 ticks of h um."""
    lags = tick * np.arange(count, dtype=np.float64)
    near = lags <= correlation_reach(model)
    covariance = np.zeros(count)
    covariance[near] = autocovariance(model, lags[near])
    return covariance


@lru_cache(maxsize=8)
def correlation_reach(model: Model) -> float:
    """Return a lag in um beyond which R is below 1e-17 R(0); inf unless births are a Poisson process.

    It is the longest life, or less where lives that long are too rare to count: R falls all the way.
    """
    if not isinstance(model.births, PoissonBirths):
        return np.inf
    lags = 2.0 * size_range(model.sizes)[1] * _NEARER ** np.arange(_TRIALS)
    correlated = autocovariance(model, lags) > _NOTHING * autocovariance(model, np.zeros(1))
    return float(lags[max(int(np.argmax(correlated)) - 1, 0)])


def cross_spectrum(covariance: Doubles, window: Doubles, shift: int, *, detrend: bool) -> Complex:
    """Return E[X(k) conj X'(k)] in um^4 at the n // 2 + 1 wavenumbers of a segment of n ticks.

    X(k) = sum_j w_j (x_j - mean x) exp(-2 pi i p j / n) over one segment and X' the same over one that begins ``shift``
    >= 0 ticks later; without ``detrend`` nothing is subtracted, and the record is taken to have mean zero. With C the
    covariance by ticks (zero beyond those given), rho the autocorrelation of the window, W its transform, u and v the
    covariances of a tick with the mean of the other segment:
    sum_tau rho(tau) C(shift - tau) exp(-i k tau) - U conj W - W conj V + mean(u) |W|^2,
    U and V the transforms of w u and w v. Exact, in n log n operations.
    """
    n = window.size
    around = _at(covariance, shift + np.arange(1 - n, n))
    autocorrelation = np.fft.irfft(np.square(np.abs(np.fft.rfft(window, 2 * n))), 2 * n)
    taus = np.arange(1 - n, n)
    products = autocorrelation[np.abs(taus)] * around[::-1]
    folded = np.zeros(n)
    folded[0] = products[n - 1]
    folded[1:] = products[n:] + products[: n - 1]
    plain: Complex = np.fft.rfft(folded)
    if not detrend:
        return plain
    sums = np.cumsum(np.concatenate([np.zeros(1), around]))
    later = (sums[n:] - sums[:n]) / n  # of the ticks of the later segment with the mean of the earlier one
    earlier = later[::-1]
    transform, u, v = (np.fft.rfft(window * part) for part in (np.ones(n), earlier, later))
    return plain - u * transform.conj() - transform * v.conj() + later.mean() * np.square(np.abs(transform))


def bin_covariances(
    covariance: Doubles, window: Doubles, shift: int, bins: NDArray[np.int64], *, detrend: bool
) -> tuple[Complex, Complex]:
    """Return E[X(k) conj X'(k')] and E[X(k) X'(k')] in um^4, matrices over the bins p of k = 2 pi p / (n h).

    X and X' as in `cross_spectrum`, on segments ``shift`` >= 0 ticks apart; exact, by one Toeplitz product a bin.
    """
    n = window.size
    rows = window * np.exp(-2j * np.pi * np.outer(bins, np.arange(n)) / n)
    if detrend:
        rows = rows - rows.mean(axis=1, keepdims=True)
    # Cov(x_j, x'_l) = C(shift + l - j): a circulant of twice the length holds it for every j and l.
    steps = np.concatenate([np.arange(n), [n], np.arange(1 - n, 0)])
    kernel = _at(covariance, shift - steps)
    kernel[n] = 0.0
    carried = np.fft.ifft(np.fft.fft(kernel) * np.fft.fft(rows.conj(), 2 * n, axis=1), axis=1)[:, :n]
    return rows @ carried.T, rows @ carried.conj().T


def _at(covariance: Doubles, lags: NDArray[np.int64]) -> Doubles:
    """Return the covariance at whole lags of either sign, zero beyond those given."""
    steps = np.abs(lags)
    return np.where(steps < covariance.size, covariance[np.minimum(steps, covariance.size - 1)], 0.0)
