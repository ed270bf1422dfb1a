"""Every strength law: its moments, its samples and its extremes."""

from math import sqrt

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.contact.strengths import ConstantStrength
from rubnoise.contact.strengths_spread import LognormalStrength, NormalStrength, WeibullStrength, strengths_for
from tests.unit import law_oracles as oracle
from tests.verification.seeds import seed_of

COUNT = 200_000
ENDS = np.array([0.0, 2.0**-53, 0.25, 0.5, 0.75, 1.0 - 2.0**-53])
NORMAL = [NormalStrength(centre=250.0, std=std) for std in (25.0, 250.0, 1000.0)]
LOGNORMAL = [LognormalStrength(mean=250.0, std=std) for std in (25.0, 250.0)]
WEIBULL = [WeibullStrength(mean=250.0, std=std) for std in (25.0, 50.0, 250.0, 500.0)]
LAWS = [*NORMAL, *LOGNORMAL, *WEIBULL]


def distribution(law):
    if isinstance(law, NormalStrength):
        return oracle.normal(law.centre, law.std)
    return (oracle.lognormal if isinstance(law, LognormalStrength) else oracle.weibull)(law.mean, law.std)


def drawn(law):
    return law.draw(np.random.default_rng(seed_of(f"strengths/{law}")).random(COUNT))


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("power", [1, 2, 3, 6])
def test_moments_are_those_of_a_quadrature(law, power):
    name = type(law).__name__.removesuffix("Strength").lower()
    with mpmath.workdps(30):
        expected = getattr(oracle, f"{name}_moment")(getattr(law, "centre", law.mean), law.std, power)
    assert law.moment(power) == pytest.approx(float(expected), rel=1e-12)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_samples_follow_the_law(law):
    sample = drawn(law)
    assert oracle.ks(sample, distribution(law)) < oracle.KS_BOUND
    assert oracle.ks(sample + 0.02 * law.std, distribution(law)) > oracle.KS_BOUND


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("power", [1, 2, 3])
def test_samples_have_the_exact_moments(law, power):
    error = sqrt((law.moment(2 * power) - law.moment(power) ** 2) / COUNT)
    assert abs(np.mean(drawn(law) ** power) - law.moment(power)) <= 4 * error


@pytest.mark.parametrize("law", [*LOGNORMAL, *WEIBULL], ids=str)
def test_mean_and_spread_are_as_given(law):
    assert law.moment(0) == 1.0
    assert law.moment(1) == pytest.approx(law.mean, rel=1e-15)
    assert law.moment(2) - law.moment(1) ** 2 == pytest.approx(law.std**2, rel=1e-12)


def test_redrawn_strengths_exceed_their_centre_on_average():
    law = NormalStrength(centre=250.0, std=250.0)
    assert law.mean == law.moment(1) == pytest.approx(250.0 * 1.2876, rel=1e-4)


def test_a_weibull_law_of_a_spread_of_its_mean_is_exponential():
    law = WeibullStrength(mean=3.0, std=3.0)
    assert law.draw(ENDS[1:]) == pytest.approx(-3.0 * np.log1p(-ENDS[1:]), rel=1e-14)
    assert law.moment(3) == pytest.approx(6.0 * 27.0, rel=1e-15)


@pytest.mark.parametrize("name", ["normal", "lognormal", "weibull"])
@settings(max_examples=30, deadline=None)
@given(spread=st.floats(1e-6, 3.0), exponent=st.integers(-6, 6))
def test_extremes_give_finite_positive_strengths(name, spread, exponent):
    mean = 10.0**exponent
    law = strengths_for(name, mean, spread * mean)
    ends = law.draw(ENDS)
    assert np.all((ends > 0.0) & np.isfinite(ends))
    assert np.all(np.diff(ends) >= 0.0)
    assert all(np.isfinite(law.moment(n)) for n in range(7))


@pytest.mark.parametrize("name", ["constant", "normal", "lognormal", "weibull"])
def test_no_spread_is_one_strength(name):
    law = strengths_for(name, 250.0, 0.0)
    assert law == ConstantStrength(mean=250.0)
    assert [law.moment(n) for n in (0, 1, 2)] == [1.0, 250.0, 62_500.0]
    assert law.draw(ENDS).tolist() == [250.0] * ENDS.size
