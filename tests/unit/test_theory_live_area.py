from math import pi, sqrt

import mpmath
import numpy as np
import pytest

from rubnoise.contact.laws import Exponential, Fixed, Law, Lognormal, Normal, Spread, law_for
from rubnoise.contact.overlap import junction_area
from rubnoise.contact.pulses import LENS, PARABOLA, PULSES, TRIANGLE, Pulse
from rubnoise.theory.distribution import pair_area
from rubnoise.theory.live_area import live_area
from tests.oracle.slow_distribution import level

ONE_SIZE = Fixed(value=2.0)
LAWS: dict[str, Law] = {
    "one size": ONE_SIZE,
    "hardly spread": Normal(centre=5.53, std=1e-6),
    "0.2 um": Normal(centre=5.53, std=0.2),
    "20 %": Normal(centre=5.53, std=1.106),
    "150 %": Normal(centre=2.0, std=3.0),
    "lognormal": Lognormal(mean=2.0, std=0.6),
    "exponential": Exponential(mean=2.0),
}


@pytest.mark.parametrize("pulse", PULSES.values(), ids=PULSES)
@pytest.mark.parametrize("name", LAWS)
def test_moments_are_the_life_integrals_of_what_is_alive(name: str, pulse: Pulse) -> None:
    law = LAWS[name]
    area, probability = live_area(law, pulse).rule()
    for n in range(1, 7):
        expected = 0.5 * pulse.life_integral(n) * law.moment(2 * n + 1) / law.moment(1)
        assert np.sum(probability * area**n) == pytest.approx(expected, rel=5e-11 if pulse is PARABOLA else 1e-13)


def test_age_and_area_of_one_lens() -> None:
    """At half-life u the area is that of overlapping circles, and u is as likely at every place."""
    u = np.array([1e-9, 1e-4, 0.1, 0.5, 0.9, 0.999])
    area = junction_area(2.0 * u, 2.0)
    live = live_area(ONE_SIZE, LENS)
    np.testing.assert_allclose(live.cdf(area)[1:], u[1:], rtol=1e-10)  # the area itself has lost digits below
    np.testing.assert_allclose(live.density(area)[2:], 0.25 / np.sqrt(u * (2.0 - u))[2:], rtol=1e-11)
    assert live.cdf([-1.0, 0.0, pi, 4.0]) == pytest.approx([0.0, 0.0, 1.0, 1.0])
    assert live.density([-1.0, 0.0, pi, 3.2]) == pytest.approx([0.0, 0.0, 0.25, 0.0], rel=1e-11)


def test_one_triangle_has_every_area_alike() -> None:
    live = live_area(ONE_SIZE, TRIANGLE)
    area = np.array([1e-12, 1e-3, 1.0, 3.1])
    np.testing.assert_allclose(live.cdf(area), area / pi, rtol=1e-13)
    np.testing.assert_allclose(live.density(area), 1.0 / pi, rtol=1e-13)


@pytest.mark.parametrize("name", ["0.2 um", "20 %", "150 %", "exponential"])
def test_level_of_spread_sizes(name: str) -> None:
    law = LAWS[name]
    low, high = law.support
    diameters = low + (high - low) * (np.arange(40_000) + 0.5) / 40_000
    shares = diameters * law.density(diameters)
    area = law.moment(1) ** 2 * np.array([1e-3, 0.1, 0.5, 0.75, 0.8, 1.1])
    expected = level((diameters, shares / shares.sum()), area)
    np.testing.assert_allclose(live_area(law, LENS).cdf(area), expected, rtol=0.0, atol=1e-7)


def test_rule_integrates_waves() -> None:
    live = live_area(ONE_SIZE, LENS)
    for wavenumber in (3.0, 300.0):
        area, probability = live.rule(wavenumber)
        with mpmath.workdps(20):
            cuts = np.linspace(0.0, pi / 2.0, 8 + int(wavenumber / 5.0)).tolist()
            expected = mpmath.quad(
                lambda y, th=wavenumber: mpmath.exp(2j * th * (y - mpmath.sin(y) * mpmath.cos(y))) * mpmath.sin(y), cuts
            )
        assert np.sum(probability * np.exp(1j * wavenumber * area)) == pytest.approx(complex(expected), abs=1e-14)


def test_rule_may_stop_early() -> None:
    live = live_area(LAWS["150 %"], LENS)
    area, probability = live.rule(0.1, reach=5.0)
    assert 5.0 <= area.max() < 40.0
    assert probability.sum() == pytest.approx(float(live.cdf(area.max())), abs=0.05)


