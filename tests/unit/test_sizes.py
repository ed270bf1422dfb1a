"""Every size law: samples against its own exact moments, and its length-biased form against theirs."""

from decimal import Decimal, localcontext

import numpy as np
import pytest
from scipy import integrate

from rubnoise.contact.sizes import FixedSizes, NormalSizes

COUNT = 100_000
LAWS = [
    FixedSizes(diameter=5.53),
    NormalSizes(mean=5.53, std=0.2),
    NormalSizes(mean=1.0, std=1.0),
    NormalSizes(mean=0.4, std=2.0),
]


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("power", [1, 2, 3, 5])
def test_samples_have_the_exact_moments(law, power):
    mean = np.mean(law.draw(np.random.default_rng(7).random(COUNT)) ** power)
    error = np.sqrt(max(law.moment(2 * power) - law.moment(power) ** 2, 0.0) / COUNT)
    assert abs(mean - law.moment(power)) <= 4 * error + 1e-12 * mean


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_length_biased_samples_weigh_by_diameter(law):
    drawn = law.draw_length_biased(np.random.default_rng(8), COUNT)
    first, second = (law.moment(n + 1) / law.moment(1) for n in (1, 2))
    assert abs(drawn.mean() - first) <= 4 * np.sqrt(max(second - first**2, 0.0) / COUNT) + 1e-12


def test_unbiased_sizes_are_told_from_length_biased_ones():
    law = NormalSizes(mean=1.0, std=1.0)
    drawn = law.draw(np.random.default_rng(8).random(COUNT))
    first, second = (law.moment(n + 1) / law.moment(1) for n in (1, 2))
    assert abs(drawn.mean() - first) > 4 * np.sqrt((second - first**2) / COUNT)


@pytest.mark.parametrize("law", LAWS[1:], ids=str)
@pytest.mark.parametrize("power", [0, 1, 3, 7])
def test_density_has_the_exact_moments(law, power):
    low, high = law.support
    value, _ = integrate.quad(lambda d: d**power * float(law.density(np.array(d))), low, high, epsrel=1e-12)
    assert value == pytest.approx(law.moment(power), rel=1e-10)


def test_moments_of_one_size_are_rounded_once():
    """The third goes into the slider's start, so its last bit may not be up to a library: one of these is not pow's."""
    diameters = np.random.default_rng(5).uniform(1.0, 20.0, 1000).tolist()
    with localcontext(prec=400):
        exact = [float(Decimal(d) ** 3) for d in diameters]
    assert [FixedSizes(diameter=d).moment(3) for d in diameters] == exact


def test_redrawing_is_not_reflecting():
    """|d| in place of drawing again has another mean, and would be seen."""
    law = NormalSizes(mean=0.4, std=2.0)
    reflected = np.abs(np.random.default_rng(3).normal(0.4, 2.0, COUNT))
    error = np.sqrt((law.moment(2) - law.moment(1) ** 2) / COUNT)
    assert abs(reflected.mean() - law.moment(1)) > 4 * error


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_diameters_are_positive_at_both_ends_of_the_uniforms(law):
    ends = law.draw(np.array([0.0, 2.0**-53, 0.5, 1.0 - 2.0**-53]))
    assert np.all(ends > 0.0)
    assert np.all(np.isfinite(ends))
