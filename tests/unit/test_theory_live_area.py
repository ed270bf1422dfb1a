"""Live junctions, one-sided figures, and exponents."""

from dataclasses import replace
from itertools import cycle
from math import log, pi, sqrt
from typing import Any

import mpmath
import numpy as np
import pytest

import rubnoise
from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import LAWS, Exponential, Fixed, Law, Lognormal, Normal, Spread, law_for
from rubnoise.contact.overlap import junction_area
from rubnoise.contact.pulses import LENS, PARABOLA, PULSES, TRIANGLE, Pulse
from rubnoise.contact.pulses import PULSES as SIDES
from rubnoise.errors import Refused
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.distribution import pair_area
from rubnoise.theory.live_area import live_area
from rubnoise.theory.sizes import panels
from rubnoise.theory.second_order import density_at_zero, half_power_wavenumber, spectral_density, tail
from rubnoise.theory.spectrum import one_sided_density, one_sided_density_per_cycle
from tests.oracle.slow_contact import level
from tests.unit.theory_models import model_of, one_size, paper_model

ONE_SIZE = Fixed(value=2.0)
LIVE_LAWS: dict[str, Law] = {
    "one size": ONE_SIZE,
    "hardly spread": Normal(centre=5.53, std=1e-6),
    "0.2 um": Normal(centre=5.53, std=0.2),
    "20 %": Normal(centre=5.53, std=1.106),
    "150 %": Normal(centre=2.0, std=3.0),
    "lognormal": Lognormal(mean=2.0, std=0.6),
    "exponential": Exponential(mean=2.0),
}


@pytest.mark.parametrize("pulse", PULSES.values(), ids=PULSES)
@pytest.mark.parametrize("name", LIVE_LAWS)
def test_moments_are_the_life_integrals_of_what_is_alive(name: str, pulse: Pulse) -> None:
    law = LIVE_LAWS[name]
    area, probability = live_area(law, pulse).rule()
    for n in range(1, 7):
        expected = 0.5 * pulse.life_integral(n) * law.moment(2 * n + 1) / law.moment(1)
        assert np.sum(probability * area**n) == pytest.approx(expected, rel=2e-10 if pulse is PARABOLA else 1e-13)


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
    law = LIVE_LAWS[name]
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
    live = live_area(LIVE_LAWS["150 %"], LENS)
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
    live = live_area(LIVE_LAWS[name], pulse)
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


SIDES = pytest.mark.parametrize("pulse", list(SIDES.values()), ids=SIDES)


@SIDES
def test_both_densities_integrate_to_the_variance(pulse: Pulse) -> None:
    """Panels follow the swing up to k = 200; the tail beyond holds 1e-7 of the variance."""
    model = replace(paper_model(), pulse=pulse)
    k, weights = panels(np.linspace(0.0, 200.0, 801), 16)
    variance = area_cumulants(model).variance
    beyond = float(tail(model, 200.0)) * 200.0 / 3.0 / np.pi
    assert weights @ one_sided_density(model, k) + beyond == pytest.approx(variance, rel=1e-8)
    cycles = k / (2.0 * np.pi)
    assert weights / (2.0 * np.pi) @ one_sided_density_per_cycle(model, cycles) + beyond == pytest.approx(
        variance, rel=1e-8
    )


@SIDES
@pytest.mark.parametrize("std", [0.2, 2.0, 6.0])
def test_spread_leaves_the_tail_alone(pulse: Pulse, std: float) -> None:
    """What is left over is of the order 1/(k d)."""
    model = replace(model_of(Normal(centre=5.53, std=std), 5.53), pulse=pulse)
    k = np.array([1e3, 1e4])
    np.testing.assert_allclose(spectral_density(model, k), tail(model, k), rtol=4e-4)


@pytest.mark.parametrize(
    ("pulse", "swing"), [(LENS, 2.5 / np.sqrt(5530.0)), (TRIANGLE, 5.0 / 3.0)], ids=["lens", "triangle"]
)
def test_one_size_swings_about_the_tail(pulse: Pulse, swing: float) -> None:
    model = replace(one_size(5.53), pulse=pulse)
    k = 1000.0 + 20.0 * np.pi / 5.53 * np.arange(20_000) / 20_000
    ratio = spectral_density(model, k) / tail(model, k)
    assert ratio.mean() == pytest.approx(1.0, abs=1e-3)
    assert np.max(ratio) - 1.0 == pytest.approx(swing, rel=0.02)


def test_corner_of_one_size() -> None:
    corner = half_power_wavenumber(one_size(5.53))
    assert 2.0 * 5.53 * corner == pytest.approx(4.50, abs=0.01)
    assert spectral_density(one_size(5.53), corner) == pytest.approx(0.5 * density_at_zero(one_size(5.53)), rel=1e-12)


def test_corner_of_triangles_is_that_of_a_squared_sinc() -> None:
    """(sin y / y)^4 = 1/2 at y = k d / 2."""
    corner = half_power_wavenumber(replace(one_size(5.53), pulse=TRIANGLE))
    y = 0.5 * corner * 5.53
    assert (np.sin(y) / y) ** 4 == pytest.approx(0.5, rel=1e-12)


def test_large_junctions_in_a_wide_law_lower_the_corner() -> None:
    wide = model_of(Normal(centre=5.53, std=4.0), 5.53)
    assert half_power_wavenumber(wide) < 0.6 * half_power_wavenumber(one_size(5.53))


def test_regular_births_have_neither() -> None:
    model = replace(one_size(), births=RegularBirths(mean_spacing=0.5))
    with pytest.raises(Refused, match="tail of the spectrum is known for Poisson births alone"):
        tail(model, 1.0)
    with pytest.raises(Refused, match="corner of the spectrum is known for Poisson births alone"):
        half_power_wavenumber(model)


