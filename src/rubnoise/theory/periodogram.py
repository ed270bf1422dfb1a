"""The spectrum estimated from ticks: its exact mean, with aliases and leakage, and its scatter."""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from numbers import Integral

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Complexes, Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.tables import fields_as_text
from rubnoise.theory.second_order import are_at_random, autocovariance, covariance_reach, need_random_births
from rubnoise.theory.sizes import COARSE, sizes_of
from rubnoise.theory.unit_pulse import energy

_NOTHING = 1e-12  # of the variance, a covariance that is left out
_LEAKS, _ALIASES = 16, (0, -1, 1, -2, 2)


def cross_spectrum(covariance: Doubles, window: Doubles, shift: int) -> Complexes:
    """Return E[X(k) conj X'(k)] in um^4 at the n // 2 + 1 wavenumbers of a segment of n ticks, exactly.

    X(k) = sum_j w_j (x_j - mean x) exp(-2 pi i p j / n), X' the same over a segment that begins ``shift`` >= 0 ticks
    later. C is the covariance by ticks (zero beyond), rho the autocorrelation of the window, W its transform, u and v
    the covariances of a tick with the mean of the other segment, U and V the transforms of w u and w v: sum_tau
    rho(tau) C(shift - tau) exp(-i k tau) - U conj W - W conj V + mean(u) |W|^2.
    """
    n = window.size
    taus = np.arange(1 - n, n)
    steps = np.abs(shift + taus)
    around = np.where(steps < covariance.size, covariance[np.minimum(steps, covariance.size - 1)], 0.0)
    autocorrelation = np.fft.irfft(np.square(np.abs(np.fft.rfft(window, 2 * n))), 2 * n)
    products = autocorrelation[np.abs(taus)] * around[::-1]
    folded = np.append(products[n - 1], products[n:] + products[: n - 1])
    plain: Complexes = np.fft.rfft(folded)
    sums = np.cumsum(np.append(0.0, around))
    later = (sums[n:] - sums[:n]) / n  # of the ticks of the later segment with the mean of the earlier one
    transform, u, v = (np.fft.rfft(window * part) for part in (np.ones(n), later[::-1], later))
    return plain - u * transform.conj() - transform * v.conj() + later.mean() * np.square(np.abs(transform))


def expected_periodogram(model: Model, tick: float, window: NDArray[np.float64]) -> tuple[Doubles, Doubles]:
    """Return wavenumbers k in rad/um and the exact mean of a windowed periodogram of A_r there, in um^4 per rad/um.

    P(k) = h |sum_j w_j (x_j - mean x) exp(-i k j h)|^2 / sum_j w_j^2 over n = len(window) ticks of h = ``tick`` um,
    two-sided like S(k), at k = 2 pi p / (n h), p = 0 ... n // 2: Welch's estimate, with aliases, leakage and the
    removed mean. Raises Refused for a window of fewer than 2 ticks or none but zeros.
    Source: Priestley, Spectral Analysis and Time Series (1981), chapter 6.
    """
    weights = _checked(window)
    covariance = _tick_covariance(model, tick, weights.size)
    power = cross_spectrum(covariance, weights, 0).real
    wavenumber = np.asarray(2.0 * pi * np.fft.rfftfreq(weights.size, tick), dtype=np.float64)
    return wavenumber, np.maximum(tick / float(weights @ weights) * power, 0.0)


def _tick_covariance(model: Model, tick: float, count: int) -> Doubles:
    """Return R(j h) in um^4 for j = 0 ... count - 1 ticks of h um."""
    lags, covariance = tick * np.arange(count, dtype=np.float64), np.zeros(count)
    near = lags <= (covariance_reach(model, _NOTHING) if are_at_random(model) else np.inf)
    covariance[near] = autocovariance(model, lags[near])
    return covariance


def through_window(
    density: Callable[[Doubles], Doubles], step: float, window: NDArray[np.float64], last: int
) -> Doubles:
    """Return the mean of a windowed periodogram at bins 0 ... ``last`` of a record with the two-sided density S(w).

    E[P(w_p)] = sum_q S_a(w_p - q/2 bins) |W_q|^2 / (2 n sum w^2), W the transform of the window padded to 2 n values,
    S_a(w) = sum_a S(|w + 2 pi a / h|): exact for covariances that end within n values of ``step`` h, to 8 bins of
    leakage and two aliases; a mean that is subtracted changes bins 0 and 1. Raises Refused as above.
    """
    weights = _checked(window)
    n = weights.size
    leaked = np.square(np.abs(np.fft.rfft(weights, 2 * n)))[: _LEAKS + 1] / (2.0 * n * float(weights @ weights))
    kernel = np.concatenate([leaked[:0:-1], leaked])
    places = np.pi / (n * step) * np.arange(1 - leaked.size, 2 * last + leaked.size, dtype=np.float64)
    turn = 2.0 * np.pi / step
    folded = sum((density(np.abs(places + alias * turn)) for alias in _ALIASES), np.zeros(places.size))
    return np.convolve(folded, kernel, "valid")[::2]


def _checked(window: NDArray[np.float64]) -> Doubles:
    weights = np.asarray(window, dtype=np.float64)
    if weights.ndim != 1 or weights.size < 2 or not weights.any():
        raise Refused("a window needs at least 2 ticks in one row, and not all of them zero")
    return weights


