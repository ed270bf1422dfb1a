"""How far a Welch estimate of the spectrum of A_r strays from its mean, bin by bin and over bands of bins."""

from dataclasses import dataclass, field, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.laws import Fixed
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.estimated_spectrum import checked_window, expected_periodogram, segment_wavenumbers
from rubnoise.theory.quadrature import size_rule
from rubnoise.theory.random_births import are_at_random, need_random_births
from rubnoise.theory.segments import bin_covariances, correlation_reach, cross_spectrum, tick_covariance
from rubnoise.theory.spectrum import spectral_density

Doubles = NDArray[np.float64]

SEGMENTS = 64
"""About how many segments half overlap in a record where the length of one is not asked for."""

MOST_TICKS = 1 << 18
"""Of one segment, by default and at most: its errors take some ten seconds and a hundred megabytes."""

_SIZES = 32  # an error of an error: seven digits are plenty
_LONGEST = 4  # lengths of a segment beyond which a correlation is left out: a record of a few such lives says nothing
_MOST_BINS = 4096  # a matrix of theirs has 130 MB
_NOTHING = 1e-13  # of the largest mean: below it a bin holds rounding alone


@dataclass(frozen=True, slots=True, kw_only=True)
class Segments:
    """How a record is cut: ``count`` segments of len(window) ticks of ``tick`` um, ``step`` ticks from start to start.

    scipy.signal.welch with nperseg n and noverlap m cuts N ticks into 1 + (N - n) // (n - m) segments of step n - m.
    """

    tick: float
    window: Doubles
    count: int
    step: int
    detrend: bool = True

    def __post_init__(self) -> None:
        """Raise Refused for no segment, no step, or a window that cannot weigh one."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimatedSpectrum:
    """What Welch's method is expected to show of the real contact area, and how far one estimate strays from it.

    ``density`` is the exact mean of the estimate in um^4 per rad/um, two-sided, at ``wavenumber`` in rad/um: aliases,
    leakage and the removed mean are in it. ``standard_error`` is that of one estimate, in the same unit; inf where the
    bin holds nothing, nan for births that are not Poisson. ``ticks`` are those of each of the ``segments``.
    """

    model: Model = field(repr=False)
    ticks: int
    segments: int
    wavenumber: Doubles
    density: Doubles
    standard_error: Doubles

    def band(self, lowest: float, highest: float) -> tuple[float, float]:
        """Return the mean of an estimate over the bins from ``lowest`` to ``highest`` rad/um, and its standard error.

        In um^4 per rad/um; neighbouring bins are correlated, which the error allows for. Raises Refused where no bin
        lies there, or more than 4096 do, and for births that are not Poisson.
        """
        bins = np.flatnonzero((self.wavenumber >= lowest) & (self.wavenumber <= highest))
        if not 1 <= bins.size <= _MOST_BINS:
            raise Refused(f"{bins.size} bins lie from {lowest:g} to {highest:g} rad/um; a band has 1 to {_MOST_BINS}")
        means = self.density[bins]
        covariance = welch_covariance(self.model, _cut(self.model, self.ticks), bins)
        return float(means.mean()), float(np.sqrt(means @ covariance @ means)) / bins.size


def estimated_spectrum(model: Model, ticks: int | None = None) -> EstimatedSpectrum:
    """Return what Welch's method shows of a record of the model: every tick from 0 to its distance.

    Segments have ``ticks`` values, half of them shared with the next, under the Hann window sin^2(pi j / n), each less
    its own mean; without ``ticks`` there are about 64 of them. Equations and sources are those of
    `expected_periodogram` and `welch_errors`. Raises Refused for a segment longer than the record or 262 144 ticks.
    """
    cut = _cut(model, ticks)
    wavenumber, density = expected_periodogram(model, cut.tick, cut.window)
    errors = welch_errors(model, cut)[1] if are_at_random(model) else np.full(density.size, np.nan)
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
    wavenumbers are those of `expected_periodogram`; inf where a bin holds nothing. Raises Refused unless births are a
    Poisson process. Source: Welch (1967), doi:10.1109/TAU.1967.1161901; Isserlis's theorem.
    """
    need_random_births(model, "the error of a spectrum")
    window, n = segments.window, segments.window.size
    covariance, reach = _covariance(model, segments)
    mean = cross_spectrum(covariance, window, 0, detrend=segments.detrend).real
    held = mean > _NOTHING * mean.max()
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
    need_random_births(model, "the error of a spectrum")
    covariance, reach = _covariance(model, segments)
    total = _shot_covariance(model, segments, bins)
    for shift, weight in segments.pairs(reach):
        ordinary, turned = bin_covariances(covariance, segments.window, shift, bins, detrend=segments.detrend)
        if shift == 0:
            means = ordinary.diagonal().real
            scale = np.outer(means, means)
        both = (np.square(np.abs(ordinary)) + np.square(np.abs(turned))) / scale
        total += 0.5 * weight * (both + both.T)
    return total


def _covariance(model: Model, segments: Segments) -> tuple[Doubles, int]:
    """Return the covariance by ticks, and how far apart segments may start and still have something in common."""
    n = segments.window.size
    lags = min(2 + int(correlation_reach(model) / segments.tick), _LONGEST * n)
    return tick_covariance(model, segments.tick, lags), n + lags


def _overlap(window: Doubles, shift: int) -> Doubles:
    """Return w_j w_(j - shift), zero where the two windows do not meet."""
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


def _shot_covariance(model: Model, segments: Segments, bins: NDArray[np.int64]) -> Doubles:
    energies, probabilities = _energies(model, segments, bins)
    scale = _shared_weight(segments) / (model.birth_rate * segments.tick)
    return scale * (energies * probabilities) @ energies.T


def _shot_variance(model: Model, segments: Segments, bins: NDArray[np.int64]) -> Doubles:
    energies, probabilities = _energies(model, segments, bins)
    scale = _shared_weight(segments) / (model.birth_rate * segments.tick)
    return scale * np.square(energies) @ probabilities
