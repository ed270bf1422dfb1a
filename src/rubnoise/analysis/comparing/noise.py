"""Compare the trace as noise with theory: its autocovariance, its spectrum in bands, and its distribution."""

from math import inf

import numpy as np

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.comparing.contact import stationary_length
from rubnoise.analysis.comparing.findings import (
    LARGEST_ERROR,
    LARGEST_TAIL_SKEWNESS,
    Finding,
    Tail,
    judged,
    judged_mean,
    tail_of,
    too_short,
)
from rubnoise.analysis.comparing.trace import TraceSums
from rubnoise.analysis.kolmogorov import FEWEST, kolmogorov_figure, sample_distance
from rubnoise.analysis.moments import covariance_errors, over_ticks
from rubnoise.analysis.records import longer
from rubnoise.analysis.run_summary import FEWEST_TICKS_A_LIFE
from rubnoise.analysis.spectra import Band, band_powers, half_of, hann
from rubnoise.model import Model
from rubnoise.theory.distribution import Distribution, distribution
from rubnoise.theory.live_count import zero_share
from rubnoise.theory.periodogram import expected_periodogram
from rubnoise.theory.sampling import variance_of_time_mean
from rubnoise.theory.second_order import autocovariance, need_random_births

BANDS = 8
FEWEST_SEGMENTS = 8
SMALLEST_ATOM = 1e-3
"""Probability of no contact up to which it is but a step in the distribution that nothing is said of."""


def covariance_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the autocovariance at shares of a mean life; raises Refused unless births are random.

    It is taken about the mean of the record, which makes it smaller by the variance of that mean.
    """
    need_random_births(model, "the error of an autocovariance")
    if _coarse(model):
        return [_too_coarse("real_contact_area_autocovariance")]
    length, step = stationary_length(model, trace), trace.layout.stride * model.tick
    lags = step * np.array(trace.layout.lags, dtype=np.float64)
    expected = autocovariance(model, lags) - variance_of_time_mean(
        over_ticks(model, trace.stationary_ticks, model.tick)
    )
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
    length, step = stationary_length(model, trace), trace.layout.stride * model.tick
    if seen.segments < FEWEST_SEGMENTS:
        ticks = seen.ticks + (FEWEST_SEGMENTS - 1) * half_of(seen.ticks)
        return [too_short("spectrum", (trace.layout.stationary_from + trace.layout.stride * ticks) * model.tick)]
    _, expected = expected_periodogram(model, step, hann(seen.ticks))
    # A life's energy |A^(k)|^2 goes with d^6 while a wave is longer than it, and with d^2 beyond.
    tails = {power: tail_of(model, length, power) for power in (2, 6)}
    return [
        judged(
            f"spectrum_{band.lowest:.3g}_to_{band.highest:.3g}",
            band.observed, band.expected, band.standard_error, length=length,
            tail=_band_tail(model, band, tails[6 if band.lowest * model.calibrated_diameter < np.pi else 2], length),
        )
        for band in band_powers(model, seen, expected, length, BANDS)
    ]  # fmt: skip


def _band_tail(model: Model, band: Band, of_sizes: Tail, length: float) -> Tail:
    """Return the tail of a band's power: off the centre line a few lives with a sharp tip have most short waves."""
    if model.pulse.offset == "none" or band.skewness <= LARGEST_TAIL_SKEWNESS:
        return of_sizes
    needed = max(of_sizes.needed, longer(length, band.skewness, LARGEST_TAIL_SKEWNESS))
    return Tail(skewness=max(of_sizes.skewness, band.skewness), needed=needed)


def distribution_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the share of ticks without contact, and the distance of the areas' distribution from the exact one.

    If the share has a score, the distribution is that of the areas in contact: the atom and the continuous part have a
    figure each. If not, it is the whole distribution, with the atom. Raises Refused if theory has none.
    """
    exact = distribution(model)
    share = _zero_share(model, trace)
    if isinstance(share, LeftOut):
        shares = [share] if exact.atom_at_zero > SMALLEST_ATOM else []
        return [_distance(model, trace, exact, in_contact=False), *shares]
    return [share, _distance(model, trace, exact, in_contact=True)]


def _zero_share(model: Model, trace: TraceSums) -> Finding:
    """Return the share of ticks at which no junction is alive, all ticks of the stationary part."""
    law = zero_share(over_ticks(model, trace.stationary_ticks, model.tick))
    length, rarer = stationary_length(model, trace), min(law.expected, 1.0 - law.expected)
    relative = law.standard_error / rarer if law.standard_error else inf
    needed = max(longer(length, relative, LARGEST_ERROR), longer(length, abs(law.skewness), LARGEST_TAIL_SKEWNESS))
    return judged_mean(
        "junction_count_zero_share",
        trace.zero_ticks / trace.stationary_ticks,
        law.expected,
        law.standard_error,
        length=length,
        tail=Tail(skewness=law.skewness, needed=needed if needed > length else 0.0),
    )


def _distance(model: Model, trace: TraceSums, exact: Distribution, *, in_contact: bool) -> Finding:
    """Return the distance from the law of all areas, or from that of the areas while a junction is alive.

    Ticks farther apart than the longest life share no junction: their areas are independent.
    """
    name = "real_contact_area_kolmogorov"
    chosen = trace.column("distance") >= (trace.layout.stationary_from - 0.5) * model.tick
    if in_contact:
        chosen &= trace.column("junction_count") > 0
    areas, atom = trace.column("real_contact_area")[chosen], exact.atom_at_zero
    share = 1.0 - atom if in_contact else 1.0
    if areas.size < FEWEST:
        return too_short(name, (trace.layout.stationary_from + trace.layout.apart * FEWEST / share) * model.tick)
    heights = np.asarray(exact.cdf(areas), dtype=np.float64)
    if in_contact:
        return kolmogorov_figure(name, sample_distance(areas, (heights - atom) / share), areas.size)
    return kolmogorov_figure(name, sample_distance(areas, heights, atom=atom), areas.size, atom)


def _coarse(model: Model) -> bool:
    return model.mean_life_distance < FEWEST_TICKS_A_LIFE * model.tick


def _too_coarse(name: str) -> LeftOut:
    return LeftOut(name=name, reason=f"ticks are too wide for it; it needs {FEWEST_TICKS_A_LIFE} to a mean life")
