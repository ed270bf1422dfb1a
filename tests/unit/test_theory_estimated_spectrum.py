from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.laws import Exponential, Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.estimated_spectrum import (
    Segments,
    bin_covariances,
    correlation_reach,
    cross_spectrum,
    expected_periodogram,
    through_window,
    tick_covariance,
    welch_errors,
)
from rubnoise.theory.quadrature import size_range
from rubnoise.theory.spectrum import density_at_zero, spectral_density
from tests.unit.drawn_records import Doubles, drawn_trace, periodograms
from tests.unit.theory_models import model_of, one_size
from tests.verification.seeds import seed_of

TICK = 0.69125  # 16 ticks a life of 11.06 um
TICKS = 128
ROWS = 4000
BOXCAR = np.ones(TICKS)
HANN = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(TICKS) / TICKS)
WINDOWS = {"boxcar": BOXCAR, "hann": HANN}


def by_double_sum(covariance: Doubles, window: Doubles, shift: int, *, detrend: bool) -> tuple[Doubles, Doubles]:
    """Return E[X conj X'] and E[X X'] for every pair of bins, from the matrix of all covariances."""
    n = window.size
    ticks = np.arange(n)
    lags = np.abs(shift + ticks[None, :] - ticks[:, None])
    matrix = np.where(lags < covariance.size, covariance[np.minimum(lags, covariance.size - 1)], 0.0)
    if detrend:
        project = np.eye(n) - 1.0 / n
        matrix = project @ matrix @ project
    rows = window * np.exp(-2j * np.pi * np.outer(np.arange(n // 2 + 1), ticks) / n)
    return rows @ matrix @ rows.conj().T, rows @ matrix @ rows.T


@pytest.mark.parametrize("shift", [0, 7, 20, 45])
@pytest.mark.parametrize("count", [31, 32])
@pytest.mark.parametrize("detrend", [True, False])
def test_covariances_of_transforms_against_the_double_sum(shift: int, count: int, *, detrend: bool) -> None:
    covariance = tick_covariance(one_size(), TICK, 17)
    window = np.random.default_rng(3).random(count) + 0.2
    ordinary, turned = by_double_sum(covariance, window, shift, detrend=detrend)
    scale = np.abs(ordinary).max() + 1e-3
    fast = cross_spectrum(covariance, window, shift, detrend=detrend)
    np.testing.assert_allclose(fast, ordinary.diagonal(), atol=1e-13 * scale)
    for found, expected in zip(
        bin_covariances(covariance, window, shift, np.arange(count // 2 + 1), detrend=detrend),
        (ordinary, turned),
        strict=True,
    ):
        np.testing.assert_allclose(found, expected, atol=1e-13 * scale)


def test_covariance_by_ticks_ends_with_the_longest_life() -> None:
    found = tick_covariance(one_size(), TICK, 40)
    np.testing.assert_allclose(found, autocovariance(one_size(), TICK * np.arange(40)), rtol=1e-15)
    assert correlation_reach(one_size()) == 2.0 * 5.53
    assert found[15] > 0.0
    assert not found[17:].any()


def test_lives_too_rare_to_count_do_not_lengthen_it() -> None:
    model = model_of(Exponential(mean=5.53), 5.53)
    reach, variance = correlation_reach(model), area_cumulants(model).variance
    assert reach < 2.0 * size_range(model.sizes)[1]
    assert autocovariance(model, reach) < 1e-17 * variance
    assert autocovariance(model, 0.8**2 * reach) > 1e-17 * variance


@pytest.fixture(scope="module")
def trace() -> Doubles:
    return drawn_trace(one_size(), TICK, TICKS * ROWS, seed_of("drawn trace of one size"))


def bin_scores(model: Model, segments: Doubles, window: Doubles, expected: Doubles, **how: bool) -> Doubles:
    """Return z of the mean periodogram in every bin above the first."""
    cut = Segments(tick=TICK, window=window, count=segments.shape[0], step=window.size, **how)
    exact = expected_periodogram(model, TICK, window, **how)[1]
    error = welch_errors(model, cut)[1][1:] * exact[1:]
    return (periodograms(segments, window, TICK, **how).mean(axis=0) - expected)[1:] / error


@pytest.mark.parametrize("name", WINDOWS)
def test_mean_periodogram_of_drawn_segments(name: str, trace: Doubles) -> None:
    window = WINDOWS[name]
    expected = expected_periodogram(one_size(), TICK, window)[1]
    assert np.max(np.abs(bin_scores(one_size(), trace.reshape(ROWS, TICKS), window, expected))) <= 4.0


@pytest.mark.parametrize("name", WINDOWS)
def test_the_spectrum_itself_is_rejected_where_aliases_and_leakage_count(name: str, trace: Doubles) -> None:
    k, _ = expected_periodogram(one_size(), TICK, WINDOWS[name])
    z = bin_scores(one_size(), trace.reshape(ROWS, TICKS), WINDOWS[name], spectral_density(one_size(), k))
    assert z[-1] > 10.0  # an alias as large as the spectrum itself at the end of the axis
    assert (z[30:] > 10.0).all() == (name == "boxcar")  # leakage of the ends of the segment


def test_the_mean_leaks_when_it_is_not_removed(trace: Doubles) -> None:
    segments, model = trace.reshape(ROWS, TICKS), one_size()
    k, expected = expected_periodogram(model, TICK, HANN, detrend=False)
    mean_leak = expected[1] / expected_periodogram(model, TICK, HANN)[1][1]
    assert mean_leak > 2.0
    # Beyond the neighbours of k = 0 the mean is gone, and the errors without it hold.
    z = (periodograms(segments, HANN, TICK, detrend=False).mean(axis=0) - expected) / (
        expected * welch_errors(model, Segments(tick=TICK, window=HANN, count=ROWS, step=TICKS, detrend=False))[1]
    )
    assert np.max(np.abs(z[2:])) <= 4.0
    assert k[0] == 0.0


def test_removing_the_mean_counts_in_the_lowest_bins(trace: Doubles) -> None:
    without = expected_periodogram(one_size(), TICK, HANN, detrend=False)[1]
    without[:2] = 0.0
    z = bin_scores(one_size(), trace.reshape(ROWS, TICKS), HANN, without)
    assert abs(z[0]) > 10.0


def test_long_segments_and_fine_ticks_show_the_spectrum() -> None:
    model = one_size()
    window = np.hanning(8192)
    k, found = expected_periodogram(model, 0.05, window)
    middle = (k > 0.1) & (k < 10.0)
    np.testing.assert_allclose(found[middle], spectral_density(model, k[middle]), rtol=5e-3)
    assert found[1] < density_at_zero(model)


def test_bins_are_those_of_scipy(trace: Doubles) -> None:
    from scipy.signal import get_window, welch

    window = np.asarray(get_window("hann", TICKS))
    cycles, density = welch(trace[: 50 * TICKS], fs=1.0 / TICK, window=window, noverlap=0, detrend="constant")
    k, _ = expected_periodogram(one_size(), TICK, window)
    mine = periodograms(trace[: 50 * TICKS].reshape(50, TICKS), window, TICK).mean(axis=0)
    np.testing.assert_allclose(2.0 * np.pi * cycles, k, rtol=1e-14)
    np.testing.assert_allclose(density[1:-1], 2.0 * mine[1:-1], rtol=1e-9)
    assert density[-1] == pytest.approx(mine[-1], rel=1e-9)


def test_a_triangle_and_spread_sizes_leak_and_alias_alike() -> None:
    model = replace(model_of(Normal(centre=5.53, std=2.0), 5.53), pulse=TRIANGLE)
    drawn = drawn_trace(model, TICK, TICKS * ROWS, seed_of("drawn trace of triangles"))
    expected = expected_periodogram(model, TICK, HANN)[1]
    assert np.max(np.abs(bin_scores(model, drawn.reshape(ROWS, TICKS), HANN, expected))) <= 4.0


@pytest.mark.parametrize("window", [np.ones(1), np.zeros(8), np.ones((4, 4))])
def test_a_window_that_weighs_nothing_is_refused(window: Doubles) -> None:
    with pytest.raises(Refused, match="window needs at least 2 ticks"):
        expected_periodogram(one_size(), TICK, window)


def test_a_density_seen_through_a_window_is_the_expected_periodogram() -> None:
    model = one_size()
    n, last = 512, 256
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(n) / n)
    wavenumber, exact = expected_periodogram(model, TICK, window)
    seen = through_window(lambda k: spectral_density(model, k), TICK, window, last)
    # The mean that is subtracted changes bins 0 and 1, and beyond the second aliases fall as the fourth power.
    np.testing.assert_allclose(seen[2:], exact[2:], rtol=2e-3)
    plain = spectral_density(model, wavenumber)
    assert np.abs(plain[2:] / exact[2:] - 1.0).max() > 0.3, "what has no aliases is noticed"


def test_a_window_that_weighs_nothing_sees_nothing() -> None:
    with pytest.raises(Refused, match="a window needs at least 2 ticks"):
        through_window(np.ones_like, TICK, np.zeros(8), 4)