SEGMENTS = 64  # about how many, which half overlap, a record has by default
MOST_TICKS = 1 << 18  # of one segment: its errors take some ten seconds and a hundred megabytes
_LONGEST = 4  # lengths of a segment beyond which a correlation is left out: a record of a few such lives says nothing
_EMPTY_BIN = 1e-13  # of the largest mean: below it a bin holds rounding alone


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class EstimatedSpectrum:
    """The expectation of Welch's method for the real contact area, and the standard error of one estimate.

    Two-sided ``density`` in um^4 per rad/um at ``wavenumber`` in rad/um, with aliases and leakage; ``standard_error``:
    inf of a bin without power, nan if births are not Poisson or passes off the centre line; ``ticks`` of each of the
    ``segments``.
    """

    ticks: int
    segments: int
    wavenumber: Doubles
    density: Doubles
    standard_error: Doubles

    __repr__ = fields_as_text


def estimated_spectrum(model: Model, ticks: int | None = None) -> EstimatedSpectrum:
    """Return the expectation of Welch's method for a record of the model: every tick from 0 to its distance.

    Segments of ``ticks`` values half overlap, under the Hann window sin^2(pi j / n), each less its own mean; without
    ``ticks`` there are about 64. Raises Refused for a segment longer than the record or 262 144 ticks.
    """
    record = model.tick_count + 1
    usual = min(max(2, 2 * (record // (SEGMENTS + 1))), MOST_TICKS)
    length = usual if ticks is None else ticks
    if isinstance(length, bool) or not isinstance(length, Integral):
        raise Refused(f"ticks: {length!r:.40}: a segment has a whole number of ticks, such as 256")
    if not 2 <= length <= min(record, MOST_TICKS):
        raise Refused(f"a segment of {length} ticks: it has 2 to {min(record, MOST_TICKS)}, of a record of {record}")
    window = np.square(np.sin(pi * np.arange(length) / length))
    step = max(1, int(length) // 2)
    count = (record - int(length)) // step + 1
    wavenumber, density = expected_periodogram(model, model.tick, window)
    errors = np.full(density.size, np.nan)
    if are_at_random(model) and model.pulse.offset == "none":
        errors = np.where(density > 0.0, density, 1.0) * welch_errors(model, window, count, step)
    return EstimatedSpectrum(int(length), count, wavenumber, density, errors)


def welch_errors(model: Model, window: Doubles, count: int, step: int) -> Doubles:
    """Return the standard error of a Welch estimate over its own mean, ``count`` segments ``step`` ticks apart.

    Var[P] / E[P]^2 is the sum over pairs of segments of |E[X conj X']|^2 / E[|X|^2]^2, of |E[X X']|^2 / E[|X|^2]^2,
    which counts at the ends of the axis and is taken from the window alone, and of the fourth cumulant E[|A^|^4]/(lam
    E[|A^|^2]^2) times sum_j w_j^2 w'_j^2 / (h (sum w^2)^2). inf if a bin holds nothing. Raises Refused unless births
    are a Poisson process.
    Source: Welch (1967), doi:10.1109/TAU.1967.1161901; Isserlis's theorem; Rice (1944).
    """
    need_random_births(model, "the error of a spectrum")
    if model.pulse.offset != "none":
        raise Refused("the error of a spectrum is known for passes through both centres alone (pulse.offset)")
    n, energy_of_window = window.size, float(window @ window)
    lags = min(2 + int(covariance_reach(model, _NOTHING) / model.tick), _LONGEST * n)
    covariance = _tick_covariance(model, model.tick, lags)
    mean = cross_spectrum(covariance, window, 0).real
    held = mean > _EMPTY_BIN * mean.max()
    variance, shared = np.where(held, 0.0, np.inf), 0.0
    for apart in range(min(count, 1 + (n + lags) // step)):
        shift, weight = apart * step, (2.0 if apart else 1.0) / count * (1.0 - apart / count)
        product = np.zeros(n)
        product[shift:] = window[shift:] * window[: max(n - shift, 0)]
        ordinary = cross_spectrum(covariance, window, shift)[held] / mean[held]
        turned = np.fft.fft(product)[2 * np.arange(mean.size) % n][held] / energy_of_window
        variance[held] += weight * (np.square(np.abs(ordinary)) + np.square(np.abs(turned)))
        shared += weight * float(product @ product) / energy_of_window**2
    scatter = _scatter(model, 2.0 * pi * np.fft.rfftfreq(n, model.tick)[held])
    variance[held] += shared / (model.birth_rate * model.tick) * scatter
    return np.sqrt(variance)


def _scatter(model: Model, wavenumber: Doubles) -> Doubles:
    """Return E[|A^|^4] / E[|A^|^2]^2 at each wavenumber."""
    sizes, mean, fourth = sizes_of(model.sizes, COARSE), np.zeros(wavenumber.size), np.zeros(wavenumber.size)
    for diameter, share in zip(sizes.diameter.tolist(), sizes.probability.tolist(), strict=True):
        own = diameter**6 * energy(model.pulse, wavenumber * diameter)
        mean, fourth = mean + share * own, fourth + share * np.square(own)
    return fourth / np.square(mean)
