"""Exact moments of area and count."""

from collections.abc import Callable
from dataclasses import replace
from math import factorial, pi, sqrt

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.distributions import Fixed, Gamma, Law, Lognormal, Normal, Weibull
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.moments import area_cumulants, force_cumulants, zero_share
from rubnoise.theory.second_order import autocovariance, count_noise
from rubnoise.theory.sizes import COARSE, FINE, sizes_of
from tests.laws.scores import seed_of
from tests.unit.theory_models import excess, model_of, one_size, paper_model


@pytest.mark.parametrize("mean_count", [0.01, 1.0, 20.0, 5000.0])
def test_relative_spread_of_equal_sizes_falls_as_the_root_of_their_number(mean_count: float) -> None:
    area = area_cumulants(paper_model(mean_count=mean_count, spread=0.0))
    assert area.std / area.mean == pytest.approx(1.5 * sqrt((2.0 * pi / 3.0 - 64.0 / 45.0) / mean_count), rel=1e-13)


@pytest.mark.slow
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


def test_unequal_strengths_bring_their_own_moments() -> None:
    """A Weibull law as wide as its mean is exponential, and has n! times the mean to the power n for moments."""
    model = replace(paper_model(), strengths=Weibull(mean=3.0, std=3.0))
    area, force = area_cumulants(model), force_cumulants(model)
    expected = [k * factorial(n) * 3.0**n for n, k in enumerate(area.values, start=1)]
    np.testing.assert_allclose(force.values, expected, rtol=1e-13)


Doubles = NDArray[np.float64]

WIDE = model_of(Normal(centre=2.0, std=3.0), 2.0)


def dense(model: Model, function: Callable[[Doubles], Doubles]) -> float:
    """Return E[g(d)] by the trapezium rule on 400 001 points."""
    d = np.linspace(*model.sizes.support, 400_001)
    return np.trapezoid(function(d) * model.sizes.density(d), d)


@pytest.mark.parametrize("lag", [0.0, 0.3, 4.0, 11.0, 30.0])
def test_covariance_is_the_life_that_is_left(lag: float) -> None:
    expected = WIDE.birth_rate * dense(WIDE, lambda d: np.maximum(2.0 * d - lag, 0.0))
    assert count_noise(WIDE).covariance(lag) == pytest.approx(expected, rel=1e-8, abs=1e-9)
    assert count_noise(WIDE).covariance(-lag) == count_noise(WIDE).covariance(lag)


@pytest.mark.parametrize("percent", [0.3, 4.0, 15.0])
@pytest.mark.parametrize("lag", [0.0, 4.0, 7.9, 8.3])
def test_covariance_of_sizes_that_end_sharply_above(percent: float, lag: float) -> None:
    """Triangles overlap as a cubic spline; sizes of a narrow Weibull law reach far below its mean, and hardly above."""
    model = replace(model_of(Weibull(mean=4.0, std=0.04 * percent), 4.0), pulse=TRIANGLE)

    def covariance(t: float) -> float:
        return dense(
            model, lambda d: d**5 * (np.maximum(2.0 - t / d, 0.0) ** 3 - 4.0 * np.maximum(1.0 - t / d, 0.0) ** 3)
        )

    found = float(autocovariance(model, lag) / autocovariance(model, 0.0))
    assert found == pytest.approx(covariance(lag) / covariance(0.0), rel=0.0, abs=1e-8)


@pytest.mark.parametrize("law", [Lognormal(mean=1.0, std=4.0), Gamma(mean=1.0, std=1.3), Weibull(mean=1.0, std=0.04)])
@pytest.mark.parametrize(("fineness", "error"), [(FINE, 1e-12), (COARSE, 2e-4)])
def test_sizes_have_all_their_moments(law: Law, fineness: float, error: float) -> None:
    sizes = sizes_of(law, fineness)
    for power in (1, 2, 4, 6, 8):
        assert sizes.probability @ sizes.diameter**power == pytest.approx(law.moment(power), rel=error)


@pytest.mark.parametrize("distance", [3.0, 11.06, 200.0, 40_000.0])
def test_error_of_the_mean_count_in_closed_form(distance: float) -> None:
    life, reach = 11.06, min(distance, 11.06)
    integral = distance * life * reach - (distance + life) * reach**2 / 2.0 + reach**3 / 3.0
    variance = 2.0 * one_size().birth_rate * integral / distance**2
    assert count_noise(one_size()).error_of_mean(distance) == pytest.approx(np.sqrt(variance), rel=1e-12)


def of_one_size(count: float, tick: float, ticks: int) -> Model:
    """Return a contact of lives of 10 um."""
    contact = model_of(Fixed(value=5.0), 5.0, count, distance=tick * (ticks - 1), tick=tick)
    assert contact.tick_count == ticks - 1
    return contact


def empty_ticks(model: Model, runs: int, name: str) -> Doubles:
    """Return the share of ticks without a junction, run by run, from births and deaths alone."""
    generator = np.random.default_rng(seed_of(f"occupancy/{name}"))
    life, ticks = 2.0 * model.sizes.support[1], model.tick * np.arange(model.tick_count + 1)
    shares = []
    for count in generator.poisson(model.birth_rate * (ticks[-1] + life), runs):
        birth = generator.uniform(-life, ticks[-1], count)
        death = birth + life
        alive = np.searchsorted(np.sort(birth), ticks, "right") - np.searchsorted(np.sort(death), ticks, "right")
        shares.append(np.mean(alive == 0))
    return np.array(shares)


@pytest.mark.parametrize(("count", "tick"), [(0.1, 3.0), (0.7, 0.1), (3.0, 0.5)])
def test_the_share_without_contact_has_the_law_that_is_said(count: float, tick: float) -> None:
    run, runs = of_one_size(count, tick, 401), 2000
    (mean, error, _), shares = zero_share(run), empty_ticks(of_one_size(count, tick, 401), runs, f"zero/{count}")
    assert abs(shares.mean() - mean) <= 4.0 * error / runs**0.5
    assert abs(excess(shares, error)) <= 4.0
    independent = (mean * (1.0 - mean) / 401) ** 0.5
    assert excess(shares, independent) > 5.0


@pytest.mark.parametrize("count", [0.05, 1.0, 4.0])
def test_the_skewness_of_the_share_without_contact_is_that_of_all_triples_of_ticks(count: float) -> None:
    """The third cumulant of the sum grows by as much from tick to tick, once the first ticks are forgotten."""
    tick, ticks = 1.0, 10**6
    _, error, skewness = zero_share(of_one_size(count, tick, ticks))
    third = third_cumulant(count, 61) - third_cumulant(count, 60)
    assert skewness * (error * ticks) ** 3 / ticks == pytest.approx(third, rel=1e-4)


def third_cumulant(count: float, ticks: int) -> float:
    """Return that of the number of empty ticks 1 um apart, lives of 10 um: summed over all triples."""
    p = np.exp(-count)
    again = p * np.exp(count * np.maximum(1.0 - 0.1 * np.arange(ticks), 0.0))
    i, j, k = np.sort(np.indices((ticks,) * 3).reshape(3, -1), axis=0)
    one, two = ticks * p, p * again[np.abs(np.subtract.outer(np.arange(ticks), np.arange(ticks)))].sum()
    three = p * float(again[j - i] @ again[k - j])
    return three - 3.0 * two * one + 2.0 * one**3
