"""What a periodogram of ticks shows on average: the spectrum with the aliases and the leakage of its window."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.segments import cross_spectrum, tick_covariance

Doubles = NDArray[np.float64]


def segment_wavenumbers(tick: float, count: int) -> Doubles:
    """Return k = 2 pi p / (n h) in rad/um for p = 0 ... n // 2: where a segment of n ticks of h um is transformed."""
    wavenumbers: Doubles = 2.0 * np.pi / (count * tick) * np.arange(count // 2 + 1, dtype=np.float64)
    return wavenumbers


def expected_periodogram(
    model: Model, tick: float, window: NDArray[np.float64], *, detrend: bool = True
) -> tuple[Doubles, Doubles]:
    """Return wavenumbers k in rad/um and the exact mean of a windowed periodogram of A_r there, in um^4 per rad/um.

    The periodogram is P(k) = h |sum_j w_j (x_j - mean x) exp(-i k j h)|^2 / sum_j w_j^2 over n = len(window) ticks of
    h = ``tick`` um, two-sided like S(k), at k = 2 pi p / (n h), p = 0 ... n // 2. It is the Welch estimate of
    scipy.signal for one segment (fs = 1/h, scaling "density", detrend "constant"), halved, but for p = 0 and, n even,
    p = n / 2; the mean over segments has the same expectation whatever their overlap. Without ``detrend`` nothing is
    subtracted, and the mean of A_r leaks from k = 0 into its neighbours.

    E[P] = (h / sum w^2) w^H C w with C the covariances R(h (j - l)): aliasing, leakage and the removed mean are all in
    it. Rounding leaves an absolute error of some 1e-14 S(0). Raises Refused for a window of fewer than 2 ticks or none
    but zeros. Source: Priestley, Spectral Analysis and Time Series (1981), chapter 6.
    """
    weights = checked_window(window)
    covariance = tick_covariance(model, tick, weights.size)
    energy = cross_spectrum(covariance, weights, 0, detrend=detrend).real
    if not detrend:
        energy += model.stationary_mean_area**2 * np.square(np.abs(np.fft.rfft(weights)))
    density = tick / float(weights @ weights) * energy
    return segment_wavenumbers(tick, weights.size), np.maximum(density, 0.0)


def checked_window(window: NDArray[np.float64]) -> Doubles:
    """Return the window as doubles; raises Refused where it cannot weigh a segment."""
    weights = np.asarray(window, dtype=np.float64)
    if weights.ndim != 1 or weights.size < 2 or not weights.any():
        raise Refused("a window needs at least 2 ticks in one row, and not all of them zero")
    return weights
