"""The distribution of real contact area against what is known of it by other routes.

Cumulants by Campbell's theorem, closed forms for triangles, the slow routes of the oracle, expansions for very many
junctions.
"""

from math import exp, factorial, floor, inf, pi, sqrt

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr

from rubnoise.contact.distributions import Fixed, Gamma, Law, Lognormal, Weibull
from rubnoise.contact.laws import Spread, law_for
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.theory.moments import Distribution, area_cumulants, distribution
from tests.oracle.slow_contact import brackets, davies
from tests.unit.theory_models import model_of

Doubles = NDArray[np.float64]

MEAN = 5.53
PEAK = 0.25 * pi * MEAN**2
COUNTS = [0.01, 0.5, 5.0, 20.0, 5000.0, 1.0, 500.0]
SPREADS = {
    "none": Spread(),
    "0.2 um": Spread(absolute=0.2),
    "20 %": Spread(relative=0.2),
    "150 %": Spread(relative=1.5),
}


def contact(count: float, spread: str = "none", pulse: Pulse = LENS) -> Model:
    return model_of(law_for(MEAN, SPREADS[spread]), MEAN, count, pulse=pulse)


def with_law(law: Law, count: float) -> Model:
    return model_of(law, law.moment(1), count)


def masses(law: Distribution) -> tuple[Doubles, Doubles]:
    """Return areas and probabilities beside the atom: those of the steps of the grid, whose density is their mean."""
    return law.grid, law.grid_density * (law.grid[1] - law.grid[0])


def cumulants_of(moments: list[float]) -> list[float]:
    """Return mean, variance and the next two cumulants from the mean and three central moments."""
    mean, second, third, fourth = moments
    return [mean, second, third, fourth - 3.0 * second**2]


# Mass and moments.


@pytest.mark.slow("20 %", "150 %")
@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("count", COUNTS)
def test_mass_and_four_cumulants_by_the_density(count: float, spread: str, pulse: Pulse) -> None:
    model = contact(count, spread, pulse)
    law, exact = distribution(model), area_cumulants(model)
    area, mass = masses(law)
    assert law.atom_at_zero == pytest.approx(exp(-model.mean_live_junctions), rel=1e-14)
    assert law.atom_at_zero + mass.sum() == pytest.approx(1.0, abs=5e-4)  # steps next to 0 and to a cusp are coarse
    mean = float(mass @ area)
    central = [float(mass @ (area - exact.mean) ** n + law.atom_at_zero * (-exact.mean) ** n) for n in (2, 3, 4)]
    found = cumulants_of([mean, *central])
    many = count >= 20.0  # of few, what rings beside a cusp is cut off at 0, and that is left over in the tail
    assert mean == pytest.approx(exact.mean, rel=1e-7 if many else 3e-3)
    assert found[1] == pytest.approx(exact.variance, rel=2e-6 if many else 2e-2)
    if many:
        assert found[2:] == pytest.approx(exact.values[2:4], rel=1e-4)


@pytest.mark.slow("0.5-150 %", "5.0-20 %", "5.0-150 %", "1.0-20 %", "1.0-150 %")
@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("count", COUNTS)
def test_four_moments_by_the_distribution_function(count: float, spread: str) -> None:
    """E[A^n] = int_0^inf n a^(n-1) P(A > a) da."""
    model = contact(count, spread)
    law, (mean, second, third, fourth) = distribution(model), area_cumulants(model).values[:4]
    area = law.grid
    above, start = 1.0 - law.cdf(area), area[0]
    found = [n * float(np.trapezoid(above * area ** (n - 1), area)) + start**n for n in (1, 2, 3, 4)]
    moments = [
        mean,
        second + mean**2,
        third + 3.0 * second * mean + mean**3,
        fourth + 4.0 * third * mean + 3.0 * second**2 + 6.0 * second * mean**2 + mean**4,
    ]
    assert found == pytest.approx(moments, rel=1e-6 if count >= 5.0 else 1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "law",
    [
        Lognormal(mean=MEAN, std=0.3 * MEAN),
        Gamma(mean=MEAN, std=0.5 * MEAN),
        Weibull(mean=MEAN, std=MEAN),
        Lognormal(mean=MEAN, std=MEAN),
    ],
    ids=["lognormal", "gamma", "exponential", "wide lognormal"],
)
@pytest.mark.parametrize("count", [0.5, 20.0, 300.0])
def test_laws_with_a_long_tail(law: Law, count: float) -> None:
    """Only the mean, where the tail that doubles can hold is the moment's: the fourth needs probabilities of 1e-20."""
    model = with_law(law, count)
    found = distribution(model)
    area = found.grid
    mean = area[0] + float(np.trapezoid(1.0 - found.cdf(area), area))
    assert mean == pytest.approx(area_cumulants(model).mean, rel=1e-4 if count > 1.0 else 3e-3)


# Against other routes.


def triangles(count: float, x: float) -> tuple[float, float]:
    """Return P(A_r <= x peak) and the density times peak for triangles of one size, at 60 digits.

    One is uniform on [0, peak], n are Irwin and Hall's: sum over k <= x of (-1)^k C(n, k) (x - k)^n / n!.
    """
    with mpmath.workdps(60):
        cdf, density = mpmath.exp(-count), mpmath.mpf(0)
        for n in range(1, int(count + 14.0 * sqrt(count) + 25.0)):
            chance = mpmath.exp(-count) * mpmath.mpf(count) ** n / factorial(n)
            if x >= n:
                cdf += chance
                continue
            signs = [(-1) ** k * mpmath.binomial(n, k) for k in range(floor(x) + 1)]
            cdf += chance * sum(c * (mpmath.mpf(x) - k) ** n for k, c in enumerate(signs)) / factorial(n)
            density += chance * sum(c * (mpmath.mpf(x) - k) ** (n - 1) for k, c in enumerate(signs)) / factorial(n - 1)
        return float(cdf), float(density)


