"""The summary of a run without a trace: its figures, distribution, spectrum and autocovariance.

The model determines the places of these curves before the run, so they are equal for all replicates and for theory.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, log2
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.figures import summarise
from rubnoise.analysis.moments import FEWEST_LIVES, covariance_errors
from rubnoise.analysis.records import CovarianceSum, HistogramSum
from rubnoise.analysis.spectra import Spectrum, WelchSum, band_powers, bands_of, hann
from rubnoise.answer import Row
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.record.tally import Tally
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
        life = model.mean_life_distance
        stride = max(1, floor(life / model.tick / _MOST_TICKS_A_LIFE))
        ticks = model.tick_count // stride + 1
        segment = _segment(ticks, life / (stride * model.tick))
        segments = max(0, (ticks - segment) // (segment // 2) + 1)
        return cls(
            edges=_edges(model),
            batch=ceil(_CORRELATIONS_A_BATCH * _correlation_length(model) / model.tick),
            stride=stride,
            step=stride * model.tick,
            lags=_lags(ticks, life / (stride * model.tick)),
            segment=segment,
            segments=segments,
            bands=tuple(bands_of(segment // 2 + 1, BANDS)) if segments else (),
        )

    @property
    def middles(self) -> Doubles:
        """The middles of the bins in um^2."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])

    @property
    def distances(self) -> Doubles:
        """The lags in um."""
        return self.step * self.lags.astype(np.float64)

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


def _lags(ticks: int, ticks_a_life: float) -> NDArray[np.int64]:
    reach = max(1, min(round(_LIVES_A_REACH * ticks_a_life), ticks // _FEWEST_SEGMENTS))
    return np.arange(0, reach + 1, ceil((reach + 1) / LAGS), dtype=np.int64)


def _segment(ticks: int, ticks_a_life: float) -> int:
    """Return the ticks of a segment, a power of two: 64 lives, or fewer if a run had less than eight segments."""
    most = min(_LIVES_A_SEGMENT * ticks_a_life, 2.0 * ticks / (_FEWEST_SEGMENTS + 1))
    return max(_FEWEST_TICKS, 2 ** floor(log2(max(most, 1.0))))


CURVES: Final = {"histogram": BINS, "histogram_standard_error": BINS, "spectrum": BANDS, "autocovariance": LAGS}
"""The curves of a summary, and how many numbers each has; those left over are nan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """The figures of a run, and its curves of real contact area by name: um^-2, um^4 per rad/um, um^4.

    `rubnoise.analysis.run_summary.curve_theory` returns the places of the curves and their expected values.
    """

    figures: list[Row]
    curves: dict[str, Doubles]


class SummarySink:
    """A sink that sums up a run from its rows; its memory does not grow with the run."""

    def __init__(self, model: Model) -> None:
        """Start without rows."""
        layout = RunLayout.of(model)
        self._model = model
        self._layout = layout
        self._tally = Tally.of(model)
        self._histogram = HistogramSum(layout.edges, layout.batch)
        self._spectrum = WelchSum(layout.segment, layout.step)
        self._covariance = CovarianceSum(layout.lags, area_cumulants(model).mean)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of a group (see Sink)."""
        self._tally.write(group, first_row, columns)
        if group != "trace":
            return
        area = np.asarray(columns["real_contact_area"], dtype=np.float64)
        self._histogram.add(area)
        thinned = area[-first_row % self._layout.stride :: self._layout.stride]
        self._spectrum.add(thinned)
        self._covariance.add(thinned)

    def finish(self) -> RunSummary:
        """Return the summary of the rows so far."""
        histogram, spectrum = self._histogram.histogram(), self._spectrum.spectrum()
        curves = {
            "histogram": histogram.density,
            "histogram_standard_error": histogram.standard_error,
            "spectrum": self._layout.banded(spectrum.density),
            "autocovariance": self._covariance.covariances(),
        }
        return RunSummary(
            figures=summarise(self._model, self._tally),
            curves={name: filled_up(values, CURVES[name]) for name, values in curves.items()},
        )


def filled_up(values: Doubles, count: int) -> Doubles:
    """Return values filled with nan up to a count, and with nan in place of infinite ones."""
    finite = np.where(np.isfinite(values), values, np.nan)
    return np.pad(finite, (0, count - values.size), constant_values=np.nan)


FEWEST_TICKS_A_LIFE = 8
"""Ticks to a mean life below which errors of autocovariance and spectrum, made for a continuous record, do not hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveTheory:
    """Places of a curve, its expected values, and the standard errors for one run; nan if theory gives none.

    In um^2, rad/um and um; in um^-2, um^4 per rad/um and um^4.
    """

    place: Doubles
    expected: Doubles
    standard_error: Doubles


@lru_cache(maxsize=8)
def curve_theory(model: Model) -> dict[str, CurveTheory]:
    """Return the expected histogram, spectrum and autocovariance of a model's runs.

    The histogram's errors come from each run, since theory has none. There are no expected values for a run that starts
    empty.
    """
    layout = RunLayout.of(model)
    wavenumbers = np.asarray(2.0 * np.pi * np.fft.rfftfreq(layout.segment, layout.step), dtype=np.float64)
    return {
        "histogram": _made(layout.middles, BINS, model, lambda: (_shares(model, layout), np.empty(0))),
        "spectrum": _made(layout.banded(wavenumbers), BANDS, model, lambda: _spectrum(model, layout)),
        "autocovariance": _made(layout.distances, LAGS, model, lambda: _covariance(model, layout)),
    }


def _made(place: Doubles, count: int, model: Model, theory: Callable[[], tuple[Doubles, Doubles]]) -> CurveTheory:
    expected = error = np.empty(0)
    if model.start == "stationary":
        with suppress(Refused):
            expected, error = theory()
    return CurveTheory(
        place=filled_up(place, count),
        expected=filled_up(expected, count),
        standard_error=filled_up(error if _has_errors(model) else np.empty(0), count),
    )


def _has_errors(model: Model) -> bool:
    """Whether a spectrum and an autocovariance have errors: for a long run, random births and fine ticks."""
    life = model.mean_life_distance
    return (
        are_at_random(model)
        and model.distance >= FEWEST_LIVES * life >= FEWEST_LIVES * FEWEST_TICKS_A_LIFE * model.tick
    )


def _shares(model: Model, layout: RunLayout) -> Doubles:
    """Return the expected density of each bin, the exact probability over the width."""
    return np.diff(np.asarray(distribution(model).cdf(layout.edges))) / np.diff(layout.edges)


def _spectrum(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the mean expected density of each band, aliases and leakage included, and its standard error."""
    wavenumber, expected = expected_periodogram(model, layout.step, hann(layout.segment))
    means = layout.banded(expected)
    if not means.size or not _has_errors(model):
        return means, np.empty(0)
    shown = Spectrum(
        wavenumber=wavenumber,
        density=expected,
        standard_error=expected,
        ticks=layout.segment,
        segments=layout.segments,
    )
    powers = band_powers(model, shown, expected, model.distance, BANDS)
    return means, means * np.array([(band.standard_error / band.expected) for band in powers])


def _covariance(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the expected autocovariance about the record's own mean, and its standard error."""
    lags = layout.distances
    expected = autocovariance(model, lags) - area_noise(model).variance_of_mean()
    errors = covariance_errors(model, lags, model.distance, layout.step) if _has_errors(model) else np.empty(0)
    return expected, errors