# Exponents of junction diameter and of speed add up to 1: docs/field.md proves it, and exact theory obeys it.
MORE: dict[str, dict[str, Any]] = {
    "power": {"exponent": 3.0, "smallest": 0.25, "largest": 4.0},
    "mixture": {"weights": [0.7, 0.3], "parts": [{"law": "fixed", "mean": 4}, {"law": "fixed", "mean": 9}]},
    "empirical": {"values": [3.0, 4.5, 7.0]},
}
OF_LAWS: dict[str, dict[str, Any]] = {
    name: {
        "law": name,
        **({"spread": "30 %"} if entry.takes_spread else {}),
        **MORE.get(name, {}),
    }
    for name, entry in LAWS.items()
}
DAMPING_RATIOS = (1e-4, 0.02, 1.0, 30.0)
PAIRS = [(shape, name) for shape in PULSES for name in OF_LAWS]
CASES = [(*pair, ratio) for pair, ratio in zip(PAIRS, cycle(DAMPING_RATIOS), strict=False)]
STRENGTH = {"law": "constant", "mean": "250 MPa"}


def amplitudes(
    times: float, speed: float, *, count: float = 20.0, damping_ratio: float = 0.02, **tables: Any
) -> tuple[float, float]:
    """Return spreads of displacement and velocity on the area of Figure 5, with diameters ``times`` as large."""
    values: dict[str, Any] = {
        "format": 1,
        "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": count / times**2, "calibration": "exact"},
        "strength": STRENGTH,
        "sliding": {"speed": speed, "distance": 1e5},
        "slider": {"mass": 0.005, "stiffness": 300.0, "damping_ratio": damping_ratio},
        "output": {"tick": 1.0},
    }
    motion = rubnoise.exact(rubnoise.build(values | tables)).slider
    assert motion is not None
    return motion.displacement_std, motion.velocity_std


def sums(factor: float = 2.0, speed: float = 1000.0, **case: Any) -> list[float]:
    """Return the sum of both exponents for displacement and velocity, from two points that share V/d."""
    near, far = amplitudes(1.0, speed, **case), amplitudes(factor, factor * speed, **case)
    return [log(large / small) / log(factor) for small, large in zip(near, far, strict=True)]


@pytest.mark.parametrize(("shape", "law", "damping_ratio"), CASES)
def test_exponents_add_up_to_1_for_every_law_of_sizes_pulse_and_damping(
    shape: str, law: str, damping_ratio: float
) -> None:
    found = sums(pulse={"shape": shape}, diameter=OF_LAWS[law], damping_ratio=damping_ratio)
    assert found == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("law", ["fixed", "lognormal"])
def test_they_do_off_the_centre_line(law: str) -> None:
    found = sums(pulse={"offset": "uniform"}, diameter=OF_LAWS[law])
    assert found == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("law", [name for name, entry in LAWS.items() if name != "fixed" and not entry.own_keys])
def test_they_do_for_every_law_of_strengths(law: str) -> None:
    strength = {**OF_LAWS[law], "mean": "250 MPa"}
    assert sums(factor=1.3, strength=strength) == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("speed", [20.0, 450.0, 1e5])
def test_they_do_at_every_speed_by_exponents_of_one_variable(speed: float) -> None:
    step = 1.001
    slower, faster = amplitudes(1.0, speed / step), amplitudes(1.0, speed * step)
    smaller, larger = amplitudes(1.0 / step, speed), amplitudes(step, speed)
    for quantity in range(2):
        of_speed = log(faster[quantity] / slower[quantity]) / log(step) / 2.0
        of_size = log(larger[quantity] / smaller[quantity]) / log(step) / 2.0
        assert of_speed + of_size == pytest.approx(1.0, abs=1e-6)
        assert abs(of_size - 1.0) > 1e-3


def test_no_other_scaling_has_the_identity() -> None:
    absolute = {"law": "normal", "spread": "1 um"}
    assert abs(sums(diameter=absolute)[0] - 1.0) > 1e-3
    # The spacing of regular births is no fixed part of the diameter, so their spectral lines move.
    assert abs(sums(birth={"law": "regular"}, count=4.0)[0] - 1.0) > 0.1
    near, far = amplitudes(1.0, 1e4), amplitudes(2.0, 1e4)
    assert log(far[0] / near[0]) / log(2.0) == pytest.approx(1.5, abs=0.01)


def exponent_of_speed(speed: float, quantity: int) -> float:
    slower, faster = (amplitudes(1.0, speed * factor, **FIGURE_5)[quantity] for factor in (0.995, 1.005))
    return log(faster / slower) / log(1.005 / 0.995)


FIGURE_5 = {
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20.0, "calibration": "paper"},
    "diameter": {"law": "normal", "spread": "0.2 um"},
}


@pytest.mark.parametrize(
    ("quantity", "windows"), [(0, [(200.0, 210.0), (400.0, 470.0)]), (1, [(410.0, 490.0)])], ids=["std x", "std x'"]
)
def test_figure_5_rises_with_speed_as_published_only_where_the_page_says(
    quantity: int, windows: list[tuple[float, float]]
) -> None:
    for low, high in windows:
        assert 0.6 <= exponent_of_speed(0.5 * (low + high), quantity) <= 1.1
        assert not 0.6 <= exponent_of_speed(low - 10.0, quantity) <= 1.1
        assert not 0.6 <= exponent_of_speed(high + 10.0, quantity) <= 1.1
    for speed in (250.0, 300.0, 350.0, 520.0, 600.0, 700.0, 1e3, 1e4, 7e5):
        assert not 0.6 <= exponent_of_speed(speed, quantity) <= 1.1
