"""Estimates of a record: moments, autocovariances, histograms and Kolmogorov distances, with their errors."""

from functools import cache

import numpy as np
import pytest
from scipy.special import ndtr

from rubnoise.analysis.findings import UniformSample, distance_tail, kolmogorov_figure
from rubnoise.analysis.moments import covariance_errors
from rubnoise.analysis.records import (
    FEWEST_BATCHES,
    CovarianceSum,
    batch_length,
    histogram,
    integrated_autocorrelation,
)
from rubnoise.theory.second_order import area_noise
from rubnoise.theory.second_order import autocovariance as model_covariance
from tests.laws.scores import seed_of
from tests.models import bare, recorded
from tests.unit.theory_models import Doubles, memory, white

# Batch means of a record whose autocorrelation is known.


def test_batches_know_of_the_correlation() -> None:
    values = memory(200_000, seed_of("memory"))
    length = batch_length(values)
    means = values[: values.size // length * length].reshape(-1, length).mean(axis=1)
    error = float(means.std(ddof=1)) / means.size**0.5
    assert error == pytest.approx((19.0 / 200_000) ** 0.5, rel=0.25)
    assert error > 3.0 * values.std() / values.size**0.5


def test_batches_are_many_and_long() -> None:
    values = memory(20_000, seed_of("memory"))
    length = batch_length(values)
    assert 10.0 * integrated_autocorrelation(values) <= length <= values.size // FEWEST_BATCHES
    assert batch_length(values[:1000]) == 1000


SHORTER = bare(tick=0.25, distance=6000.0)
RUNS = 60


@cache
def area_of_shorter() -> Doubles:
    found: Doubles = recorded(SHORTER, seed_of("covariance/run"))["trace"]["real_contact_area"]
    return found


def test_a_run_has_the_autocovariance_of_its_model() -> None:
    lags = (4, 10, 20, 30, 40)
    seen, lag = values_at(lags, area_of_shorter()), SHORTER.tick * np.array(lags)
    error = covariance_errors(SHORTER, lag, SHORTER.distance, SHORTER.tick)
    expected = model_covariance(SHORTER, lag) - area_noise(SHORTER).variance_of_mean()
    assert np.max(np.abs(seen - expected) / error) <= 4.0
    other = model_covariance(bare(count=10.0), lag)
    assert np.max(np.abs(seen - other) / error) > 5.0


def values_at(lags: tuple[int, ...], row: Doubles) -> Doubles:
    products = CovarianceSum(np.array(lags), 200.0)
    products.add(row)
    return products.covariances()


def test_errors_are_the_spread_of_many_runs() -> None:
    run = bare(tick=0.5, distance=1500.0, count=5.0)
    lags = (2, 6, 12, 20)
    seeds = range(seed_of("covariance/spread"), seed_of("covariance/spread") + RUNS)
    rows = [recorded(run, seed)["trace"]["real_contact_area"] for seed in seeds]
    values = np.array([values_at(lags, row) for row in rows])
    errors = covariance_errors(run, run.tick * np.array(lags), 1500.0, run.tick)
    # A spread of 60 runs is known to 9 %, and a little worse for laws with long tails.
    assert values.std(axis=0, ddof=1) == pytest.approx(errors, rel=0.4)
    assert values.std(axis=0, ddof=1) != pytest.approx(0.5 * errors, rel=0.4)


# Histograms: densities that add up, and errors that know of the correlation.
EDGES = np.linspace(-3.0, 3.0, 25)


def expected(scale: float = 1.0) -> np.ndarray:
    return np.diff(ndtr(EDGES / scale)) / np.diff(EDGES)


def test_a_histogram_is_the_density_of_its_law_and_of_no_other() -> None:
    found = histogram(memory(400_000, seed_of("histogram")), EDGES)
    assert np.max(np.abs(found.density - expected()) / found.standard_error) <= 4.5
    assert np.max(np.abs(found.density - expected(1.1)) / found.standard_error) > 6.0


def test_errors_of_independent_values_are_binomial() -> None:
    found = histogram(white(200_000, seed_of("histogram")) - 3.0, EDGES)
    share = expected() * np.diff(EDGES)
    binomial = np.sqrt(share * (1.0 - share) / 200_000) / np.diff(EDGES)
    assert found.standard_error == pytest.approx(binomial, rel=0.3)


# Kolmogorov distances: by the definition, their tails, and samples of any size.
def uniform(count: int, name: str) -> np.ndarray:
    return np.random.default_rng(seed_of(f"kolmogorov/{name}")).random(count)


def sample_of(values: np.ndarray) -> UniformSample:
    sample = UniformSample()
    sample.add(values)
    return sample


def test_the_distance_is_that_of_the_definition() -> None:
    from scipy.stats import kstest

    for values in (np.square(uniform(50, "few")), uniform(20_000, "some")):
        assert sample_of(values).distance() == pytest.approx(float(kstest(values, "uniform").statistic), abs=1e-4)


def test_the_tail_is_that_of_the_exact_law() -> None:
    from scipy.stats import kstwo

    for count, distance in ((10, 0.6), (40, 0.3), (900, 0.06)):
        assert distance_tail(distance, count) == pytest.approx(float(kstwo.sf(distance, count)), rel=1e-3)
    assert distance_tail(0.02, 10_000) == pytest.approx(float(kstwo.sf(0.02, 10_000)), rel=0.05)
    assert distance_tail(0.0, 10) == distance_tail(0.0, 10_000) == 1.0
    assert distance_tail(2.0, 10) == 0.0


def test_scores_of_right_samples_are_unit_normals() -> None:
    figures = [kolmogorov_figure("x", sample_of(u)) for u in uniform(400 * 2000, "many").reshape(400, -1)]
    scores = np.array([figure.z for figure in figures])
    plain = [(figure.value - (figure.exact or 0.0)) / (figure.error or 1.0) for figure in figures]
    assert abs(scores.mean()) <= 4.0 / 20.0
    assert abs(scores.std() - 1.0) <= 4.0 / np.sqrt(2.0 * 400)
    assert abs(float(np.mean(plain))) <= 4.0 / 20.0
