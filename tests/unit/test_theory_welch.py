from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Fixed
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.estimated_spectrum import Segments, expected_periodogram, welch_covariance, welch_errors
from tests.unit.drawn_records import Doubles, drawn_trace, periodograms
from tests.unit.theory_models import model_of, one_size
from tests.verification.seeds import seed_of

TICK = 0.69125  # 16 ticks a life of 11.06 um
TICKS = 128
BOXCAR = np.ones(TICKS)
HANN = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(TICKS) / TICKS)


@pytest.mark.parametrize(("count", "step"), [(0, 8), (3, 0)])
def test_a_cut_without_segments_is_refused(count: int, step: int) -> None:
    with pytest.raises(Refused, match="at least 1 segment"):
        Segments(tick=TICK, window=HANN, count=count, step=step)


def test_regular_births_have_another_error() -> None:
    model = replace(one_size(), births=RegularBirths(mean_spacing=0.5))
    with pytest.raises(Refused, match="known for Poisson births alone"):
        welch_errors(model, Segments(tick=TICK, window=HANN, count=4, step=64))


def estimates(model: Model, cut: Segments, records: int, name: str) -> Doubles:
    """Return Welch estimates over their mean, a row for each of so many records drawn one after the other."""
    n = cut.window.size
    length = n + (cut.count - 1) * cut.step
    drawn = drawn_trace(model, cut.tick, records * length, seed_of(name)).reshape(records, length)
    found = np.zeros((records, n // 2 + 1))
    for first in range(0, cut.count * cut.step, cut.step):
        found += periodograms(drawn[:, first : first + n], cut.window, cut.tick) / cut.count
    expected = expected_periodogram(model, cut.tick, cut.window)[1]
    expected[0] = np.inf  # a boxcar leaves nothing there once the mean is gone
    return found / expected


def variance_score(values: Doubles, variance: float) -> float:
    """Return z of the sample variance, its error from the sample's own fourth moment."""
    kurtosis = np.mean((values - values.mean()) ** 4) / values.var() ** 2
    return float((values.var() / variance - 1.0) / np.sqrt((kurtosis - 1.0) / values.size))


CUT = Segments(tick=TICK, window=HANN, count=7, step=TICKS // 2)


@pytest.fixture(scope="module")
def overlapping() -> Doubles:
    return estimates(one_size(), CUT, 3000, "overlapping segments")


def test_error_of_every_bin(overlapping: Doubles) -> None:
    errors = welch_errors(one_size(), CUT)[1]
    z = [variance_score(overlapping[:, p], errors[p] ** 2) for p in range(2, TICKS // 2 - 1)]
    assert np.max(np.abs(z)) <= 4.0


def test_ends_of_the_axis_have_half_the_freedom(overlapping: Doubles) -> None:
    errors = welch_errors(one_size(), CUT)[1]
    assert errors[-1] / errors[-4] == pytest.approx(np.sqrt(2.0), rel=0.02)
    assert abs(variance_score(overlapping[:, -1], errors[-1] ** 2)) <= 4.0


@pytest.mark.parametrize("band", [(1, 4), (4, 12), (12, 30), (30, 50), (50, 64)])
def test_error_of_a_band(overlapping: Doubles, band: tuple[int, int]) -> None:
    bins = np.arange(*band)
    matrix = welch_covariance(one_size(), CUT, bins)
    values = overlapping[:, bins].mean(axis=1)
    assert abs(variance_score(values, matrix.mean())) <= 4.0
    assert variance_score(values, matrix.diagonal().mean() / bins.size) > 4.0  # bins taken as independent


def test_both_ways_to_the_error_of_a_bin_agree() -> None:
    bins = np.arange(2, 60)
    errors = welch_errors(one_size(), CUT)[1][bins]
    np.testing.assert_allclose(np.sqrt(welch_covariance(one_size(), CUT, bins).diagonal()), errors, rtol=1e-3)


def test_few_junctions_make_all_bins_move_together() -> None:
    """At N_jm = 1 a wide band is as uncertain as its number of junctions, and Gaussian noise would not show it."""
    model = model_of(Fixed(value=5.53), 5.53, mean_count=1.0)
    values = estimates(model, CUT, 3000, "few junctions")
    bins = np.arange(3, 40)
    matrix = welch_covariance(model, CUT, bins)
    gaussian = welch_covariance(model_of(Fixed(value=5.53), 5.53, mean_count=1e6), CUT, bins)
    assert abs(variance_score(values[:, bins].mean(axis=1), matrix.mean())) <= 4.0
    assert variance_score(values[:, bins].mean(axis=1), gaussian.mean()) > 5.0


def test_leakage_of_a_boxcar_binds_all_high_bins_together() -> None:
    cut = replace(CUT, window=BOXCAR)
    values = estimates(one_size(), cut, 3000, "boxcar")[:, 20:60].mean(axis=1)
    assert abs(variance_score(values, welch_covariance(one_size(), cut, np.arange(20, 60)).mean())) <= 4.0


def test_segments_far_apart_are_independent() -> None:
    alone = Segments(tick=TICK, window=HANN, count=1, step=1)
    apart = Segments(tick=TICK, window=HANN, count=9, step=TICKS + 20)
    np.testing.assert_allclose(welch_errors(one_size(), apart)[1], welch_errors(one_size(), alone)[1] / 3.0, rtol=1e-12)


def test_a_constant_segment_has_nothing_at_zero() -> None:
    errors = welch_errors(one_size(), Segments(tick=TICK, window=BOXCAR, count=3, step=TICKS))[1]
    assert np.isinf(errors[0])
    assert np.isfinite(errors[1:]).all()
