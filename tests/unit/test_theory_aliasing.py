from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.laws import Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.aliasing import sampled_spectral_density
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.estimated_spectrum import expected_periodogram
from rubnoise.theory.segments import tick_covariance
from rubnoise.theory.spectrum import density_at_zero, spectral_density
from tests.unit.drawn_records import Doubles
from tests.unit.theory_models import model_of, one_size, paper_model

MODELS = {
    "one size": one_size(),
    "paper": paper_model(),
    "wide": model_of(Normal(centre=5.53, std=4.0), 5.53),
    "triangles": replace(one_size(), pulse=TRIANGLE),
}
TICKS = [0.0553, 0.5, 0.6, 3.7, 5.53, 20.0]


def by_lags(model: Model, wavenumber: Doubles, tick: float) -> Doubles:
    """Return h sum_j R(j h) cos(k j h), which ends with the longest life."""
    covariance = tick_covariance(model, tick, 2 + int(2.0 * model.sizes.support[1] / tick))
    phases = np.outer(wavenumber, tick * np.arange(covariance.size))
    return tick * (covariance[0] + 2.0 * np.cos(phases[:, 1:]) @ covariance[1:])


@pytest.mark.parametrize("tick", TICKS)
@pytest.mark.parametrize("name", MODELS)
def test_sum_of_aliases_against_the_sum_over_lags(name: str, tick: float) -> None:
    model = MODELS[name]
    k = np.linspace(0.0, np.pi / tick, 9)
    found, expected = sampled_spectral_density(model, k, tick), by_lags(model, k, tick)
    np.testing.assert_allclose(found, expected, rtol=2e-10, atol=1e-9 * density_at_zero(model))


@pytest.mark.parametrize("name", ["one size", "paper"])
@pytest.mark.parametrize("tick", TICKS[1:])
def test_lenses_keep_their_digits_to_the_end_of_the_axis(name: str, tick: float) -> None:
    k = np.array([0.9, 0.95, 1.0]) * np.pi / tick
    expected = by_lags(MODELS[name], k, tick)
    np.testing.assert_allclose(sampled_spectral_density(MODELS[name], k, tick), expected, rtol=1e-6)


def test_beyond_what_the_lags_can_tell_the_aliases_still_fall_with_the_fourth_power() -> None:
    """At h = d/1e4 the end of the axis lies 17 decades below S(0); sum of |n + 1/2|^-4 = pi^4 / 3."""
    model, tick = paper_model(), 5.53e-4
    found = float(sampled_spectral_density(model, np.pi / tick, tick))
    level = 4.0 * model.birth_rate * model.sizes.moment(2) * (tick / (2.0 * np.pi)) ** 4
    assert found == pytest.approx(level * np.pi**4 / 3.0, rel=1e-3)
    assert found < 1e-15 * density_at_zero(model)


def test_even_periodic_and_of_any_shape() -> None:
    model, tick = paper_model(), 0.5
    k = np.array([[0.3, 1.7], [4.0, 6.0]])
    found = sampled_spectral_density(model, k, tick)
    assert found.shape == (2, 2)
    for image in (-k, k + 4.0 * np.pi, 12.0 * np.pi - k):
        np.testing.assert_allclose(sampled_spectral_density(model, image, tick), found, rtol=1e-12)


def test_its_mean_over_a_period_is_the_variance() -> None:
    tick = 0.5
    k = 2.0 * np.pi / tick * np.arange(64) / 64
    mean = sampled_spectral_density(paper_model(), k, tick).mean() / tick
    assert mean == pytest.approx(area_cumulants(paper_model()).variance, rel=1e-9)


def test_without_aliases_the_end_of_the_axis_is_half_as_high() -> None:
    tick = 0.5
    k = np.pi / tick
    ratio = sampled_spectral_density(one_size(), k, tick) / spectral_density(one_size(), k)
    assert ratio == pytest.approx(np.pi**4 / 48.0, rel=0.02)  # sum of (2n + 1)^-4 over all n, and a swing


def test_a_long_window_that_leaks_little_shows_the_sampled_spectrum() -> None:
    tick = 0.5
    k, found = expected_periodogram(one_size(), tick, np.hanning(4096))
    np.testing.assert_allclose(found[20:], sampled_spectral_density(one_size(), k[20:], tick), rtol=1e-3)
