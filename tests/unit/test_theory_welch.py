"""What an estimated spectrum expects."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.distributions import Fixed, Normal
from rubnoise.contact.pulses import TRIANGLE, Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.sampling import cross_spectrum, expected_periodogram, through_window, welch_errors
from rubnoise.theory.second_order import area_noise, autocovariance, spectral_density
from tests.laws.scores import seed_of
from tests.unit.theory_models import Doubles, drawn_trace, model_of, one_size, periodograms

TICK = 0.69125  # 16 ticks a life of 11.06 um
TICKS = 128
ROWS = 4000
BOXCAR = np.ones(TICKS)
HANN = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(TICKS) / TICKS)
WINDOWS = {"boxcar": BOXCAR, "hann": HANN}


@dataclass(frozen=True, kw_only=True, eq=False)
class Segments:
    """Segments of a record, ``step`` ticks from start to start."""

    window: Doubles
    count: int
    step: int

    def errors(self, model: Model) -> Doubles:
        return welch_errors(replace(model, tick=TICK), self.window, self.count, self.step)


def by_double_sum(covariance: Doubles, window: Doubles, shift: int) -> Doubles:
    """Return E[X conj X'] for every pair of bins, from the matrix of all covariances."""
    n = window.size
    ticks = np.arange(n)
    lags = np.abs(shift + ticks[None, :] - ticks[:, None])
    matrix = np.where(lags < covariance.size, covariance[np.minimum(lags, covariance.size - 1)], 0.0)
    project = np.eye(n) - 1.0 / n
    matrix = project @ matrix @ project
    rows = window * np.exp(-2j * np.pi * np.outer(np.arange(n // 2 + 1), ticks) / n)
    return rows @ matrix @ rows.conj().T


@pytest.mark.parametrize("shift", [0, 7, 20, 45])
@pytest.mark.parametrize("count", [31, 32])
def test_covariances_of_transforms_against_the_double_sum(shift: int, count: int) -> None:
    covariance = autocovariance(one_size(), TICK * np.arange(17))
    window = np.random.default_rng(3).random(count) + 0.2
    ordinary = by_double_sum(covariance, window, shift)
    scale = np.abs(ordinary).max() + 1e-3
    fast = cross_spectrum(covariance, window, shift)
    np.testing.assert_allclose(fast, ordinary.diagonal(), atol=1e-13 * scale)


@pytest.fixture(scope="module")
def trace() -> Doubles:
    return drawn_trace(one_size(), TICK, TICKS * ROWS, seed_of("drawn trace of one size"))


def bin_scores(model: Model, segments: Doubles, window: Doubles, expected: Doubles) -> Doubles:
    """Return z of the mean periodogram in every bin above the first."""
    exact = expected_periodogram(model, TICK, window)[1]
    error = Segments(window=window, count=segments.shape[0], step=window.size).errors(model)[1:] * exact[1:]
    return (periodograms(segments, window, TICK).mean(axis=0) - expected)[1:] / error


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


def test_long_segments_and_fine_ticks_show_the_spectrum() -> None:
    model = one_size()
    window = np.hanning(8192)
    k, found = expected_periodogram(model, 0.05, window)
    middle = (k > 0.1) & (k < 10.0)
    np.testing.assert_allclose(found[middle], spectral_density(model, k[middle]), rtol=5e-3)
    assert found[1] < float(spectral_density(model, 0.0))


def test_bins_are_those_of_scipy(trace: Doubles) -> None:
    from scipy.signal import get_window, welch

    window = np.asarray(get_window("hann", TICKS))
    cycles, density = welch(trace[: 50 * TICKS], fs=1.0 / TICK, window=window, noverlap=0, detrend="constant")
    k, _ = expected_periodogram(one_size(), TICK, window)
    mine = periodograms(trace[: 50 * TICKS].reshape(50, TICKS), window, TICK).mean(axis=0)
    np.testing.assert_allclose(2.0 * np.pi * cycles, k, rtol=1e-14)
    np.testing.assert_allclose(density[1:-1], 2.0 * mine[1:-1], rtol=1e-9)
    assert density[-1] == pytest.approx(mine[-1], rel=1e-9)


@pytest.mark.slow
def test_a_triangle_and_spread_sizes_leak_and_alias_alike() -> None:
    model = replace(model_of(Normal(centre=5.53, std=2.0), 5.53), pulse=TRIANGLE)
    drawn = drawn_trace(model, TICK, TICKS * ROWS, seed_of("drawn trace of triangles"))
    expected = expected_periodogram(model, TICK, HANN)[1]
    assert np.max(np.abs(bin_scores(model, drawn.reshape(ROWS, TICKS), HANN, expected))) <= 4.0


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


def test_regular_births_have_another_error() -> None:
    model = replace(one_size(), births=RegularBirths(mean_spacing=0.5))
    with pytest.raises(Refused, match="known for Poisson births alone"):
        welch_errors(model, HANN, 4, 64)


def estimates(model: Model, cut: Segments, records: int, name: str) -> Doubles:
    """Return Welch estimates over their mean, a row for each of so many records drawn one after the other."""
    n = cut.window.size
    length = n + (cut.count - 1) * cut.step
    drawn = drawn_trace(model, TICK, records * length, seed_of(name)).reshape(records, length)
    found = np.zeros((records, n // 2 + 1))
    for first in range(0, cut.count * cut.step, cut.step):
        found += periodograms(drawn[:, first : first + n], cut.window, TICK) / cut.count
    expected = expected_periodogram(model, TICK, cut.window)[1]
    expected[0] = np.inf  # a boxcar leaves nothing there once the mean is gone
    return found / expected


def variance_score(values: Doubles, variance: float) -> float:
    """Return z of the sample variance, its error from the sample's own fourth moment."""
    kurtosis = np.mean((values - values.mean()) ** 4) / values.var() ** 2
    return float((values.var() / variance - 1.0) / np.sqrt((kurtosis - 1.0) / values.size))


CUT = Segments(window=HANN, count=7, step=TICKS // 2)


def test_few_junctions_scatter_more() -> None:
    """At N_jm = 1 a bin is less certain than Gaussian noise would have it, and drawn records agree."""
    model = model_of(Fixed(value=5.53), 5.53, mean_count=1.0)
    values, bins = estimates(model, CUT, 3000, "few junctions"), np.arange(3, 40)
    errors = CUT.errors(model)
    gaussian = CUT.errors(model_of(Fixed(value=5.53), 5.53, mean_count=1e6))
    assert np.max(np.abs([variance_score(values[:, p], errors[p] ** 2) for p in bins])) <= 4.0
    assert np.mean([variance_score(values[:, p], gaussian[p] ** 2) for p in bins]) > 2.0


@pytest.fixture(scope="module")
def overlapping() -> Doubles:
    return estimates(one_size(), CUT, 3000, "overlapping segments")


def test_error_of_every_bin(overlapping: Doubles) -> None:
    errors = CUT.errors(one_size())
    z = [variance_score(overlapping[:, p], errors[p] ** 2) for p in range(2, TICKS // 2 - 1)]
    assert np.max(np.abs(z)) <= 4.0


def _regular(count: int, pulse: Pulse) -> Model:
    model = one_size()
    return replace(model, pulse=pulse, births=RegularBirths(mean_spacing=2.0 * model.calibrated_diameter / count))


def test_of_an_odd_number_every_second_is_left() -> None:
    model = _regular(3, TRIANGLE)
    wavenumber, power = area_noise(model).lines
    order = wavenumber / (2.0 * np.pi * model.birth_rate)
    np.testing.assert_allclose(order[:50], np.arange(1, 100, 2), rtol=1e-12)
    # A triangular ripple: a variance of the squared mean over 3 N^4, and powers as 1/n^4.
    mean = model.birth_rate * 0.25 * np.pi * model.calibrated_diameter**3
    assert 2.0 * power.sum() == pytest.approx(mean**2 / (3.0 * 3**4), rel=1e-6)
    np.testing.assert_allclose(power[:20] / power[0], np.arange(1.0, 40.0, 2.0) ** -4, rtol=1e-9)
