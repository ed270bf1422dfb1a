"""Standard errors against records drawn here, from the model's definition and nothing of the simulator."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Fixed, Law, Lognormal
from rubnoise.contact.overlap import junction_area
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.sampling import force_standard_errors, standard_errors, variance_of_time_mean
from rubnoise.theory.spectrum import density_at_zero
from tests.unit.theory_models import excess, model_of, one_size, paper_model

Doubles = NDArray[np.float64]
Records = tuple[Doubles, Model]

RECORDS = 800


def records(model: Model, lives: int, ticks_a_life: int, seed: int, strengths: Law | None = None) -> Records:
    """Draw ``RECORDS`` stationary records one after the other, a row each; births uniform, so Poisson."""
    generator = np.random.default_rng(seed)
    diameter = model.sizes.support[1]
    tick = 2.0 * diameter / ticks_a_life
    total = RECORDS * lives * ticks_a_life
    count = generator.poisson(model.birth_rate * (total * tick + 2.0 * diameter))
    births = generator.uniform(-2.0 * diameter, total * tick, count)
    psi = np.ones(count) if strengths is None else strengths.draw(generator.random(count))
    first = np.ceil(births / tick).astype(int)
    trace = np.zeros(total)
    for step in range(ticks_a_life + 1):
        at = first + step
        inside = (at >= 0) & (at < total)
        areas = psi[inside] * junction_area(at[inside] * tick - births[inside], diameter)
        trace += np.bincount(at[inside], areas, minlength=total)
    return trace.reshape(RECORDS, -1), replace(model, tick=tick, tick_count=lives * ticks_a_life - 1)


def moments(trace: Doubles) -> dict[str, Doubles]:
    z = trace - trace.mean(axis=1, keepdims=True)
    std = z.std(axis=1)
    z = z / std[:, None]
    return {
        "mean": trace.mean(axis=1),
        "std": std,
        "skewness": np.mean(z**3, axis=1),
        "excess_kurtosis": np.mean(z**4, axis=1) - 3.0,
    }


@pytest.mark.parametrize(("lives", "ticks_a_life"), [(1, 8), (6, 4), (40, 1)])
def test_error_of_the_mean_is_exact_for_any_record_and_tick(lives: int, ticks_a_life: int) -> None:
    trace, model = records(one_size(), lives, ticks_a_life, seed=11)
    assert abs(excess(trace.mean(axis=1), standard_errors(model).mean)) <= 4.0


@pytest.fixture(scope="module")
def long_records() -> Records:
    return records(one_size(), 200, 8, seed=12)


def test_errors_of_all_four_moments(long_records: Records) -> None:
    trace, model = long_records
    errors = standard_errors(model)
    for name, values in moments(trace).items():
        assert abs(excess(values, getattr(errors, name))) <= 4.0, name


def test_errors_of_the_moments_of_the_force_under_unequal_strengths() -> None:
    psi = Lognormal(mean=2.0, std=1.0)
    few = model_of(Fixed(value=5.53), 5.53, mean_count=5.0)
    trace, model = records(few, 400, 8, seed=13, strengths=psi)
    errors = force_standard_errors(replace(model, strengths=psi))
    found = moments(trace)
    for name, values in found.items():
        assert abs(excess(values, getattr(errors, name))) <= 4.0, name
    assert excess(found["excess_kurtosis"], standard_errors(model).excess_kurtosis) > 8.0


def test_ticks_taken_as_independent_would_be_far_off(long_records: Records) -> None:
    trace, model = long_records
    naive = area_cumulants(model).std / np.sqrt(model.tick_count + 1)
    assert excess(trace.mean(axis=1), naive) > 40.0
    assert excess(trace.std(axis=1), naive / np.sqrt(2.0)) > 20.0


def test_shot_noise_is_not_gaussian_noise() -> None:
    """The std of a Gaussian process with this autocovariance has Var = int R^2 / (2 sigma^2 T): too small here."""
    model = paper_model(mean_count=0.5)
    lags = np.linspace(0.0, 2.0 * model.sizes.support[1], 401)
    gaussian = np.trapezoid(np.square(autocovariance(model, lags)), lags) / area_cumulants(model).variance / 40_000.0
    assert standard_errors(model, 40_000.0).std > 1.5 * np.sqrt(gaussian)


def test_long_records_have_the_density_at_zero() -> None:
    """Var T = S(0) - (2/T) int |tau| R dtau, so twice the distance halves what is missing."""
    model = paper_model()
    missing = [density_at_zero(model) - t * variance_of_time_mean(model, t) for t in (1e4, 2e4)]
    assert missing[0] / density_at_zero(model) < 1e-3
    assert missing[0] / missing[1] == pytest.approx(2.0, rel=1e-6)


def test_a_record_of_no_length_has_the_variance_itself() -> None:
    model = paper_model()
    variance = area_cumulants(model).variance
    assert variance_of_time_mean(model, 1e-6) == pytest.approx(variance, rel=1e-10)
    assert variance_of_time_mean(replace(model, tick_count=0)) == pytest.approx(variance, rel=1e-12)


def test_many_ticks_are_as_good_as_a_continuous_record() -> None:
    model = replace(paper_model(), tick=0.12, tick_count=9_999)  # 93 ticks a life, beyond the switch to an integral
    lags = model.tick * np.arange(120)
    weights = 2.0 * (1.0 - np.arange(120) / 10_000) / 10_000
    weights[0] *= 0.5
    summed = weights @ autocovariance(model, lags)
    # The weight's corner at no lag makes the two differ by h^2 R(0) / (6 T S(0)) = 2.7e-7.
    assert variance_of_time_mean(model) == pytest.approx(summed, rel=4e-7)
    assert variance_of_time_mean(model, 1200.0) == pytest.approx(summed, rel=4e-7)
