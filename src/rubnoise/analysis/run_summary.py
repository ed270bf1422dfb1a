"""The summary of a run without a trace: its figures, distribution, spectrum and autocovariance.

The model determines the places of these curves before the run, so they are equal for all replicates and for theory.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil, floor, log2
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.figures import summarise
from rubnoise.analysis.findings import attributes_of
from rubnoise.analysis.measured import AreaNoise, Measured
from rubnoise.analysis.moments import FEWEST_LIVES, covariance_errors, stationary_part
from rubnoise.analysis.records import HistogramSum
from rubnoise.analysis.spectra import WelchSum, band_powers, bands_of, hann
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.theory.sampling import expected_periodogram
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


@dataclass(frozen=True, slots=True, kw_only=True)
class RunLayout:
    """Edges of a histogram in um^2, lags and segments for every ``stride``-th tick, and ticks of an independent batch.

    ``lags`` and ``segment`` count those ticks, ``step`` um apart, so that fine ticks do not cost more. ``bands`` are
    the bins of each band of a spectrum: of equal ratio, but at least one bin.
    """

    edges: Doubles
    batch: int
    stride: int
    step: float
    lags: NDArray[np.int64]
    segment: int
    segments: int
    bands: tuple[NDArray[np.int64], ...]

    @classmethod
    @lru_cache(maxsize=8)
    def of(cls, model: Model) -> "RunLayout":
        """Return the layout that suits a model: no part of it grows with the length of its runs."""
        stride = max(1, floor(model.mean_life_distance / model.tick / _MOST_TICKS_A_LIFE))
        ticks, life = model.tick_count // stride + 1, model.mean_life_distance / (stride * model.tick)
        reach = max(1, min(round(_LIVES_A_REACH * life), ticks // _FEWEST_SEGMENTS))
        # A power of two: 64 lives, or fewer if a run had less than eight segments.
        most = min(_LIVES_A_SEGMENT * life, 2.0 * ticks / (_FEWEST_SEGMENTS + 1))
        segment = max(_FEWEST_TICKS, 2 ** floor(log2(max(most, 1.0))))
        segments = max(0, (ticks - segment) // (segment // 2) + 1)
        return cls(
            edges=_edges(model),
            batch=ceil(_CORRELATIONS_A_BATCH * _correlation_length(model) / model.tick),
            stride=stride,
            step=stride * model.tick,
            lags=np.arange(0, reach + 1, ceil((reach + 1) / LAGS), dtype=np.int64),
            segment=segment,
            segments=segments,
            bands=tuple(bands_of(segment // 2 + 1, BANDS)) if segments else (),
        )

    def banded(self, values: Doubles) -> Doubles:
        """Return the mean of a spectrum over each band."""
        return np.array([values[bins].mean() for bins in self.bands])


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
    """A sink that sums up a run from its rows; its memory does not grow with the run."""

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self._layout = layout = RunLayout.of(stationary_part(model))
        self._histogram = HistogramSum(layout.edges, layout.batch)
        self._noise = AreaNoise(model, self.first["trace"], layout.stride, layout.segment, layout.lags)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of a group (see Sink)."""
        super().write(group, first_row, columns)
        if group == "trace":
            area = columns["real_contact_area"]
            self._histogram.add(area[self.skipped(group, first_row, columns) :])
            self._noise.add(first_row, area)

    def finish(self) -> dict[str, Any]:
        """Return the attributes of the figures of the rows so far, and the CURVES of real contact area by name.

        These are in um^-2, um^4 per rad/um and um^4; `curve_theory` returns their places and expected values.
        """
        histogram = self._histogram.histogram()
        curves = {
            "histogram": histogram.density,
            "histogram_standard_error": histogram.standard_error,
            "spectrum": self._layout.banded(self._noise.spectrum.spectrum().density),
            "autocovariance": self._noise.products.covariances(),
        }
        figures = attributes_of(summarise(self))
        return {**figures, **{name: _filled_up(values, CURVES[name]) for name, values in curves.items()}}


def _filled_up(values: Doubles, count: int) -> Doubles:
    """Return values filled with nan up to a count, and with nan in place of infinite ones."""
    finite = np.where(np.isfinite(values), values, np.nan)
    return np.pad(finite, (0, count - values.size), constant_values=np.nan)


FEWEST_TICKS_A_LIFE = 8
"""Ticks to a mean life below which errors of autocovariance and spectrum, made for a continuous record, do not hold."""


@lru_cache(maxsize=8)
def curve_theory(model: Model) -> dict[str, Doubles]:
    """Return place, expected values and standard errors of the curves of a model's runs; nan if theory gives none.

    Places are in um^2, rad/um and um. The histogram's errors come from each run, since theory has none. There are no
    expected values for a run that starts empty, and is too short to forget that.
    """
    model = stationary_part(model)
    layout, found = RunLayout.of(model), dict[str, Doubles]()
    places = {
        "histogram": (0.5 * (layout.edges[1:] + layout.edges[:-1]), _shares),
        "spectrum": (layout.banded(WelchSum(layout.segment, layout.step).spectrum().wavenumber), _spectrum),
        "autocovariance": (layout.step * layout.lags.astype(np.float64), _covariance),
    }
    for name, (place, theory) in places.items():
        expected = error = np.empty(0)
        if model.start == "stationary":
            with suppress(Refused):
                expected, error = theory(model, layout)
        parts = {"place": place, "expected": expected, "standard_error": error}
        found |= {f"{name}_{part}": _filled_up(values, CURVES[name]) for part, values in parts.items()}
    del found["histogram_standard_error"]  # which each run has
    return found


def _has_errors(model: Model) -> bool:
    """Whether a spectrum and an autocovariance have errors: for a long run, random births and fine ticks."""
    life = model.mean_life_distance
    return (
        are_at_random(model)
        and model.distance >= FEWEST_LIVES * life >= FEWEST_LIVES * FEWEST_TICKS_A_LIFE * model.tick
    )


def _shares(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the expected density of each bin, the exact probability over the width."""
    return np.diff(np.asarray(distribution(model).cdf(layout.edges))) / np.diff(layout.edges), np.empty(0)


def _spectrum(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the mean expected density of each band, aliases and leakage included, and its standard error."""
    _, expected = expected_periodogram(model, layout.step, hann(layout.segment))
    means = layout.banded(expected)
    if not means.size or not _has_errors(model):
        return means, np.empty(0)
    shown = replace(WelchSum(layout.segment, layout.step).spectrum(), segments=layout.segments)
    powers = band_powers(model, shown, expected, model.distance, BANDS)
    return means, means * np.array([(band.standard_error / band.expected) for band in powers])


def _covariance(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the expected autocovariance about the record's own mean, and its standard error."""
    lags = layout.step * layout.lags.astype(np.float64)
    expected = autocovariance(model, lags) - area_noise(model).variance_of_mean()
    errors = covariance_errors(model, lags, model.distance, layout.step) if _has_errors(model) else np.empty(0)
    return expected, errors
