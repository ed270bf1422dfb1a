from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.laws import Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.occupancy import mean_count
from rubnoise.theory.transient import area_from_empty, expected_mean_area, expected_mean_count
from tests.unit.theory_models import model_of, one_size, paper_model

WIDE = Normal(centre=2.0, std=3.0)
MODELS = {
    "one size": one_size(),
    "fig5": paper_model(),
    "wide": model_of(WIDE, 2.0),
    "triangle": model_of(WIDE, 2.0, pulse=TRIANGLE),
    "one triangle": replace(one_size(), pulse=TRIANGLE),
}


def by_trapezium(model: Model, distance: float) -> float:
    """Return lam E[int_0^s A ds'] from dense sums over age and diameter."""
    low, high = model.sizes.support
    ages = np.linspace(0.0, distance, 2001)
    if low == high:
        return model.birth_rate * float(np.trapezoid(model.pulse.area(ages, high), ages))
    d = np.linspace(low, high, 2002)[1:]
    grown = np.trapezoid(model.pulse.area(ages, d[:, None]), ages, axis=1)
    return model.birth_rate * float(np.trapezoid(grown * model.sizes.density(d), d))


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("distance", [0.5, 4.0, 9.0])
def test_area_grows_from_empty_as_the_lives_do(name: str, distance: float) -> None:
    model = MODELS[name]
    assert area_from_empty(model, distance) == pytest.approx(by_trapezium(model, distance), rel=2e-5)


@pytest.mark.parametrize("name", MODELS)
def test_area_is_settled_from_the_longest_life_on(name: str) -> None:
    model = MODELS[name]
    longest = 2.0 * model.sizes.support[1]
    found = area_from_empty(model, [0.0, longest, 3.0 * longest])
    np.testing.assert_allclose(found, area_cumulants(model).mean * np.array([0.0, 1.0, 1.0]), rtol=1e-12)


@pytest.mark.parametrize("name", MODELS)
def test_an_empty_start_lowers_the_means_by_a_lifes_worth(name: str) -> None:
    """A junction waits d on average for its area and its count: lam c_1 m_4 / T and lam 2 m_2 / T are missing."""
    model = replace(MODELS[name], start="empty")
    m = model.sizes.moment
    area = area_cumulants(model).mean - model.birth_rate * model.pulse.life_integral(1) * m(4) / 500.0
    count = mean_count(model) - model.birth_rate * 2.0 * m(2) / 500.0
    assert expected_mean_area(model, 500.0) == pytest.approx(area, rel=1e-9)
    assert expected_mean_count(model, 500.0) == pytest.approx(count, rel=1e-6)


def test_a_stationary_start_has_nothing_to_wait_for() -> None:
    model = MODELS["fig5"]
    assert expected_mean_area(model, 3.0) == area_cumulants(model).mean
    assert expected_mean_count(model, 3.0) == mean_count(model)
