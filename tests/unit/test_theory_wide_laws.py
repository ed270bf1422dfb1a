"""The theory where sizes spread over decades, against dense sums and against itself."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Power, Weibull
from rubnoise.contact.pulses import PULSES, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.lags import lag_edges, longest_life
from rubnoise.theory.occupancy import count_covariance, mean_count, mean_count_error
from rubnoise.theory.pulse_energy import largest_swinging_wavenumber
from rubnoise.theory.quadrature import panels
from rubnoise.theory.response import response
from rubnoise.theory.sampling import standard_errors, variance_of_time_mean
from rubnoise.theory.spectrum import density_at_zero, spectral_density
from rubnoise.theory.transform import transform_of
from rubnoise.theory.transient import area_from_empty
from tests.unit.size_laws import Gamma, LogNormal
from tests.unit.theory_models import FIG5_SLIDER, model_of

Doubles = NDArray[np.float64]

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
    energy = d**6 * transform_of(model.pulse).square(wavenumber * d)
    return model.birth_rate * float(np.sum(w * model.sizes.density(d) * energy))


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("wavenumber", [0.01, 0.3, 1.0, 5.0, 40.0])
def test_spectral_density(name: str, wavenumber: float) -> None:
    found = float(spectral_density(MODELS[name], wavenumber))
    assert found == pytest.approx(dense(MODELS[name], wavenumber), rel=1e-9)


@pytest.mark.parametrize("relative_spread", [0.1, 0.2, 0.35, 0.5])
@pytest.mark.parametrize("law", [LogNormal, Gamma])
@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_spectral_density_just_beyond_the_last_swing_that_is_followed(
    relative_spread: float, law: type[LogNormal], pulse: Pulse
) -> None:
    model = model_of(law(5.0, relative_spread), 5.0, pulse=pulse)
    for k in (0.999, 1.001, 1.4) * np.array(largest_swinging_wavenumber(model.sizes)):
        assert float(spectral_density(model, k)) == pytest.approx(dense(model, k), rel=1e-9)


@pytest.mark.parametrize("name", MODELS)
def test_covariances_at_no_lag_and_over_all_lags(name: str) -> None:
    model = MODELS[name]
    lags, weights = panels(lag_edges(model, longest_life(model)), 16)
    assert autocovariance(model, 0.0) == pytest.approx(area_cumulants(model).variance, rel=1e-12)
    assert 2.0 * weights @ autocovariance(model, lags) == pytest.approx(density_at_zero(model), rel=1e-9)
    assert count_covariance(model, 0.0) == pytest.approx(mean_count(model), rel=1e-12)
    # int (2d - tau)+ over both signs of tau is 4 d^2
    expected = model.birth_rate * 4.0 * model.sizes.moment(2)
    assert 2.0 * weights @ count_covariance(model, lags) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("tick", [0.5, 2.0, 30.0])
def test_error_of_the_mean_over_coarse_ticks_is_the_sum_over_ticks(name: str, tick: float) -> None:
    model = replace(MODELS[name], tick=tick, tick_count=4_999)
    lags = np.arange(5000.0)
    weights = 2.0 * (1.0 - lags / 5000.0) / 5000.0
    weights[0] *= 0.5
    assert variance_of_time_mean(model) == pytest.approx(weights @ autocovariance(model, lags * tick), rel=1e-6)
    assert mean_count_error(model) ** 2 == pytest.approx(weights @ count_covariance(model, lags * tick), rel=1e-4)


@pytest.mark.parametrize("name", MODELS)
def test_a_long_record_spreads_by_the_density_at_zero(name: str) -> None:
    model, far = MODELS[name], 1e9
    assert far * variance_of_time_mean(model, far) == pytest.approx(density_at_zero(model), rel=1e-5)
    errors = standard_errors(model, far)
    assert 0.0 < errors.mean < 2.0 * errors.std
    assert errors.skewness < errors.excess_kurtosis


@pytest.mark.parametrize("name", MODELS)
def test_an_empty_start_ends_in_the_mean(name: str) -> None:
    model = MODELS[name]
    settled = area_from_empty(model, [longest_life(model), 1e9])
    np.testing.assert_allclose(settled, area_cumulants(model).mean, rtol=1e-12)


@pytest.mark.parametrize("name", MODELS)
def test_variance_of_a_slow_slider_from_the_covariance(name: str) -> None:
    """Over-damped and slow, x follows a first-order law: Var x = int R(tau) exp(-k|tau|/cV) dtau / (2 c k V) psi^2."""
    slider = replace(FIG5_SLIDER, mass=1e-9, damping=3.0)
    model = replace(MODELS[name], slider=slider)
    lags, weights = panels(lag_edges(model, longest_life(model)), 24)
    decay = np.exp(-slider.stiffness / (slider.damping * 1000.0) * lags)
    expected = 250.0**2 * weights @ (autocovariance(model, lags) * decay) / (3.0 * 300.0 * 1000.0)
    assert response(model).displacement_std ** 2 == pytest.approx(expected, rel=1e-7)
