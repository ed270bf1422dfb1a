"""The tapered periodogram of a trace in bands, and the expectation of each band.

A record is cut into equal segments (one, if it is not long); each is tapered at both ends and transformed, and the
energy is averaged over the segments and over the wavenumbers of a band.
"""

from dataclasses import dataclass, field
from math import ceil, pi
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, Integers
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.inference.passes import OPEN, Sensor
from rubnoise.inference.populations import EnergyTable

TAPER: Final = 0.1  # part of a segment over which the taper rises and falls
MOST_SAMPLES: Final = 1 << 20  # of one segment: memory grows with it

FIRST_BIN: Final = 2
_TAPER_BINS = 4.0
_WIDENING = 0.05  # of the wavenumber
MOST_BANDS: Final = 400
_WIDEST_PHASE = 0.8  # of k d: the spectrum of equal sizes swings with a period of pi
_FOLLOWED_FOLDS = 24
_FOLDS = 3  # aliases that are taken from the table, on either side; those beyond from the tail
_NODES, _WEIGHTS = np.array([-0.7745966692414834, 0.0, 0.7745966692414834]), np.array([5.0, 8.0, 5.0]) / 18.0


def tukey(count: int) -> Doubles:
    """Return a taper of ``count`` samples, flat except for cosines of 5 % of the samples at either end."""
    rise = max(int(0.5 * TAPER * count), 1)
    ramp = 0.5 * (1.0 - np.cos(pi * (np.arange(rise) + 0.5) / rise))
    window = np.ones(count)
    window[:rise] = ramp
    window[count - rise :] = ramp[::-1]
    return window


@dataclass(frozen=True, slots=True, kw_only=True)
class Bands:
    """A periodogram in bands, distances in ticks: k = 2 pi p / n per tick for bins p of segments of n samples.

    ``masked`` are ranges in cycles per tick that are left out; ``mean_variance`` is the factor by which strokes of both
    ways raise the variance of the mean, if one way has more. ``first`` and ``last`` are the bins of each band;
    ``energy`` the mean of sum-of-squares-normalised |X|^2 over its ``bins`` bins and all ``segments``, in the trace's
    unit squared per (rad/tick), two-sided; ``variance_factor`` is the factor by which the taper raises the variance of
    sums over many bins; ``curvature`` turns d2S/dk2 into the leakage; ``mean_part`` is the part of S(0) that leaves
    each band with the record's mean; ``power`` has all bins from 0 on.
    """

    samples: int
    segments: int
    first: Integers
    last: Integers
    bins: Integers
    energy: Doubles
    variance_factor: float
    curvature: float
    mean_part: Doubles
    power: Doubles = field(repr=False)
    masked: tuple[tuple[float, float], ...] = ()
    mean_variance: float = 1.0

    @property
    def wavenumber(self) -> Doubles:
        """The middle of each band, in rad per tick."""
        return pi * (self.first + self.last) / self.samples

    @property
    def span(self) -> int:
        """Number of samples in the periodogram."""
        return self.samples * self.segments

    @property
    def weight(self) -> Doubles:
        """Number of independent values that each band is worth."""
        return np.maximum(self.bins * self.segments / self.variance_factor, 1.0)


