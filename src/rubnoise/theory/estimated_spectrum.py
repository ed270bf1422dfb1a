"""The spectrum estimated from ticks: its exact mean, with aliases and leakage, and its scatter.

Read it from above: the covariance of two windowed segments of a record, the mean of a periodogram, and the scatter of
Welch's estimate, bin by bin and over bands of bins.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import pi
from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import Fixed
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.real_numbers import real_number
from rubnoise.tables import fields_as_text
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.quadrature import longest_life, size_rule
from rubnoise.theory.regular_births import are_at_random, need_random_births
from rubnoise.theory.spectrum import spectral_density

_LEAKS, _ALIASES = 16, (0, -1, 1, -2, 2)
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

    It is the longest life, or less if lives that long are too rare to count: R falls all the way.
    """
    if not isinstance(model.births, PoissonBirths):
        return np.inf
    lags = longest_life(model) * _NEARER ** np.arange(_TRIALS)
    correlated = autocovariance(model, lags) > _NOTHING * autocovariance(model, np.zeros(1))
    return float(lags[max(int(np.argmax(correlated)) - 1, 0)])


def cross_spectrum(covariance: Doubles, window: Doubles, shift: int, *, detrend: bool) -> Complexes:
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
    plain: Complexes = np.fft.rfft(folded)
    if not detrend:
        return plain
    sums = np.cumsum(np.concatenate([np.zeros(1), around]))
    later = (sums[n:] - sums[:n]) / n  # of the ticks of the later segment with the mean of the earlier one
    earlier = later[::-1]
    transform, u, v = (np.fft.rfft(window * part) for part in (np.ones(n), earlier, later))
    return plain - u * transform.conj() - transform * v.conj() + later.mean() * np.square(np.abs(transform))


def bin_covariances(
    covariance: Doubles, window: Doubles, shift: int, bins: NDArray[np.int64], *, detrend: bool
) -> tuple[Complexes, Complexes]:
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


def through_window(
    density: Callable[[Doubles], Doubles], step: float, window: NDArray[np.float64], last: int
) -> Doubles:
    """Return the mean of a windowed periodogram at bins 0 ... ``last`` of a record with the two-sided density S(w).

    E[P(w_p)] = sum_q S_a(w_p - q/2 bins) |W_q|^2 / (2 n sum w^2), with W the transform of the window padded to 2 n
    values and S_a(w) = sum_a S(|w + 2 pi a / h|): exact if covariances end before n values of ``step`` h, but for
    what leaks over more than 8 bins and for aliases beyond the second. The record's mean is taken to be 0; a mean that
    is subtracted changes bins 0 and 1. Units are those of the density. Raises Refused for a window that weighs nothing.
    """
    weights = checked_window(window)
    n = weights.size
    energy = np.square(np.abs(np.fft.rfft(weights, 2 * n)))[: _LEAKS + 1] / (2.0 * n * float(weights @ weights))
    kernel = np.concatenate([energy[:0:-1], energy])
    places = np.pi / (n * step) * np.arange(1 - energy.size, 2 * last + energy.size, dtype=np.float64)
    turn = 2.0 * np.pi / step
    folded = sum((density(np.abs(places + alias * turn)) for alias in _ALIASES), np.zeros(places.size))
    return np.convolve(folded, kernel, "valid")[::2]


def checked_window(window: NDArray[np.float64]) -> Doubles:
    """Return the window as doubles; raises Refused if it is not valid."""
    weights = np.asarray(window, dtype=np.float64)
    if weights.ndim != 1 or weights.size < 2 or not weights.any():
        raise Refused("a window needs at least 2 ticks in one row, and not all of them zero")
    return weights


SEGMENTS = 64
"""About how many segments, which half overlap, a record has by default."""

MOST_TICKS = 1 << 18
"""Of one segment, by default and at most: its errors take some ten seconds and a hundred megabytes."""