def pair_by_hand(x: float) -> tuple[float, float]:
    """Return P(a + b <= x) and its derivative for two lenses of diameter 2, at 20 digits over the half-life of one."""

    def area(u: mpmath.mpf) -> mpmath.mpf:
        y = mpmath.acos(1 - u)
        return 2 * (y - mpmath.sin(y) * mpmath.cos(y))

    def age(a: mpmath.mpf) -> mpmath.mpf:
        if a <= 0 or a >= mpmath.pi:
            return mpmath.mpf(a > 0)
        return mpmath.findroot(lambda u: area(u) - a, (0, 1), solver="anderson", tol=1e-25)

    with mpmath.workdps(20):
        cuts = sorted({mpmath.mpf(0), age(mpmath.mpf(x) - mpmath.pi), age(mpmath.mpf(x) / 2), age(mpmath.mpf(x))})
        cdf = mpmath.quad(lambda u: age(x - area(u)), cuts)
        inner = [cut for cut in cuts if age(mpmath.mpf(x) - mpmath.pi) <= cut]
        density = mpmath.quad(lambda u: 1 / (4 * mpmath.sqrt((v := age(x - area(u))) * (2 - v))), inner)
    return float(cdf), float(density)


@pytest.mark.parametrize("x", [0.01, 1.0, 3.0, 3.3, 5.0, 6.2])
def test_two_lenses_of_one_size(x: float) -> None:
    cdf, density = pair_area(live_area(ONE_SIZE, LENS))
    expected = pair_by_hand(x)
    t = np.cbrt(np.array([x]))
    assert float(cdf(t)[0]) == pytest.approx(expected[0], rel=1e-9)
    assert float(density(t)[0]) == pytest.approx(expected[1], rel=1e-6)


def test_one_parabola_is_likeliest_at_its_peak() -> None:
    live = live_area(ONE_SIZE, PARABOLA)
    area = np.array([1e-3, 1.0, 3.1, pi - 1e-6])
    np.testing.assert_allclose(live.cdf(area), 1.0 - np.sqrt(1.0 - area / pi), rtol=1e-11)
    np.testing.assert_allclose(live.density(area), 0.5 / (pi * np.sqrt(1.0 - area / pi)), rtol=1e-8)


def test_parabolas_of_rayleigh_sizes_have_exponential_areas() -> None:
    """d^2 - x^2 of a point that is normal in three dimensions, seen from the line of motion: (y^2 + z^2) is left."""
    law = law_for(5.0, Spread(relative=sqrt(4.0 / pi - 1.0), law="weibull"))
    live = live_area(law, PARABOLA)
    area = 25.0 * np.array([1e-4, 0.1, 1.0, 3.0, 8.0])
    np.testing.assert_allclose(live.cdf(area), -np.expm1(-area / 25.0), rtol=1e-12)
    np.testing.assert_allclose(25.0 * live.density(area), np.exp(-area / 25.0), rtol=1e-11)


def test_two_parabolas_of_one_size_have_a_level_half() -> None:
    """The density is arcsin(x/(2p - x))/(2p) below the peak area p and pi/(4p) from there to 2p."""
    _, density = pair_area(live_area(ONE_SIZE, PARABOLA))
    area = pi * np.array([0.01, 0.5, 0.9, 1.1, 1.9])
    expected = np.where(area < pi, np.arcsin(np.minimum(area / (2.0 * pi - area), 1.0)) / (2.0 * pi), 0.25)
    np.testing.assert_allclose(density(np.cbrt(area)), expected, rtol=1e-9)


def test_two_triangles_of_one_size_have_a_roof() -> None:
    cdf, density = pair_area(live_area(ONE_SIZE, TRIANGLE))
    x = np.array([0.0, 0.3, 1.0, 1.7, 2.0])
    np.testing.assert_allclose(density(np.cbrt(pi * x)), (1.0 - np.abs(x - 1.0)) / pi, atol=1e-12)
    roof = np.where(x < 1.0, 0.5 * x**2, 1.0 - 0.5 * (2.0 - x) ** 2)
    np.testing.assert_allclose(cdf(np.cbrt(pi * x)), roof, atol=1e-12)


@pytest.mark.parametrize("pulse", PULSES.values(), ids=PULSES)
@pytest.mark.parametrize("name", ["one size", "0.2 um", "20 %", "150 %", "lognormal"])
def test_two_of_any_law_add_their_cumulants(name: str, pulse: Pulse) -> None:
    live = live_area(LAWS[name], pulse)
    area, probability = live.rule()
    one = [np.sum(probability * area**n) for n in (1, 2)]
    cdf, density = pair_area(live)
    x, w = np.polynomial.legendre.leggauss(24)
    half = 0.5 * np.diff(cdf.edges)[:, None]
    t = 0.5 * (cdf.edges[1:] + cdf.edges[:-1])[:, None] + half * x
    weights = 3.0 * t**2 * half * w
    near = 1e-9 if live.rise.infinite else 1e-11
    assert np.sum(weights * density(t)) == pytest.approx(1.0, rel=near)
    assert np.sum(weights * (1.0 - cdf(t))) == pytest.approx(2.0 * one[0], rel=near)
    assert np.sum(weights * t**6 * density(t)) == pytest.approx(2.0 * (one[1] + one[0] ** 2), rel=near)
