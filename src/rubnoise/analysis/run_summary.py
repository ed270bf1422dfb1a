"""The summary of a run without a trace: its figures, distribution, spectrum and autocovariance.

The model determines the places of these curves before the run, so they are equal for all replicates and for theory.
"""

from contextlib import suppress
from dataclasses import replace
from math import ceil, floor, log2
from typing import Any, Final

import numpy as np

from rubnoise.analysis.figures import summarise
from rubnoise.analysis.findings import attributes_of
from rubnoise.analysis.measured import AreaNoise, Measured
from rubnoise.analysis.moments import FEWEST_LIVES, covariance_errors, over_ticks
from rubnoise.analysis.records import HistogramSum
from rubnoise.analysis.spectra import band_powers, bands_of
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.rows import Columns
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.theory.sampling import expected_periodogram, hann
from rubnoise.theory.second_order import are_at_random, area_noise, autocovariance, spectral_density

BINS: Final = 64
BANDS: Final = 128
LAGS: Final = 128
"""Numbers that a summary keeps of a histogram, a spectrum and an autocovariance."""

_STDS: Final = 8.0
_LIVES_A_REACH: Final = 2.0
_LIVES_A_SEGMENT: Final = 64.0
_FEWEST_SEGMENTS: Final = 8
_MOST_TICKS_A_LIFE: Final = 1024
_FEWEST_TICKS: Final = 16
_ROUNDING: Final = 1e-6
_CORRELATIONS_A_BATCH: Final = 10.0


def _edges(model: Model) -> Doubles:
    """Return edges within eight standard deviations of the exact mean, and none far below 0, where no area is."""
    area = area_cumulants(model)
    reach = max(_STDS * area.std, _ROUNDING * area.mean)
    # What is left of a sum whose junctions have all ended may lie below 0 by a rounding.
    low = max(area.mean - reach, -_ROUNDING * reach)
    return np.linspace(low, area.mean + reach, BINS + 1)


def _correlation_length(model: Model) -> float:
    """Return the length in um that is worth one independent value for a mean, S(0)/R(0); a life for regular births."""
    variance = area_cumulants(model).variance
    if not are_at_random(model) or variance == 0.0:
        return model.mean_life_distance
    return float(spectral_density(model, 0.0)) / variance


CURVES: Final = {"histogram": BINS, "histogram_standard_error": BINS, "spectrum": BANDS, "autocovariance": LAGS}
"""The curves of a summary, and how many numbers each has; those left over are nan."""