_SIZES = 32  # an error of an error: seven digits are plenty
_LONGEST = 4  # lengths of a segment beyond which a correlation is left out: a record of a few such lives says nothing
_MOST_BINS = 4096  # a matrix of theirs has 130 MB
_EMPTY_BIN = 1e-13  # of the largest mean: below it a bin holds rounding alone


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Segments:
    """The segments of a record: ``count`` of len(window) ticks of ``tick`` um each, ``step`` ticks from start to start.

    scipy.signal.welch with nperseg n and noverlap m cuts N ticks into 1 + (N - n) // (n - m) segments of step n - m.
    """

    tick: float
    window: Doubles
    count: int
    step: int
    detrend: bool = True

    def __post_init__(self) -> None:
        """Raise Refused for no segment, no step, or a window that is not valid."""
        checked_window(self.window)
        if self.count < 1 or self.step < 1:
            raise Refused("a Welch estimate needs at least 1 segment and a step of at least 1 tick")

    def pairs(self, reach: int) -> list[tuple[int, float]]:
        """Return shifts in ticks up to a reach with their weights, so that Var[mean] = sum of weight times Cov[shift].

        Weights are 1/K at 0 and (2/K)(1 - q/K) at q steps, for K segments.
        """
        apart = range(1, min(self.count, 1 + reach // self.step))
        later = [(q * self.step, 2.0 / self.count * (1.0 - q / self.count)) for q in apart]
        return [(0, 1.0 / self.count), *later]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EstimatedSpectrum:
    """The expectation of Welch's method for the real contact area, and the standard error of one estimate.

    ``density`` is the exact mean of the estimate in um^4 per rad/um, two-sided, at ``wavenumber`` in rad/um: aliases,
    leakage and the removed mean are in it. ``standard_error`` is that of one estimate, in the same unit; inf if the
    bin has no power, nan if it is not known: for births that are not Poisson, and for passes off the centre line.
    ``ticks`` are those of each of the ``segments``.
    """

    model: Model = field(repr=False)
    ticks: int
    segments: int
    wavenumber: Doubles
    density: Doubles
    standard_error: Doubles

    def __repr__(self) -> str:
        return fields_as_text(self)

    def band(self, lowest: ArrayLike, highest: ArrayLike) -> tuple[float, float]:
        """Return the mean of an estimate over the bins from ``lowest`` to ``highest`` rad/um, and its standard error.

        In um^4 per rad/um; neighbouring bins are correlated, which the error allows for. Raises Refused if no bin
        lies there, or more than 4096 do, and for births that are not Poisson.
        """
        low, high = real_number(lowest, "lowest", "rad/um"), real_number(highest, "highest", "rad/um")
        bins = np.flatnonzero((self.wavenumber >= low) & (self.wavenumber <= high))
        if not 1 <= bins.size <= _MOST_BINS:
            raise Refused(f"{bins.size} bins lie from {low:g} to {high:g} rad/um; a band has 1 to {_MOST_BINS}")
        means = self.density[bins]
        covariance = welch_covariance(self.model, _cut(self.model, self.ticks), bins)
        return float(means.mean()), float(np.sqrt(means @ covariance @ means)) / bins.size


def estimated_spectrum(model: Model, ticks: int | None = None) -> EstimatedSpectrum:
    """Return the expectation of Welch's method for a record of the model: every tick from 0 to its distance.

    Segments have ``ticks`` values, half of them shared with the next, under the Hann window sin^2(pi j / n), each less
    its own mean; without ``ticks`` there are about 64 of them. Equations and sources are those of
    `expected_periodogram` and `welch_errors`. Raises Refused for a segment longer than the record or 262 144 ticks.
    """
    cut = _cut(model, ticks)
    wavenumber, density = expected_periodogram(model, cut.tick, cut.window)
    known = are_at_random(model) and model.pulse.offset == "none"
    errors = welch_errors(model, cut)[1] if known else np.full(density.size, np.nan)
    held = np.isfinite(errors)
    return EstimatedSpectrum(
        model=model,
        ticks=cut.window.size,
        segments=cut.count,
        wavenumber=wavenumber,
        density=density,
        standard_error=np.where(held, density * np.where(held, errors, 0.0), errors),
    )


def _cut(model: Model, ticks: int | None) -> Segments:
    record = model.tick_count + 1
    usual = min(max(2, 2 * (record // (SEGMENTS + 1))), MOST_TICKS)
    length = usual if ticks is None else ticks
    if isinstance(length, bool) or not isinstance(length, Integral):
        raise Refused(f"ticks: {length!r:.40}: a segment has a whole number of ticks, such as 256")
    if not 2 <= length <= min(record, MOST_TICKS):
        raise Refused(f"a segment of {length} ticks: it has 2 to {min(record, MOST_TICKS)}, of a record of {record}")
    window = np.square(np.sin(pi * np.arange(length) / length))
    step = max(1, length // 2)
    return Segments(tick=model.tick, window=window, count=(record - length) // step + 1, step=step)


def welch_errors(model: Model, segments: Segments) -> tuple[Doubles, Doubles]:
    """Return wavenumbers k in rad/um and the standard error of the Welch estimate there over its own mean.

    Var[P] / E[P]^2 = sum over pairs of segments of |E[X conj X']|^2 / E[|X|^2]^2 (Gaussian noise; exact for the window,
    the overlap and the spectrum's own slope), plus |E[X X']|^2 / E[|X|^2]^2, which counts at the ends of the axis and
    is taken from the window alone, as for a flat spectrum; plus what few junctions add (see `welch_covariance`). The
    wavenumbers are those of `expected_periodogram`; inf if a bin holds nothing. Raises Refused unless births are a
    Poisson process. Source: Welch (1967), doi:10.1109/TAU.1967.1161901; Isserlis's theorem.
    """
    need_random_births(model, "the error of a spectrum", centred=True)
    window, n = segments.window, segments.window.size
    covariance, reach = _covariance(model, segments)
    mean = cross_spectrum(covariance, window, 0, detrend=segments.detrend).real
    held = mean > _EMPTY_BIN * mean.max()
    variance = np.full(mean.size, np.inf)
    variance[held] = _shot_variance(model, segments, np.flatnonzero(held))
    for shift, weight in segments.pairs(reach):
        ordinary = cross_spectrum(covariance, window, shift, detrend=segments.detrend)
        turned = np.fft.fft(_overlap(window, shift))[2 * np.arange(mean.size) % n] / float(window @ window)
        variance[held] += weight * (np.square(np.abs(ordinary[held]) / mean[held]) + np.square(np.abs(turned[held])))
    return segment_wavenumbers(segments.tick, n), np.sqrt(variance)


def welch_covariance(model: Model, segments: Segments, bins: NDArray[np.int64]) -> Doubles:
    """Return Cov[P(k), P(k')] / (E[P(k)] E[P(k')]) of a Welch estimate over chosen bins p, a matrix.

    The mean over the bins of P / E[P] has the standard error sqrt(matrix.mean()). Bins of one band are correlated by
    the window, by its leakage, and by the junctions that they share:
    |E[X conj X']|^2 + |E[X X']|^2 over the means, summed over the pairs of segments, is exact for Gaussian noise; to it
    comes the fourth cumulant of shot noise, lam E[|A^(k)|^2 |A^(k')|^2] / (S(k) S(k')) times the sum over pairs of
    sum_j w_j^2 w'_j^2 / (h (sum w^2)^2), about 1/(lam T) over a record of T um, for a window that hardly changes over a
    life and leaks little. Raises Refused unless births are a Poisson process.
    Source: Isserlis's theorem; cumulants of filtered shot noise (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    need_random_births(model, "the error of a spectrum", centred=True)
    covariance, reach = _covariance(model, segments)
    energies, probabilities = _energies(model, segments, bins)
    total = _shared_weight(segments) / (model.birth_rate * segments.tick) * (energies * probabilities) @ energies.T
    for shift, weight in segments.pairs(reach):
        ordinary, turned = bin_covariances(covariance, segments.window, shift, bins, detrend=segments.detrend)
        if shift == 0:
            means = ordinary.diagonal().real
            scale = np.outer(means, means)
        both = (np.square(np.abs(ordinary)) + np.square(np.abs(turned))) / scale
        total += 0.5 * weight * (both + both.T)
    return total


def _covariance(model: Model, segments: Segments) -> tuple[Doubles, int]:
    """Return the covariance by ticks, and the largest distance of the starts of two correlated segments."""
    n = segments.window.size
    lags = min(2 + int(correlation_reach(model) / segments.tick), _LONGEST * n)
    return tick_covariance(model, segments.tick, lags), n + lags


def _overlap(window: Doubles, shift: int) -> Doubles:
    """Return w_j w_(j - shift), zero if the two windows do not meet."""
    product = np.zeros_like(window)
    if shift < window.size:
        product[shift:] = window[shift:] * window[: window.size - shift]
    return product


def _shared_weight(segments: Segments) -> float:
    """Return the sum over pairs of segments of sum_j w_j^2 w'_j^2 / (sum w^2)^2: one over the ticks that count."""
    square = np.square(segments.window)
    pairs = segments.pairs(square.size - 1)
    shared = sum(weight * float(_overlap(square, shift).sum()) for shift, weight in pairs)
    return shared / float(square.sum()) ** 2


def _energies(model: Model, segments: Segments, bins: NDArray[np.int64]) -> tuple[Doubles, Doubles]:
    """Return |A^(k)|^2 over its mean, a row a bin and a column a size, and the probabilities of the sizes."""
    diameters, probabilities = size_rule(model.sizes, _SIZES)
    k = segment_wavenumbers(segments.tick, segments.window.size)[bins]
    alone = (replace(model, sizes=Fixed(value=float(d))) for d in diameters)
    energies = np.stack([spectral_density(one, k) for one in alone], axis=-1)
    return energies / (energies @ probabilities)[:, None], probabilities


def _shot_variance(model: Model, segments: Segments, bins: NDArray[np.int64]) -> Doubles:
    energies, probabilities = _energies(model, segments, bins)
    scale = _shared_weight(segments) / (model.birth_rate * segments.tick)
    return scale * np.square(energies) @ probabilities
