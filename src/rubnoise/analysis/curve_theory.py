"""Where the curves of a summary lie, and what theory expects there: the same for all runs of a model."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rubnoise.analysis.bands import Band, band_powers
from rubnoise.analysis.covariance_errors import covariance_errors
from rubnoise.analysis.run_layout import BANDS, BINS, LAGS, RunLayout
from rubnoise.analysis.run_summary import filled_up
from rubnoise.analysis.spectra import Spectrum, hann
from rubnoise.analysis.summary import FEWEST_LIVES
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.distribution import distribution
from rubnoise.theory.estimated_spectrum import expected_periodogram, segment_wavenumbers
from rubnoise.theory.regular_births import are_at_random
from rubnoise.theory.sampling import variance_of_time_mean

FEWEST_TICKS_A_LIFE = 8
"""Ticks to a mean life below which errors of autocovariance and spectrum, made for a continuous record, do not hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveTheory:
    """Places of a curve, its expected values, and the standard error of one run's; nan where theory is silent.

    In um^2, rad/um and um; in um^-2, um^4 per rad/um and um^4.
    """

    place: Doubles
    expected: Doubles
    standard_error: Doubles


@lru_cache(maxsize=8)
def curve_theory(model: Model) -> dict[str, CurveTheory]:
    """Return what is expected of the histogram, spectrum and autocovariance of a model's runs.

    The histogram's errors are those of each run: theory has none. A run that starts empty is expected nothing of.
    """
    layout = RunLayout.of(model)
    return {
        "histogram": _made(layout.middles, BINS, model, lambda: (_shares(model, layout), np.empty(0))),
        "spectrum": _made(_wavenumbers(layout), BANDS, model, lambda: _spectrum(model, layout)),
        "autocovariance": _made(layout.distances, LAGS, model, lambda: _covariance(model, layout)),
    }


def _made(place: Doubles, count: int, model: Model, tell: Callable[[], tuple[Doubles, Doubles]]) -> CurveTheory:
    expected = error = np.empty(0)
    if model.start == "stationary":
        with suppress(Refused):
            expected, error = tell()
    return CurveTheory(
        place=filled_up(place, count),
        expected=filled_up(expected, count),
        standard_error=filled_up(error if _told(model) else np.empty(0), count),
    )


def _told(model: Model) -> bool:
    """Whether a run is long, its births at random and its ticks fine enough for errors of a spectrum and the like."""
    life = model.mean_life_distance
    return (
        are_at_random(model)
        and model.distance >= FEWEST_LIVES * life >= FEWEST_LIVES * FEWEST_TICKS_A_LIFE * model.tick
    )


def _shares(model: Model, layout: RunLayout) -> Doubles:
    """Return the expected density of each bin, the exact probability over the width."""
    return np.diff(np.asarray(distribution(model).cdf(layout.edges))) / np.diff(layout.edges)


def _wavenumbers(layout: RunLayout) -> Doubles:
    return layout.banded(segment_wavenumbers(layout.step, layout.segment))


def _spectrum(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the mean expected density of each band, aliases and leakage included, and its standard error."""
    wavenumber, expected = expected_periodogram(model, layout.step, hann(layout.segment))
    means = layout.banded(expected)
    if not means.size or not _told(model):
        return means, np.empty(0)
    shown = Spectrum(
        wavenumber=wavenumber,
        density=expected,
        standard_error=expected,
        ticks=layout.segment,
        segments=layout.segments,
    )
    powers = band_powers(model, shown, expected, model.distance, BANDS)
    return means, means * np.array([_relative(band) for band in powers])


def _relative(band: Band) -> float:
    return band.standard_error / band.expected


def _covariance(model: Model, layout: RunLayout) -> tuple[Doubles, Doubles]:
    """Return the expected autocovariance about the record's own mean, and its standard error."""
    lags = layout.distances
    expected = autocovariance(model, lags) - variance_of_time_mean(model)
    errors = covariance_errors(model, lags, model.distance, layout.step) if _told(model) else np.empty(0)
    return expected, errors
