from dataclasses import replace
from math import factorial, pi, sqrt

import mpmath
import numpy as np
import pytest

from rubnoise.contact.laws import Fixed, Weibull
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.theory.campbell import area_cumulants, force_cumulants
from tests.unit.theory_models import one_size, paper_model


@pytest.mark.parametrize("mean_count", [0.01, 1.0, 20.0, 5000.0])
def test_relative_spread_of_equal_sizes_falls_as_the_root_of_their_number(mean_count: float) -> None:
    area = area_cumulants(paper_model(mean_count=mean_count, spread=0.0))
    assert area.std / area.mean == pytest.approx(1.5 * sqrt((2.0 * pi / 3.0 - 64.0 / 45.0) / mean_count), rel=1e-13)


def test_cumulants_are_those_of_the_characteristic_function() -> None:
    """log E[exp(th A)] = lam int (exp(th A(s)) - 1) ds, differentiated numerically at 0, is an independent route."""
    model = one_size()

    def log_characteristic(theta: mpmath.mpf) -> mpmath.mpf:
        def integrand(angle: mpmath.mpf) -> mpmath.mpf:
            area = mpmath.mpf(5.53) ** 2 * (angle - mpmath.sin(angle) * mpmath.cos(angle)) / 2
            return (mpmath.exp(theta * area) - 1) * 5.53 * mpmath.sin(angle)

        return 2 * model.birth_rate * mpmath.quad(integrand, [0, mpmath.pi / 2])

    with mpmath.workdps(40):
        expected = [float(mpmath.diff(log_characteristic, 0, n, h=mpmath.mpf("1e-6"))) for n in range(1, 5)]
    np.testing.assert_allclose(area_cumulants(model).values[:4], expected, rtol=1e-9)


def test_triangles_have_the_cumulants_of_a_uniform_area() -> None:
    """The area of a live triangle is uniform up to pi d^2/4: lam 2 d / (n + 1) times its largest to the power n."""
    model = replace(one_size(), pulse=TRIANGLE)
    largest = pi / 4.0 * 5.53**2
    expected = [20.0 * largest**n / (n + 1) for n in range(1, 7)]
    np.testing.assert_allclose(area_cumulants(model).values, expected, rtol=1e-13)
    assert area_cumulants(model).std / area_cumulants(model).mean == pytest.approx(2.0 / sqrt(60.0), rel=1e-13)


def test_twice_the_births_double_every_cumulant() -> None:
    rare, often = one_size(), one_size()
    often = replace(often, births=replace(often.births, mean_spacing=0.5 * rare.births.mean_spacing))
    np.testing.assert_allclose(area_cumulants(often).values, 2.0 * np.array(area_cumulants(rare).values), rtol=1e-15)


def test_force_is_strength_times_area() -> None:
    model = replace(paper_model(), strengths=Fixed(value=3.0))
    area, force = area_cumulants(model), force_cumulants(model)
    np.testing.assert_allclose(force.values, [k * 3.0**n for n, k in enumerate(area.values, start=1)], rtol=1e-15)
    assert force.skewness == pytest.approx(area.skewness, rel=1e-14)
    assert force.variance == pytest.approx(9.0 * area.std**2, rel=1e-14)


def test_unequal_strengths_bring_their_own_moments() -> None:
    """A Weibull law as wide as its mean is exponential, and has n! times the mean to the power n for moments."""
    model = replace(paper_model(), strengths=Weibull(mean=3.0, std=3.0))
    area, force = area_cumulants(model), force_cumulants(model)
    expected = [k * factorial(n) * 3.0**n for n, k in enumerate(area.values, start=1)]
    np.testing.assert_allclose(force.values, expected, rtol=1e-14)


def test_force_without_a_strength_is_refused() -> None:
    with pytest.raises(Refused, match="strength"):
        force_cumulants(replace(paper_model(), strengths=None))