class SummarySink(Measured):
    """A sink that sums up a run from its rows; its memory does not grow with the run.

    The spectrum and the autocovariance are of every ``stride``-th tick, so that fine ticks do not cost more; the bands
    of the spectrum are of equal ratio, but at least one bin.
    """

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        first = self.first["trace"]
        # What is left after an empty start; all of a run too short to forget it.
        self._part = part = over_ticks(model, model.tick_count + 1 - first) if first else model
        stride = max(1, floor(part.mean_life_distance / part.tick / _MOST_TICKS_A_LIFE))
        ticks, life = part.tick_count // stride + 1, part.mean_life_distance / (stride * part.tick)
        reach = max(1, min(round(_LIVES_A_REACH * life), ticks // _FEWEST_SEGMENTS))
        lags = np.arange(0, reach + 1, ceil((reach + 1) / LAGS), dtype=np.int64)
        # A power of two: 64 lives, or fewer if a run had less than eight segments.
        most = min(_LIVES_A_SEGMENT * life, 2.0 * ticks / (_FEWEST_SEGMENTS + 1))
        segment = max(_FEWEST_TICKS, 2 ** floor(log2(max(most, 1.0))))
        self._segments = max(0, (ticks - segment) // (segment // 2) + 1)
        self._bands = bands_of(segment // 2 + 1, BANDS) if self._segments else []
        self._noise = AreaNoise(part, first, stride, segment, lags)
        self._histogram = HistogramSum(
            _edges(part), ceil(_CORRELATIONS_A_BATCH * _correlation_length(part) / part.tick)
        )

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of a group (see Sink)."""
        super().write(group, first_row, columns)
        if group == "trace":
            area = columns["real_contact_area"]
            self._histogram.add(area[self.skipped(group, first_row, columns) :])
            self._noise.add(first_row, area)

    def finish(self) -> dict[str, Any]:
        """Return the attributes of the figures of the rows so far, and the CURVES of real contact area by name.

        These are in um^-2, um^4 per rad/um and um^4; `theory` returns their places and expected values.
        """
        histogram = self._histogram.histogram()
        curves = {
            "histogram": histogram.density,
            "histogram_standard_error": histogram.standard_error,
            "spectrum": self._banded(self._noise.spectrum.spectrum().density),
            "autocovariance": self._noise.products.covariances(),
        }
        figures = attributes_of(summarise(self))
        return {**figures, **{name: _filled_up(values, CURVES[name]) for name, values in curves.items()}}

    def theory(self) -> dict[str, Doubles]:
        """Return place, expected values and standard errors of the curves of a model's runs; nan if theory gives none.

        Places are in um^2, rad/um and um. The histogram's errors come from each run, since theory has none. There are
        no expected values for a run that starts empty, and is too short to forget that.
        """
        found = dict[str, Doubles]()
        places = {
            "histogram": (self._histogram.histogram().middles, self._expected_shares),
            "spectrum": (self._banded(self._noise.spectrum.spectrum().wavenumber), self._expected_spectrum),
            "autocovariance": (self._noise.lags, self._expected_covariance),
        }
        for name, (place, theory) in places.items():
            expected = error = np.empty(0)
            if self._part.start == "stationary":
                with suppress(Refused):
                    expected, error = theory()
            parts = {"place": place, "expected": expected, "standard_error": error}
            found |= {f"{name}_{part}": _filled_up(values, CURVES[name]) for part, values in parts.items()}
        del found["histogram_standard_error"]  # which each run has
        return found

    def _banded(self, values: Doubles) -> Doubles:
        """Return the mean of a spectrum over each band."""
        return np.array([values[bins].mean() for bins in self._bands])

    def _expected_shares(self) -> tuple[Doubles, Doubles]:
        """Return the expected density of each bin, the exact probability over the width."""
        edges = _edges(self._part)
        return np.diff(np.asarray(distribution(self._part).cdf(edges))) / np.diff(edges), np.empty(0)

    def _expected_spectrum(self) -> tuple[Doubles, Doubles]:
        """Return the mean expected density of each band, aliases and leakage included, and its standard error."""
        shown = replace(self._noise.spectrum.spectrum(), segments=self._segments)
        _, expected = expected_periodogram(self._part, self._noise.step, hann(shown.ticks))
        means = self._banded(expected)
        if not means.size or not _has_errors(self._part):
            return means, np.empty(0)
        powers = band_powers(self._part, shown, expected, self._part.distance, BANDS)
        return means, means * np.array([(band.standard_error / band.expected) for band in powers])

    def _expected_covariance(self) -> tuple[Doubles, Doubles]:
        """Return the expected autocovariance about the record's own mean, and its standard error."""
        part, lags = self._part, self._noise.lags
        expected = autocovariance(part, lags) - area_noise(part).variance_of_mean()
        if not _has_errors(part):
            return expected, np.empty(0)
        return expected, covariance_errors(part, lags, part.distance, self._noise.step)


def _filled_up(values: Doubles, count: int) -> Doubles:
    """Return values filled with nan up to a count, and with nan in place of infinite ones."""
    finite = np.where(np.isfinite(values), values, np.nan)
    return np.pad(finite, (0, count - values.size), constant_values=np.nan)


FEWEST_TICKS_A_LIFE = 8
"""Ticks to a mean life below which errors of autocovariance and spectrum, made for a continuous record, do not hold."""


def _has_errors(model: Model) -> bool:
    """Whether a spectrum and an autocovariance have errors: for a long run, random births and fine ticks."""
    life = model.mean_life_distance
    return (
        are_at_random(model)
        and model.distance >= FEWEST_LIVES * life >= FEWEST_LIVES * FEWEST_TICKS_A_LIFE * model.tick
    )
