"""Welch's estimate of a spectral density, in the convention of all our pages, with its errors, bands and octaves."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from rubnoise.analysis.moments import settled
from rubnoise.answer import Table
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.rows import Rows, column_chunks
from rubnoise.theory.coupling import THIRD, band_numbers, level, third_octaves
from rubnoise.theory.sampling import EstimatedSpectrum, hann
from rubnoise.theory.sizes import COARSE, sizes_of
from rubnoise.theory.unit_pulse import pass_energies

SEGMENTS = 64
_VALUES_AT_ONCE = 1 << 19
_NEIGHBOURS = 32


def welch(chunks: Iterable[Doubles], ticks: int, tick: float) -> EstimatedSpectrum:
    """Return Welch's estimate of a record that comes in pieces; see WelchSum."""
    total = WelchSum(ticks, tick)
    for chunk in chunks:
        total.add(np.asarray(chunk, dtype=np.float64))
    return total.spectrum()


class WelchSum:
    """Welch's estimate of the two-sided S(k) of a stream of values, which may come in pieces of any size.

    S_i = (tick / sum w^2) |sum of w_j (x_j - mean) exp(-2 pi i j / n)|^2, the mean over segments of n ``ticks``, each
    less its own mean, with Hann windows that half overlap; ``tick`` in um. Errors come from the scatter of segments.
    Source: Welch (1967), doi:10.1109/TAU.1967.1161901; the same as scipy.signal.welch(..., return_onesided=False).
    """

    def __init__(self, ticks: int, tick: float) -> None:
        self._window = hann(ticks)
        self._scale = tick / float(np.square(self._window).sum())
        self._tick = tick
        self._rest = np.empty(0)
        self._segments = 0
        self._sums = np.zeros((2, ticks // 2 + 1))

    def add(self, values: Doubles) -> None:
        """Add the next values."""
        row = np.concatenate([self._rest, values])
        step = half_of(self._window.size)
        whole = max(0, (row.size - self._window.size) // step + 1)
        at_once = max(1, _VALUES_AT_ONCE // self._window.size)
        for first in range(0, whole, at_once):
            self._add_segments(row[first * step :], min(at_once, whole - first), step)
        self._rest = row[whole * step :]

    def _add_segments(self, row: Doubles, count: int, step: int) -> None:
        parts = sliding_window_view(row, self._window.size)[: (count - 1) * step + 1 : step]
        waves = np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * self._window, axis=1)
        power = self._scale * (np.square(waves.real) + np.square(waves.imag))
        self._sums += power.sum(axis=0), np.square(power).sum(axis=0)
        self._segments += count

    def spectrum(self) -> EstimatedSpectrum:
        """Return the mean over the segments so far; errors are inf for fewer than two."""
        count, ticks = self._segments, self._window.size
        mean, square = self._sums / max(count, 1)
        spread = np.sqrt(np.maximum(square - mean**2, 0.0) / (count - 1)) if count > 1 else np.full_like(mean, inf)
        return EstimatedSpectrum(
            wavenumber=(2.0 * np.pi / (ticks * self._tick)) * np.arange(ticks // 2 + 1, dtype=np.float64),
            density=mean,
            standard_error=spread * sqrt(float(shared_variance(ticks, max(count, 1), 0)[0])),
            ticks=ticks,
            segments=count,
        )


def half_of(ticks: int) -> int:
    """Return the step in ticks from one segment to the next: half a segment."""
    return max(1, ticks // 2)


def shared_variance(ticks: int, segments: int, neighbours: int = _NEIGHBOURS) -> Doubles:
    """Return the covariance of bins 0, 1, 2, ... ``neighbours`` apart in a Welch estimate, times segments, over S^2.

    For a Gaussian record whose S is flat over the window's width, away from k = 0 and the last bin:
    sum over the segments' distance m of (1 - |m|/K) |sum of w_j w_(j + m step) exp(-2 pi i b j / n)|^2 / (sum w^2)^2,
    b the bins' distance; at b = 0 it is what the segments' overlap adds to their mean square. A real record's own
    fourth cumulant comes on top. Source: Welch (1967), as above.
    """
    window, step = hann(ticks), half_of(ticks)
    norm = float(np.square(window).sum()) ** 2
    bins = np.arange(neighbours + 1) % ticks
    total = np.zeros(neighbours + 1)
    for apart in range(min(segments, -(-ticks // step))):
        product = np.zeros(ticks)
        product[: ticks - apart * step] = window[: ticks - apart * step] * window[apart * step :]
        share = (1.0 if apart == 0 else 2.0) * (1.0 - apart / segments)
        total += share * np.square(np.abs(np.fft.fft(product)[bins])) / norm
    return total


_FIRST_BIN = 3
_MOST_OF_A_BAND = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """The power of a spectrum between two wavenumbers (rad/um), in the square of the record's unit."""

    lowest: float
    highest: float
    observed: float
    expected: float
    standard_error: float
    skewness: float


def band_powers(model: Model, seen: EstimatedSpectrum, expected: Doubles, length: float, count: int) -> list[Band]:
    """Return the power (1/pi) int S dk of up to ``count`` bands, equally wide in the logarithm of k, with their errors.

    ``expected`` is the expectation of ``seen.density``, from a record of ``length`` um of a contact with Poisson
    births. Two parts add up in the variance of a band's power P over its square: that of a Gaussian record, sum over
    the bins of S_i S_j times their covariance (`shared_variance`), and (lam / T) E[(sum of |A^(k_i)|^2)^2] over
    (sum of S_i)^2, the fourth cumulant of shot noise, the same for all bins: junctions are few. The bins next to k = 0,
    which contain the mean, and next to the last are left out. The skewness is that of the second part alone.
    Source: as for `rubnoise.theory.second_order.autocovariance`, for four places at once.
    """
    shared = shared_variance(seen.ticks, seen.segments)
    power, births = float(seen.wavenumber[1]) / pi, model.birth_rate * length
    bands, found = bands_of(seen.density.size, count), []
    if not bands:
        return []
    probabilities, band_energies = _energies(model, seen.wavenumber, bands)
    for part, energies in zip(bands, band_energies, strict=True):
        variance = _gaussian_variance(expected[part], shared) / seen.segments
        first, second, third = (float(probabilities @ energies**power) for power in (1, 2, 3))
        variance += second / first**2 / births
        level = power * float(expected[part].sum())
        found.append(
            Band(
                lowest=float(seen.wavenumber[part[0]]),
                highest=float(seen.wavenumber[part[-1]]),
                observed=power * float(seen.density[part].sum()),
                expected=level,
                standard_error=level * sqrt(variance),
                skewness=third / second**1.5 / sqrt(births),
            )
        )
    return found


def bands_of(size: int, count: int) -> list[NDArray[np.int64]]:
    """Return the bins of up to ``count`` bands of a spectrum, of equal ratio; bands without a bin are left out.

    Bins next to k = 0, which contain the mean, and next to the last are in no band.
    """
    bins = np.arange(_FIRST_BIN, size - 2)
    if not bins.size:
        return []
    edges = np.geomspace(bins[0] - 0.5, bins[-1] + 0.5, count + 1)[1:-1]
    return [part for part in np.split(bins, np.searchsorted(bins, edges)) if part.size]


def _gaussian_variance(expected: Doubles, shared: Doubles) -> float:
    """Return the relative variance of the sum of bins, times the number of segments."""
    pairs = shared[0] * float(expected @ expected)
    for apart in range(1, min(shared.size, expected.size)):
        pairs += 2.0 * shared[apart] * float(expected[apart:] @ expected[:-apart])
    return pairs / float(expected.sum()) ** 2


def _energies(model: Model, wavenumber: Doubles, bands: Sequence[NDArray[np.int64]]) -> tuple[Doubles, Doubles]:
    """Return probabilities of passes by size and offset, and sums of their |A^(k)|^2 over each band, up to a factor.

    Off the centre line the energy depends on the offset, more for shorter waves; there some bins represent many.
    """
    sizes, most = sizes_of(model.sizes, COARSE), wavenumber.size if model.pulse.offset == "none" else _MOST_OF_A_BAND
    some = [part[:: -(-part.size // most)] for part in bands]
    starts, inside = np.cumsum([0, *(part.size for part in some[:-1])]), wavenumber[np.concatenate(some)]
    sums = [
        np.add.reduceat(pass_energies(model.pulse, inside * d)[0], starts, axis=1) * d**6
        for d in sizes.diameter.tolist()
    ]
    shares = pass_energies(model.pulse, np.zeros(1))[1]
    return np.multiply.outer(sizes.probability, shares).ravel(), np.concatenate(sums).T


MOST_ROWS: Final = 1 << 22
"""Rows of /load that are looked at, from where the start is forgotten: more would make a look at a long run slow."""

_SEGMENTS: Final = 16
_MOST_TICKS: Final = 1 << 17
_FEWEST_BINS: Final = 4
_PART_LEFT_OUT: Final = 1e-6  # of the power, 60 dB: as in theory


def heard_bands(rows: Rows, model: Model) -> Table:
    """Return the normal velocity of a run in the third octaves that hold more than 1e-6 of its power.

    frequency: the middles in Hz; level: in dB re 50 nm/s, the integral of Welch's estimate, (1/pi) int S dw; exact: if
    theory knows them. Bands of fewer than 4 of its bins are left out.
    Raises Refused for a run without a load that weighs, and for one too short for any band.
    """
    if "load" not in rows.columns or model.tick_duration is None:
        raise Refused("the normal motion is that under a load that weighs ([load])")
    first = settled(model)["load"] or 0
    count = min(rows.rows("load") - first, MOST_ROWS)
    ticks = min(2 * (count // (_SEGMENTS + 1)), _MOST_TICKS)
    if ticks < 4 * _FEWEST_BINS:
        raise Refused(f"{count} ticks are too few for third octaves")
    spectrum = welch(column_chunks(rows, "load", "velocity", first, first + count), ticks, model.tick_duration)
    width = float(spectrum.wavenumber[1]) / (2.0 * pi)
    edges = width * (np.arange(spectrum.density.size) + 0.5)
    running = np.cumsum(spectrum.density[1:]) * 2.0 * width
    numbers = np.array(band_numbers(_FEWEST_BINS * width / (THIRD - 1.0 / THIRD), edges[-1] / THIRD))
    middles = 10.0 ** (0.1 * numbers)
    upper, lower = (np.interp(middles * side, edges[1:], running) for side in (THIRD, 1.0 / THIRD))
    power, exact = upper - lower, dict[str, Doubles]()
    kept = power > _PART_LEFT_OUT * running[-1]
    with suppress(Refused):
        bands = third_octaves(model)
        known = np.rint(10.0 * np.log10(bands["frequency"]))
        kept &= np.isin(numbers, known)
        exact = {"exact": bands["level"][np.searchsorted(known, numbers[kept])]}
    levels = np.array([level(sqrt(each)) for each in power[kept].tolist()])
    columns = {"frequency": middles[kept], "level": levels} | exact
    return Table(name="third_octaves", columns=columns, units={"frequency": "Hz", "level": "dB", "exact": "dB"})
