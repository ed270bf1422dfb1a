from dataclasses import replace

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Fixed, Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.live_junctions import (
    age_density,
    age_distribution,
    age_moment,
    live_area_moment,
    live_diameter_density,
    live_diameter_distribution,
    live_diameter_moment,
)
from rubnoise.theory.occupancy import count_covariance, length_biased_mean_diameter, mean_count
from rubnoise.theory.quadrature import panels
from tests.unit.theory_models import model_of, one_size
from tests.verification.seeds import seed_of

LAWS = {"narrow": Normal(centre=5.53, std=0.2), "wide": Normal(centre=2.0, std=3.0)}
EACH_LAW = pytest.mark.parametrize("name", LAWS)
COUNT = 200_000


def over_support(law: Normal) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    low, high = law.support
    return panels(np.linspace(low, high, 101), 16)


@EACH_LAW
def test_density_of_live_diameters_has_their_mass_and_moments(name: str) -> None:
    law = LAWS[name]
    d, weights = over_support(law)
    mass = weights * live_diameter_density(law, d)
    assert mass.sum() == pytest.approx(1.0, rel=1e-11)
    for power in (1, 2, 3):
        assert mass @ d**power == pytest.approx(live_diameter_moment(law, power), rel=1e-11)


@EACH_LAW
@pytest.mark.parametrize("at", [0.3, 0.9, 1.0, 1.1, 2.5])
def test_distributions_by_thirty_digit_quadrature(name: str, at: float) -> None:
    """The law written again from its definition, a normal one given d > 0, and both integrals taken plainly."""
    law = LAWS[name]
    place = at * law.centre
    with mpmath.workdps(30):
        mean, std = mpmath.mpf(law.centre), mpmath.mpf(law.std)

        def density(d: mpmath.mpf) -> mpmath.mpf:
            return mpmath.npdf(d, mean, std) / mpmath.ncdf(mean / std)

        cuts = sorted({mpmath.mpf(0), mpmath.mpf(place)} | {x for n in range(-8, 9) if (x := mean + n * std) > 0})
        below = [x for x in cuts if x <= place]
        above = [*(x for x in cuts if x >= place), mean + 40 * std]
        first = mpmath.quad(lambda d: d * density(d), [*cuts, mean + 40 * std])
        smaller = mpmath.quad(lambda d: d * density(d), below) / first
        longer = mpmath.quad(density, above)
        age = mpmath.quad(lambda d: d * density(d), below) + place * longer
        expected = [float(x) for x in (smaller, longer / (2 * first), age / first)]
    found = [
        live_diameter_distribution(law, place),
        age_density(law, 2.0 * place),
        age_distribution(law, 2.0 * place),
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-14)


@EACH_LAW
def test_age_has_the_moments_of_its_density(name: str) -> None:
    law = LAWS[name]
    a, weights = panels(np.linspace(0.0, 2.0 * law.support[1], 161), 16)
    mass = weights * age_density(law, a)
    assert mass.sum() == pytest.approx(1.0, rel=1e-10)
    for power in (1, 2):
        assert mass @ a**power == pytest.approx(age_moment(law, power), rel=1e-10)


@EACH_LAW
def test_a_drawn_population_looks_as_foretold(name: str) -> None:
    """Junctions picked with chance proportional to their life, at an age uniform on it."""
    law = LAWS[name]
    generator = np.random.default_rng(seed_of(f"live junctions, {name}"))
    born = law.draw(generator.random(8 * COUNT))
    seen = generator.choice(born, COUNT, p=born / born.sum())
    age = 2.0 * seen * generator.random(COUNT)
    for values, moment in ((seen, live_diameter_moment), (age, age_moment)):
        spread = np.sqrt(moment(law, 2) - moment(law, 1) ** 2)
        # Picked from one sample of births, which itself strays: its ratio of means adds an eighth.
        assert abs(values.mean() - moment(law, 1)) <= 4.0 * spread * np.sqrt(1.5 / COUNT)
    places = np.quantile(seen, [0.1, 0.5, 0.9])
    np.testing.assert_allclose(live_diameter_distribution(law, places), [0.1, 0.5, 0.9], atol=4.0 * 0.6 / COUNT**0.5)
    places = np.quantile(age, [0.1, 0.5, 0.9])
    np.testing.assert_allclose(age_distribution(law, places), [0.1, 0.5, 0.9], atol=4.0 * 0.6 / COUNT**0.5)


def test_the_sizes_that_are_born_are_not_those_that_are_seen() -> None:
    law = LAWS["wide"]
    spread = np.sqrt(live_diameter_moment(law, 2) - live_diameter_moment(law, 1) ** 2)
    assert (live_diameter_moment(law, 1) - law.moment(1)) / (spread * np.sqrt(1.5 / COUNT)) > 100.0


def test_one_size_is_a_point_mass_with_a_uniform_age() -> None:
    law = Fixed(value=5.0)
    d = np.array([[4.999, 5.0], [5.001, -1.0]])
    np.testing.assert_array_equal(live_diameter_density(law, d), 0.0)
    np.testing.assert_array_equal(live_diameter_distribution(law, d), [[0.0, 1.0], [1.0, 0.0]])
    a = np.array([-1.0, 0.0, 2.5, 9.99, 10.01])
    np.testing.assert_allclose(age_density(law, a), [0.0, 0.1, 0.1, 0.1, 0.0], rtol=1e-15)
    np.testing.assert_allclose(age_distribution(law, a), [0.0, 0.0, 0.25, 0.999, 1.0], rtol=1e-15)
    assert age_moment(law, 1) == pytest.approx(5.0)


def test_live_areas_add_up_to_the_contact() -> None:
    """Wald: E[A_r] = E[N] E[A], and E[A^2] E[N] = Var A_r, for both pulses."""
    for model in (one_size(), model_of(LAWS["wide"], 2.0), replace(one_size(), pulse=TRIANGLE)):
        cumulants = area_cumulants(model)
        for power in (1, 2, 3):
            expected = cumulants.values[power - 1]
            assert mean_count(model) * live_area_moment(model, power) == pytest.approx(expected, rel=1e-13)


def test_it_agrees_with_the_live_count() -> None:
    """Those alive at s and still at s + tau have more than tau left: Cov[N, N_tau] = E[N] P(rest > tau)."""
    model = model_of(LAWS["wide"], 2.0)
    lags = np.array([0.0, 0.5, 4.0, 11.0])
    expected = count_covariance(model, lags) / mean_count(model)
    np.testing.assert_allclose(1.0 - age_distribution(model.sizes, lags), expected, rtol=1e-11)
    assert length_biased_mean_diameter(model) == pytest.approx(live_diameter_moment(model.sizes, 1))
