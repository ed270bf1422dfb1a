"""The trace as noise: its autocovariance, its spectrum in bands, and its whole distribution."""

import numpy as np

from rubnoise.analysis.bands import band_powers
from rubnoise.analysis.comparing.contact import settled_length
from rubnoise.analysis.comparing.findings import Finding, LeftOut
from rubnoise.analysis.comparing.judging import judged, too_short
from rubnoise.analysis.comparing.tails import tail_of
from rubnoise.analysis.comparing.trace import TraceSums
from rubnoise.analysis.covariance_errors import covariance_errors
from rubnoise.analysis.kolmogorov import FEWEST, kolmogorov_figure, sample_distance
from rubnoise.analysis.moments import over_ticks
from rubnoise.analysis.spectra import half_of, hann
from rubnoise.model import Model
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.distribution import distribution
from rubnoise.theory.estimated_spectrum import expected_periodogram
from rubnoise.theory.random_births import need_random_births
from rubnoise.theory.sampling import variance_of_time_mean

BANDS = 8
FEWEST_SEGMENTS = 8
FEWEST_TICKS_A_LIFE = 8
"""Ticks to a mean life below which errors of autocovariance and spectrum, made for a continuous record, do not hold."""


def covariance_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the autocovariance at shares of a mean life; raises Refused unless births are random.

    It is taken about the mean of the record, which leaves it smaller by the variance of that mean.
    """
    need_random_births(model, "the error of an autocovariance")
    if _coarse(model):
        return [_too_coarse("real_contact_area_autocovariance")]
    length, step = settled_length(model, trace), trace.layout.stride * model.tick
    lags = step * np.array(trace.layout.lags, dtype=np.float64)
    expected = autocovariance(model, lags) - variance_of_time_mean(over_ticks(model, trace.settled_ticks, model.tick))
    errors = covariance_errors(model, lags, length, step)
    variance, tail = float(autocovariance(model, np.zeros(1))[0]), tail_of(model, length, 5)
    return [
        judged(
            f"real_contact_area_autocovariance_{lag:.3g}", float(seen), float(value), float(error),
            length=length, scale=variance, tail=tail,
        )
        for lag, seen, value, error in zip(lags, trace.products.covariances(), expected, errors, strict=True)
    ]  # fmt: skip


def spectrum_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the power of eight bands of wavenumber beside that of an estimate, aliases and leakage included.

    Raises Refused unless births are random.
    """
    need_random_births(model, "the error of a spectrum")
    if _coarse(model):
        return [_too_coarse("spectrum")]
    seen = trace.spectrum.spectrum()
    length, step = settled_length(model, trace), trace.layout.stride * model.tick
    if seen.segments < FEWEST_SEGMENTS:
        ticks = seen.ticks + (FEWEST_SEGMENTS - 1) * half_of(seen.ticks)
        return [too_short("spectrum", (trace.layout.settled + trace.layout.stride * ticks) * model.tick)]
    _, expected = expected_periodogram(model, step, hann(seen.ticks))
    # A life's energy |A^(k)|^2 goes with d^6 while a wave is longer than it, and with d^2 beyond.
    tails = {power: tail_of(model, length, power) for power in (2, 6)}
    return [
        judged(
            f"spectrum_{band.lowest:.3g}_to_{band.highest:.3g}",
            band.observed, band.expected, band.standard_error, length=length,
            tail=tails[6 if band.lowest * model.calibrated_diameter < np.pi else 2],
        )
        for band in band_powers(model, seen, expected, length, BANDS)
    ]  # fmt: skip


def distribution_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the distance of the whole distribution from the exact one; raises Refused where theory has none.

    Ticks farther apart than the longest life share no junction: their areas are independent.
    """
    settled = trace.column("distance") >= (trace.layout.settled - 0.5) * model.tick
    areas = trace.column("real_contact_area")[settled]
    if areas.size < FEWEST:
        return [too_short("real_contact_area_kolmogorov", trace.layout.apart * FEWEST * model.tick)]
    exact = distribution(model)
    # Sums of areas that all have ended may leave a rounding instead of 0.
    heights = np.asarray(exact.cdf(areas), dtype=np.float64)
    distance = sample_distance(areas, heights, atom=exact.atom_at_zero)
    return [kolmogorov_figure("real_contact_area_kolmogorov", distance, areas.size)]


def _coarse(model: Model) -> bool:
    return model.mean_life_distance < FEWEST_TICKS_A_LIFE * model.tick


def _too_coarse(name: str) -> LeftOut:
    return LeftOut(name=name, reason=f"ticks are too wide for it; it needs {FEWEST_TICKS_A_LIFE} to a mean life")