@pytest.mark.slow("90.0")
@pytest.mark.parametrize("count", [0.01, 0.5, 1.0, 3.0, 20.0, 90.0])
def test_triangles_of_one_size_in_closed_form(count: float) -> None:
    law = distribution(contact(count, pulse=TRIANGLE))
    spread = sqrt(count / 3.0)
    singular = [1e-6, 1e-3, 0.999, 1.001, 1.0, 2.001]
    smooth = [0.1, 0.4, 0.7, 1.3, 1.7, 2.5, 4.2, 0.5 * count + 1.3, 0.5 * count + 2.0 * spread]
    for x in singular + smooth:
        cdf, density = triangles(count, x)
        assert float(law.cdf(x * PEAK)) == pytest.approx(cdf, abs=3e-5 if x in singular else 1e-7)
        error = spread * abs(float(law.density(x * PEAK)) * PEAK - density)
        steps = min(x, abs(x - 1.0)) * PEAK / (law.grid[1] - law.grid[0])
        if steps > 8.0:  # from 0 and from the jump of the density
            assert error < (1e-4 if x in singular else 3e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "spread", "step"),
    [(5.0, "none", 1 / 64), (0.5, "none", 1 / 64), (1.0, "20 %", 1 / 24), (0.5, "150 %", 1 / 8)],
)
def test_lenses_lie_between_areas_rounded_up_and_down(count: float, spread: str, step: float) -> None:
    model = contact(count, spread)
    places = step * PEAK * np.arange(int((200.0 if spread == "150 %" else 8.0) / step))
    below, above = brackets(alive(model.sizes, 400), model.mean_live_junctions, step * PEAK, places.size)
    found = distribution(model).cdf(places)
    assert np.all(below < found + 1e-4)
    assert np.all(found < above + 1e-4)
    assert np.max(above - below) < 0.05
    assert np.min(above - below - 0.02 * np.max(above - below)) < 0.0  # at some places the bounds all but meet


@pytest.mark.parametrize(
    ("count", "spread", "sizes"), [(20.0, "none", 1), (60.0, "20 %", 64), (60.0, "150 %", 100), (500.0, "none", 1)]
)
def test_many_lenses_by_davies_sum(count: float, spread: str, sizes: int) -> None:
    model = contact(count, spread)
    mean = area_cumulants(model).mean
    area = mean * np.linspace(0.3, 2.5, 23)
    expected = davies(alive(model.sizes, sizes), model.mean_live_junctions, area, 6.0 * mean + 400.0, 600)
    np.testing.assert_allclose(distribution(model).cdf(area), expected, atol=1e-7)


def alive(law: Law, count: int) -> tuple[Doubles, Doubles]:
    """Return diameters found alive and their shares, by one Gauss-Legendre rule over the support."""
    if isinstance(law, Fixed):
        return np.array([law.value]), np.ones(1)
    low, high = law.support
    x, w = np.polynomial.legendre.leggauss(count)
    diameters = low + 0.5 * (high - low) * (1.0 + x)
    shares = w * diameters * law.density(diameters)
    return diameters, shares / shares.sum()


@pytest.mark.parametrize("count", [1e4, 1e6])
def test_a_million_junctions_are_all_but_normal(count: float) -> None:
    """Edgeworth's series to second order; what it leaves out is of the order count^-1.5."""
    model = contact(count, "0.2 um")
    exact = area_cumulants(model)
    z = np.linspace(-4.0, 4.0, 33)
    skewness, kurtosis = exact.skewness, exact.excess_kurtosis
    first = skewness / 6.0 * (z**2 - 1.0)
    second = kurtosis / 24.0 * (z**3 - 3.0 * z) + skewness**2 / 72.0 * (z**5 - 10.0 * z**3 + 15.0 * z)
    expected = ndtr(z) - np.exp(-0.5 * z**2) / sqrt(2.0 * pi) * (first + second)
    found = distribution(model).cdf(exact.mean + z * exact.std)
    assert np.max(np.abs(found - expected)) < max(count**-1.5, 2e-8)
    assert np.max(np.abs(found - ndtr(z))) > 0.01 / sqrt(count)


# Singular places, and everywhere else that may be asked for.


@pytest.mark.parametrize(("count", "spread"), [(0.5, "none"), (20.0, "0.2 um"), (5000.0, "20 %")])
def test_quantiles_are_where_the_distribution_function_gets_there(count: float, spread: str) -> None:
    law = distribution(contact(count, spread))
    p = np.array([[0.61, 0.7, 0.9], [0.99, 0.999999, 1.0 - 1e-9]])
    np.testing.assert_allclose(law.cdf(law.quantile(p)), p, atol=1e-11)
    assert law.quantile([0.0, 1.0]).tolist() == [0.0, inf]
    assert float(law.quantile(0.6)) == 0.0 if count == 0.5 else float(law.quantile(0.6)) > 0.0


# What is refused.
