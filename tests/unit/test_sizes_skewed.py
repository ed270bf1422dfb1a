"""Lognormal, exponential and gamma sizes against textbook laws: moments, samples, live junctions and extremes."""

from math import log, sqrt

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.contact.sizes_gamma import ExponentialSizes, GammaSizes
from rubnoise.contact.sizes_lognormal import LognormalSizes
from tests.unit import law_oracles as oracle
from tests.verification.seeds import seed_of

COUNT = 200_000
SPREADS = [0.05, 0.3, 1.0, 3.0]
LOGNORMAL = [LognormalSizes(mean=5.53, std=5.53 * cv) for cv in SPREADS]
GAMMA = [GammaSizes(mean=5.53, std=5.53 * cv) for cv in SPREADS]
EXPONENTIAL = [ExponentialSizes(mean=5.53)]
LAWS = [*LOGNORMAL, *GAMMA, *EXPONENTIAL]
ENDS = np.array([0.0, 2.0**-53, 0.25, 0.5, 0.75, 1.0 - 2.0**-52, 1.0 - 2.0**-53])


def std_of(law):
    return getattr(law, "std", law.mean)


def distribution(law, biased=0):
    family = oracle.lognormal if isinstance(law, LognormalSizes) else oracle.gamma
    return family(law.mean, std_of(law), biased)


def density(law):
    family = oracle.lognormal_density if isinstance(law, LognormalSizes) else oracle.gamma_density
    return family(law.mean, std_of(law))


def uniforms(law):
    return np.random.default_rng(seed_of(f"sizes/{law}")).random(COUNT)


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("power", [0, 1, 2, 3, 6, 13])
def test_moments_are_those_of_the_density(law, power):
    quadrature = oracle.lognormal_moment if isinstance(law, LognormalSizes) else oracle.gamma_moment
    with mpmath.workdps(30):
        assert law.moment(power) == pytest.approx(float(quadrature(law.mean, std_of(law), power)), rel=1e-12)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_the_density_is_the_textbooks(law):
    diameters = law.draw(np.linspace(0.001, 0.999, 41))
    with mpmath.workdps(30):
        expected = [float(density(law)(mpmath.mpf(d))) for d in diameters.tolist()]
    assert law.density(diameters) == pytest.approx(expected, rel=1e-12)
    assert law.density(np.array([-1.0, 0.0])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_less_than_1e_16_of_a_law_lies_outside_its_support(law):
    low, high = law.support
    assert 0.0 < low < law.mean < high
    variance = log(1.0 + (std_of(law) / law.mean) ** 2)
    if isinstance(law, LognormalSizes):
        z = [(log(d / law.mean) + 0.5 * variance) / sqrt(variance) for d in (low, high)]
        outside = mpmath.ncdf(z[0]) + mpmath.ncdf(-z[1])
    else:
        shape = (law.mean / std_of(law)) ** 2
        below = mpmath.gammainc(shape, 0, shape * low / law.mean, regularized=True)
        outside = below + mpmath.gammainc(shape, shape * high / law.mean, mpmath.inf, regularized=True)
    assert float(outside) <= 1e-16 or low == law.mean * 2.0**-100  # below that no junction is ever made


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_samples_follow_the_law(law):
    drawn = law.draw(uniforms(law))
    assert oracle.ks(drawn, distribution(law)) < oracle.KS_BOUND
    assert oracle.ks(drawn * (1.0 + 0.1 * std_of(law) / law.mean), distribution(law)) > oracle.KS_BOUND


@pytest.mark.parametrize("law", [law for law in LAWS if std_of(law) < 2.0 * law.mean], ids=str)
@pytest.mark.parametrize("power", [1, 2, 3])
def test_samples_have_the_exact_moments(law, power):
    error = sqrt((law.moment(2 * power) - law.moment(power) ** 2) / COUNT)
    mean = np.mean(law.draw(uniforms(law)) ** power)
    assert abs(mean - law.moment(power)) <= 4 * error


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_live_junctions_weigh_by_diameter(law):
    generator = np.random.default_rng(seed_of(f"live sizes/{law}"))
    drawn = law.draw_length_biased(generator, COUNT)
    assert drawn.shape == (COUNT,)
    assert oracle.ks(drawn, distribution(law, 1)) < oracle.KS_BOUND
    assert oracle.ks(law.draw(generator.random(COUNT)), distribution(law, 1)) > oracle.KS_BOUND


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_a_larger_uniform_is_a_larger_diameter(law):
    drawn = law.draw(np.sort(np.concatenate([ENDS, uniforms(law)])))
    assert np.all(np.diff(drawn) >= 0.0)


@pytest.mark.parametrize("kind", [LognormalSizes, GammaSizes])
@settings(max_examples=8, deadline=None)
@given(spread=st.floats(1e-6, 3.0), exponent=st.integers(-6, 6))
def test_extremes_give_finite_positive_diameters(kind, spread, exponent):
    mean = 10.0**exponent
    law = kind(mean=mean, std=spread * mean)
    drawn = np.concatenate([law.draw(ENDS), law.draw_length_biased(np.random.default_rng(1), 50)])
    assert np.all((drawn > 0.0) & np.isfinite(drawn))
    assert np.all(drawn**2 > 0.0)
    assert all(np.isfinite(law.moment(n)) for n in range(14))


def test_two_ways_to_an_exponential_law_agree():
    one, other = ExponentialSizes(mean=2.0), GammaSizes(mean=2.0, std=2.0)
    uniform = uniforms(one)[:1000]
    assert one.draw(uniform) == pytest.approx(other.draw(uniform), rel=1e-13)
    assert one.draw(ENDS)[0] > 0.0
    assert [one.moment(n) for n in range(14)] == [other.moment(n) for n in range(14)]
    places = np.array([0.1, 1.0, 7.0])
    assert one.density(places) == pytest.approx(other.density(places), rel=1e-14)


@pytest.mark.parametrize("kind", [LognormalSizes, GammaSizes])
def test_a_narrow_law_is_nearly_normal(kind):
    """At a spread of 1e-6 the third central moment is 1e-6 of what it could be: ends lie at 8.2 standard deviations."""
    law = kind(mean=1.0, std=1e-6)
    low, *_, high = law.draw(ENDS)
    assert (low - 1.0, high - 1.0) == (pytest.approx(-8.21e-6, rel=1e-3), pytest.approx(8.21e-6, rel=1e-3))
