"""Standard errors of records, wide laws, and the numerics below: reach and rules over sizes."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.distributions import Fixed, Law, Lognormal, Power, Weibull
from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.motion import response
from rubnoise.theory.sampling import standard_errors
from rubnoise.theory.second_order import area_noise, autocovariance, count_noise, spectral_density
from rubnoise.theory.sizes import longest_life, panels
from rubnoise.theory.unit_pulse import energy
from tests.unit.theory_models import FIG5_SLIDER, Gamma, LogNormal, excess, model_of, one_size, paper_model

# Standard errors against records drawn here, from the model's definition and nothing of the simulator.
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
    psi = np.ones(count) if strengths is None else strengths.quantile(generator.random(count))
    first = np.ceil(births / tick).astype(int)
    trace = np.zeros(total)
    for step in range(ticks_a_life + 1):
        at = first + step
        inside = (at >= 0) & (at < total)
        areas = psi[inside] * LENS.area(at[inside] * tick - births[inside], diameter)
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
    assert abs(excess(trace.mean(axis=1), standard_errors(model)["mean"])) <= 4.0


@pytest.fixture(scope="module")
def long_records() -> Records:
    return records(one_size(), 200, 8, seed=12)


@pytest.mark.slow
def test_errors_of_all_four_moments(long_records: Records) -> None:
    trace, model = long_records
    errors = standard_errors(model)
    for name, values in moments(trace).items():
        assert abs(excess(values, errors[name])) <= 4.0, name


@pytest.mark.slow
def test_errors_of_the_moments_of_the_force_under_unequal_strengths() -> None:
    psi = Lognormal(mean=2.0, std=1.0)
    few = model_of(Fixed(value=5.53), 5.53, mean_count=5.0)
    trace, model = records(few, 400, 8, seed=13, strengths=psi)
    errors = standard_errors(replace(model, strengths=psi), None, psi)
    found = moments(trace)
    for name, values in found.items():
        assert abs(excess(values, errors[name])) <= 4.0, name
    assert excess(found["excess_kurtosis"], standard_errors(model)["excess_kurtosis"]) > 8.0


@pytest.mark.slow
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
    assert standard_errors(model, 40_000.0)["std"] > 1.5 * np.sqrt(gaussian)


# The theory where sizes spread over decades, against dense sums and against itself.
MODELS = {
    "lognormal": model_of(LogNormal(5.0, 0.7), 5.0, slider=FIG5_SLIDER),
    "exponential": model_of(Gamma(5.0, 1.0), 5.0, slider=FIG5_SLIDER),
    "exponential triangles": model_of(Gamma(5.0, 1.0), 5.0, pulse=TRIANGLE, slider=FIG5_SLIDER),
    "bounded power": model_of(Power(exponent=2.5, smallest=2.0, largest=20.0), 5.0, slider=FIG5_SLIDER),
    "bounded power, narrow triangles": model_of(
        Power(exponent=1.0, smallest=4.0, largest=6.0), 5.0, pulse=TRIANGLE, slider=FIG5_SLIDER
    ),
    "weibull": model_of(Weibull(mean=5.0, std=4.0), 5.0, slider=FIG5_SLIDER),
    "singular at 0": model_of(Gamma(5.0, 2.0), 5.0, slider=FIG5_SLIDER),
}


def dense(model: Model, wavenumber: float) -> float:
    """Return S(k) on panels a fraction of the swing wide, up to sizes that have no weight left."""
    edges = np.union1d(np.geomspace(1e-8, 1e4, 200), np.arange(1.0, 50_000.0, 4.0) / wavenumber)
    low, high = model.sizes.support
    edges = np.union1d(edges, [max(low, 1e-8), high])
    d, w = panels(edges, 16)
    own = d**6 * energy(model.pulse, wavenumber * d)
    return model.birth_rate * float(np.sum(w * model.sizes.density(d) * own))


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("wavenumber", [0.01, 0.3, 1.0, 5.0, 40.0])
def test_spectral_density(name: str, wavenumber: float) -> None:
    found = float(spectral_density(MODELS[name], wavenumber))
    assert found == pytest.approx(
        dense(MODELS[name], wavenumber), rel=1e-6 if wavenumber < 3.0 else 2e-4 if name == "bounded power" else 1e-5
    )


def spaced(model: Model) -> Doubles:
    """Return ends of panels of lags: octaves from the longest life down."""
    return np.append(0.0, longest_life(model) * 2.0 ** np.arange(-40.0, 0.25, 0.25))


@pytest.mark.slow("0.5-", "2.0-", "30.0-lognormal")
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("tick", [0.5, 2.0, 30.0])
def test_error_of_the_mean_over_coarse_ticks_is_the_sum_over_ticks(name: str, tick: float) -> None:
    model = replace(MODELS[name], tick=tick, tick_count=4_999)
    lags = np.arange(5000.0)
    weights = 2.0 * (1.0 - lags / 5000.0) / 5000.0
    weights[0] *= 0.5
    assert area_noise(model).variance_of_mean() == pytest.approx(weights @ autocovariance(model, lags * tick), rel=1e-6)
    assert count_noise(model).error_of_mean() ** 2 == pytest.approx(
        weights @ count_noise(model).covariance(lags * tick), rel=1e-4
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_variance_of_a_slow_slider_from_the_covariance(name: str) -> None:
    """Over-damped and slow, x follows a first-order law: Var x = int R(tau) exp(-k|tau|/cV) dtau / (2 c k V) psi^2."""
    slider = replace(FIG5_SLIDER, mass=1e-9, damping=3.0)
    model = replace(MODELS[name], slider=slider)
    lags, weights = panels(spaced(model), 24)
    decay = np.exp(-slider.stiffness / (slider.damping * 1000.0) * lags)
    expected = 250.0**2 * weights @ (autocovariance(model, lags) * decay) / (3.0 * 300.0 * 1000.0)
    assert response(model).displacement_std ** 2 == pytest.approx(expected, rel=1e-7)