def band_edges(samples: int, phase_per_bin: float) -> Integers:
    """Return the first bin of each band, and one beyond the last: bands are wider at higher k, up to 0.8 of k d.

    ``phase_per_bin`` is k d of the first bin, as far as d is known. If that makes more bands than their covariance
    can be computed for, they are wider: a band's expectation is exact at any width.
    """
    edges = [FIRST_BIN]
    most = max(1, int(_WIDEST_PHASE / phase_per_bin), samples // (2 * MOST_BANDS))
    end = samples // 2  # the last bin of an even record has no neighbour, and half the freedom
    while edges[-1] < end:
        edges.append(edges[-1] + min(max(1, int(_WIDENING * edges[-1])), most))
    edges[-1] = end
    return np.array(edges if len(edges) < 3 or end - edges[-2] > 1 else [*edges[:-2], end])


def banded(
    values: Doubles,
    diameter: float,
    masked: tuple[tuple[float, float], ...] = (),
    ways: tuple[int, int] = (1, 0),
) -> Bands:
    """Return the periodogram of a trace less its mean; ``diameter`` in ticks determines how narrow its bands are.

    ``masked`` are ranges in cycles per tick that are left out; ``ways`` is the number of strokes of equal length, to
    and fro, and each way has lost its own mean.
    """
    from scipy.fft import rfft

    strokes, both = sum(ways), min(ways) > 0
    segments = strokes * ceil(values.size / strokes / MOST_SAMPLES)
    n = values.size // segments
    window = tukey(n)
    square = float(window @ window)
    mean = float(values.mean())
    power = np.zeros(n // 2 + 1)
    for number in range(segments):
        part = rfft((values[number * n : (number + 1) * n] - mean) * window)
        power += np.square(part.real) + np.square(part.imag)
    power /= segments * square
    kept = np.where(masked_bins(masked, n), 0.0, 1.0)
    edges = band_edges(n, 2.0 * pi / n * diameter)
    counts = np.add.reduceat(kept[: edges[-1]], edges[:-1])
    used = counts > 0.0
    first, last = edges[:-1][used], edges[1:][used] - 1
    totals = np.add.reduceat((power * kept)[: edges[-1]], edges[:-1])[used]
    of_mean = np.square(np.abs(rfft(window))) / (square * n * segments) * (2.0 if both else 1.0)
    mean_part = (np.add.reduceat(of_mean[: edges[-1]], edges[:-1]) / np.diff(edges))[used]
    return Bands(
        samples=n,
        segments=segments,
        first=first,
        last=last,
        bins=counts[used].astype(np.int64),
        energy=totals / counts[used],
        variance_factor=float(n * np.sum(window**4) / square**2),
        curvature=float(0.5 * np.sum(np.square(np.diff(window))) / square),
        mean_part=mean_part,
        power=power,
        masked=masked,
        mean_variance=0.25 * strokes * (1.0 / ways[0] + 1.0 / ways[1]) if both else 1.0,
    )


def masked_bins(masked: tuple[tuple[float, float], ...], samples: int) -> NDArray[np.bool_]:
    """Return which bins lie in ranges in cycles per tick, or so close that the taper leaks into them."""
    cycles = np.arange(samples // 2 + 1) / samples
    within = np.zeros(cycles.size, dtype=np.bool_)
    for low, high in masked:
        within |= (cycles >= low - _TAPER_BINS / samples) & (cycles <= high + _TAPER_BINS / samples)
    return within


class Expectation:
    """The expectation of each band for a Poisson population of one strength: the parts common to all populations."""

    def __init__(self, bands: Bands, pulse: Pulse = LENS, sensor: Sensor = OPEN) -> None:
        """Choose the wavenumbers at which spectra are computed: three in each band, with their aliases."""
        width = (bands.last + 1 - bands.first).astype(np.float64)
        middle = 0.5 * (bands.first + bands.last)
        bins = middle[:, None] + 0.5 * width[:, None] * _NODES
        one = width < 2.0
        bins[one] = middle[one, None]
        k = 2.0 * pi / bands.samples * bins
        turns = 2.0 * pi * np.arange(-_FOLDS, _FOLDS + 1)
        self._bands = bands
        self._wavenumbers: Doubles = k
        self._aliases: Doubles = np.abs(k[None] + turns[turns != 0.0][:, None, None])
        self._passed, self._passed_aliases = sensor.energy(k), sensor.energy(self._aliases)
        self._passed_slope, self._passed_bend = sensor.slopes(k)
        self._tail = _tail_beyond(k, pulse.tail[1], sensor) @ _WEIGHTS

    def population(self, table: EnergyTable, diameter: float) -> Doubles:
        """Return the bands' means for E[psi^2] lam = 1, and their derivatives by ln d and by the shape: a row each.

        S(k) = d^6 e(k d) |H(k)|^2 summed over aliases, d the mean diameter in ticks; with its own curvature for
        leakage, and less the power that the removed mean takes.
        """
        seen, passed = table.at(self._wavenumbers * diameter), self._passed
        near = seen * passed
        far = (table.at(self._aliases * diameter) * self._passed_aliases).sum(axis=1)
        total = near + far
        size = diameter**6
        energy = total[0] @ _WEIGHTS
        by_log_diameter = total[1] @ _WEIGHTS
        by_shape = total[3] @ _WEIGHTS
        # d2S/dk2 = (S'' - S') / k^2, primes by ln k, of the product e |H|^2; aliases bend too little to count.
        first = near[1] + seen[0] * self._passed_slope
        second = near[2] + 2.0 * seen[1] * self._passed_slope + seen[0] * self._passed_bend
        bend = ((second - first) / np.square(self._wavenumbers)) @ _WEIGHTS
        tail = table.tail * self._tail / diameter**table.power
        mean = size * (energy + self._bands.curvature * bend + tail - self._bands.mean_part * table.zero)
        slope = size * (by_log_diameter - table.power * tail) + 6.0 * mean
        shape = size * (by_shape + table.tail_by_shape * self._tail / diameter**table.power)
        shape -= size * self._bands.mean_part * table.zero_by_shape
        return np.stack([mean, slope, shape])

    def drift(self) -> Doubles:
        """Return the bands' means for a random walk with steps of variance 1: 1 / (4 sin^2(k/2)), with its leakage."""
        plain = (0.25 / np.square(np.sin(0.5 * self._wavenumbers))) @ _WEIGHTS
        return plain * _walk_leakage(self._bands)


def _tail_beyond(k: Doubles, power: int, sensor: Sensor) -> Doubles:
    """Return the sum over whole m beyond the aliases of the table, of either sign, of |H|^2 / (k + 2 pi m)^p."""
    from scipy.special import zeta

    turn, last, found = 2.0 * pi, _FOLLOWED_FOLDS + 1.0, np.zeros_like(k)
    for m in range(_FOLDS + 1, _FOLLOWED_FOLDS + 1):
        for there in (turn * m + k, turn * m - k):
            found += sensor.energy(there) / there**power
    rest = zeta(float(power), last + k / turn) + zeta(float(power), last - k / turn)
    return found + sensor.energy(np.full_like(k, turn * last)) * rest / turn**power


_WALK_POINTS = 4096
_WALK_BINS = 200


def _walk_leakage(bands: Bands) -> Doubles:
    """Return the leakage of a random walk into each band, beyond the power at its own wavenumbers.

    A walk has no spectrum; X(p) = sum over steps m of e_m T_m(p), with T_m the transform of the window from m on, less
    that of the removed mean. Found on a coarse grid for the lowest bins; at higher bins it is the leakage of the taper.
    """
    points = min(bands.samples, _WALK_POINTS)
    window = tukey(points)
    most = min(_WALK_BINS, points // 8)
    bins = np.arange(1, most + 1)
    waves = window * np.exp(-2j * pi * np.outer(bins, np.arange(points)) / points)
    after = np.cumsum(waves[:, ::-1], axis=1)[:, ::-1]
    after -= waves.sum(axis=1, keepdims=True) * (1.0 - np.arange(points) / points)
    seen = np.sum(np.square(np.abs(after)), axis=1) / float(window @ window)
    ratio = seen * 4.0 * np.square(np.sin(pi * bins / points))
    middle = 0.5 * (bands.first + bands.last)
    return np.interp(middle, bins, ratio)
