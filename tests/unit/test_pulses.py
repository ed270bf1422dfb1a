"""Pulses and sizes: the registry of shapes, overlaps, calibrations, grids, and the constants of the slider."""

import json
from math import pi, sqrt
from pathlib import Path

import mpmath
import numpy as np
import pytest

from rubnoise.contact.calibration import NoMatchingDiameter, calibrated_diameter
from rubnoise.contact.laws import LAWS, Spread, law_for
from rubnoise.contact.overlap import junction_area, life_integral, max_area
from rubnoise.contact.pulses import LENS, PARABOLA, PULSES
from rubnoise.model import Slider
from rubnoise.simulation.linear import propagator, under_force
from rubnoise.storage.life_curve import JUNCTION_AREA_FORMULAS
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.second_order import spectral_density
from rubnoise.theory.unit_pulse import amplitude, energy, overlaps
from tests.frozen import frozen
from tests.models import model
from tests.oracle.second import sums

# Every pulse of the registry has its entry in each table that goes by shape, and what it says of itself agrees.
every_pulse = pytest.mark.parametrize("pulse", PULSES.values(), ids=PULSES)
AGES = np.linspace(0.0, 1.0, 101)


@every_pulse
def test_every_pulse_is_known_to_each_table(pulse):
    assert JUNCTION_AREA_FORMULAS[pulse.shape].startswith(f"A(s) = {pulse.formula} with")
    assert energy(pulse, np.zeros(1)) == pytest.approx(pulse.life_integral(1) ** 2, rel=1e-9)
    area, force = np.zeros(1), np.zeros(1)
    lives = np.array([0]), np.array([1])
    sums.add_areas(pulse, np.array([3.0]), lives, (np.array([0.0]), np.array([4.0]), np.array([2.0])), area, force)
    assert area == pytest.approx(pulse.area(3.0, 4.0), rel=1e-14)
    life = np.array([0.5]), np.array([4.0]), np.array([8.5]), np.array([2.0])
    moments = sums.force_moments(pulse, np.array([0.0, 10.0]), 10.0, life)
    assert moments[0, 0] == pytest.approx(2.0 * pulse.life_integral(1) * 4.0**3, rel=1e-13)


@every_pulse
def test_the_exact_rise_is_the_area(pulse):
    with mpmath.workdps(30):
        exact = [float(pulse.rising_area(mpmath.mpf(u))) for u in AGES.tolist()]
    assert pulse.area(AGES, 1.0) == pytest.approx(exact, abs=3e-16)


@every_pulse
def test_the_area_so_far_is_the_integral_of_the_rise(pulse):
    with mpmath.workdps(20):
        exact = [float(mpmath.quad(pulse.rising_area, [0, u])) for u in AGES[::20].tolist()]
    assert pulse.area_so_far(AGES[::20]) == pytest.approx(exact, abs=1e-15)
    assert 2.0 * pulse.area_so_far(np.ones(1))[0] == pytest.approx(pulse.life_integral(1), rel=1e-14)


@every_pulse
def test_the_tail_is_that_of_the_kinks(pulse):
    """From the slopes on either side of birth, mid-life and death."""
    step = 1e-9
    jumps = [
        (pulse.area(at + step, 1.0) - 2.0 * pulse.area(at, 1.0) + pulse.area(at - step, 1.0)) / step
        for at in (0.0, 1.0, 2.0)
    ]
    assert (sum(jump**2 for jump in jumps), 4) == (pytest.approx(pulse.tail[0], rel=1e-3), pulse.tail[1])


@every_pulse
def test_the_slope_is_that_of_the_area(pulse):
    ages = np.array([-0.5, 0.2, 0.9, 1.1, 1.8, 2.5])
    step = 1e-6
    rise = (pulse.area(3.0 * ages + step, 3.0) - pulse.area(3.0 * ages - step, 3.0)) / (2.0 * step)
    assert pulse.slope(3.0 * ages, 3.0) == pytest.approx(rise, abs=1e-8)
    assert pulse.slope(0.5, 3.0) > 0.5


@every_pulse
def test_squared_slope_is_the_integral_of_the_slope_squared(pulse):
    places, weights = np.polynomial.legendre.leggauss(8)
    rising = 0.5 * weights @ np.square(pulse.slope(0.5 + 0.5 * places, 1.0))
    assert 2.0 * rising == pytest.approx(pulse.squared_slope, rel=1e-14)


# The parabola's exact figures beside those of a second program (tests/reference/family.json), and two errors of it.
REFERENCE = json.loads((Path(__file__).parents[1] / "reference" / "family.json").read_text(encoding="utf-8"))[
    "parabola"
]
RAYLEIGH = Spread(relative=sqrt(4.0 / pi - 1.0), law="weibull")


def test_its_integrals_are_those_of_the_reference() -> None:
    assert [PARABOLA.life_integral(n) for n in range(1, 7)] == pytest.approx(list(REFERENCE["c_n"].values()), rel=1e-15)
    assert float(PARABOLA.life_mean()) == pytest.approx(REFERENCE["life_mean_over_d2"], rel=1e-15)


@pytest.mark.parametrize(("spread", "key"), [(Spread(), "cv_sqrtN_fixed"), (RAYLEIGH, "cv_sqrtN_rayleigh")], ids=str)
def test_variations_are_those_of_the_reference(spread: Spread, key: str) -> None:
    found = area_cumulants(model(spread=spread, calibration="matched", pulse=PARABOLA))
    assert found.mean == pytest.approx(200.0, rel=1e-13)
    assert sqrt(20.0) * found.std / found.mean == pytest.approx(REFERENCE[key], rel=1e-12)
    lens = area_cumulants(model(spread=spread, calibration="matched", pulse=LENS))
    assert sqrt(20.0) * lens.std / lens.mean != pytest.approx(REFERENCE[key], rel=0.01)


def test_rayleigh_sizes_need_the_matched_calibration() -> None:
    assert calibrated_diameter("matched", 200.0, 20.0, RAYLEIGH, PARABOLA) == pytest.approx(sqrt(10.0), rel=1e-15)
    too_large = area_cumulants(model(spread=RAYLEIGH, calibration="exact", pulse=PARABOLA)).mean
    assert too_large == pytest.approx(200.0 * 6.0 / pi, rel=1e-12)


def test_two_places_of_a_life_are_correlated_as_the_reference_has_it() -> None:
    """At a lag of 0.7 d: (pi/4)^2 (2 - t)^3 (t^2 + 6t + 4)/30."""
    found = overlaps(PARABOLA, 1, 1)(np.array([0.7]))[0] / (0.25 * pi) ** 2
    assert REFERENCE["acf_check"] == pytest.approx([float(found)] * 2, rel=1e-7)


def test_its_transform_is_the_integral_of_its_life() -> None:
    z = np.array([0.0, 1e-3, 0.5, 0.999, 1.0, 1.001, 4.0, 20.0, 60.0])
    x, w = np.polynomial.legendre.leggauss(80)
    expected = (0.25 * pi * (1.0 - x * x) * np.cos(np.multiply.outer(z, x))) @ w
    assert amplitude(PARABOLA, z) == pytest.approx(expected, abs=1e-10)


def test_its_spectrum_falls_off_about_the_tail() -> None:
    """Over a whole swing the mean is pi^2/2 lam d^2/k^4; the lens has 4 and would be seen."""
    contact = model(spread=Spread(), pulse=PARABOLA)
    d = contact.calibrated_diameter
    k = (3000.0 + np.linspace(0.0, pi, 400, endpoint=False)) / d
    level = float(np.mean(spectral_density(contact, k) * k**4)) / (contact.birth_rate * d * d)
    assert level == pytest.approx(0.5 * pi**2, rel=2e-3)
    assert abs(level - 4.0) > 0.5


# The overlap of two circles, held to geometry and to integrals known without it.
CONSTANTS = json.loads((Path(__file__).parents[1] / "reference" / "pulse.json").read_text(encoding="utf-8"))["c"]


def segments(s: float, d: float) -> float:
    """Return the lens as two segments of a circle of diameter d and height s/2, with 40 digits (paper Eq. 2)."""
    with mpmath.workdps(40):
        height, radius = mpmath.mpf(s) / 2, mpmath.mpf(d) / 2
        chord = mpmath.sqrt(height * (2 * radius - height))
        return float(2 * (radius**2 * mpmath.acos(1 - height / radius) - (radius - height) * chord))


@pytest.mark.parametrize("share", [0.01, 0.3, 0.5, 0.999, 1.0, 1.0001, 1.5, 1.99])
@pytest.mark.parametrize("d", [1e-3, 5.53, 4e4])
def test_area_is_that_of_two_segments(share: float, d: float) -> None:
    s = share * d
    expected = segments(min(s, 2.0 * d - s), d)
    assert float(junction_area(s, d)) == pytest.approx(expected, abs=1e-15 * d * d, rel=1e-12)


def test_a_junction_has_no_area_outside_its_life() -> None:
    s = np.array([-1e9, -1.0, 0.0, 6.0, 7.0, 1e9])
    assert not junction_area(s, 3.0).any()


def test_the_area_is_largest_at_mid_life_and_alike_on_both_sides() -> None:
    s = np.linspace(0.0, 6.0, 61)
    area = junction_area(s, 3.0)
    assert area.argmax() == 30
    assert area[30] == pytest.approx(float(max_area(np.array(3.0))), rel=1e-15)
    assert np.allclose(area, area[::-1], rtol=1e-12, atol=1e-14)
    assert np.all(np.diff(area[:31]) > 0.0)


def test_the_slope_has_a_kink_of_two_diameters_at_mid_life() -> None:
    step = 1e-6
    low, middle, high = junction_area(3.0 + np.array([-step, 0.0, step]), 3.0)
    assert (high - 2.0 * middle + low) / step == pytest.approx(-6.0, rel=1e-5)


def test_the_first_touch_grows_as_the_three_halves_power() -> None:
    s = np.array([1e-6, 1e-4])
    assert junction_area(s, 2.0) == pytest.approx(2.0 * np.sqrt(2.0) / 3.0 * np.sqrt(2.0) * s**1.5, rel=1e-4)


def test_arguments_broadcast() -> None:
    table = junction_area(np.array([[1.0], [2.0]]), np.array([2.0, 3.0, 4.0]))
    assert table.shape == (2, 3)
    assert table[1, 2] == junction_area(2.0, 4.0)


@pytest.mark.parametrize("power", [1, 2, 3, 4, 5, 6])
def test_life_integrals_are_the_known_ones(power: int) -> None:
    assert life_integral(power) == pytest.approx(float(CONSTANTS[str(power)]), rel=1e-15)


def test_the_mean_area_of_a_life_is_a_third_of_the_square() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(60)
    angle = np.pi / 4.0 * (1.0 + nodes)  # s = d (1 - cos angle) makes the area smooth
    area = junction_area(3.0 * (1.0 - np.cos(angle)), 3.0)
    mean = float(weights @ (area * np.sin(angle))) * np.pi / 4.0
    assert mean == pytest.approx(3.0, rel=1e-13)
    assert mean != pytest.approx(0.327 * 9.0, rel=1e-2)


# The three calibrations, and where one of them has no answer.
FIG5 = Spread(absolute=0.2)
SPREADING = [name for name, entry in LAWS.items() if entry.takes_spread]


@pytest.mark.parametrize(
    ("calibration", "diameter"), [("paper", 5.53001263609331), ("exact", 5.47722557505166), ("matched", 5.46626015)]
)
def test_diameters_of_fig_5(calibration, diameter):
    assert calibrated_diameter(calibration, 200.0, 20.0, FIG5) == pytest.approx(diameter, rel=2e-9)


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
@pytest.mark.parametrize(
    "spread",
    [
        Spread(),
        Spread(law="exponential"),
        *(Spread(absolute=std, law=law) for law in SPREADING for std in (0.2, 1.2)),
        *(Spread(relative=ratio, law=law) for law in SPREADING for ratio in (0.0, 0.3, 2.0)),
        Spread(absolute=1.9),
    ],
    ids=str,
)
def test_matched_meets_the_mean_area(spread, pulse):
    diameter = calibrated_diameter("matched", 200.0, 20.0, spread, pulse)
    life_mean = 20.0 * float(pulse.life_mean())
    assert life_mean * law_for(diameter, spread).moment(3) / diameter == pytest.approx(200.0, rel=1e-13)


@pytest.mark.parametrize(
    ("spread", "third"),
    [
        (Spread(law="exponential"), 6.0),
        (Spread(law="gamma", relative=1.0), 6.0),
        (Spread(law="gamma", relative=0.5), 1.25 * 1.5),
        (Spread(law="lognormal", relative=0.5), 1.25**3),
    ],
    ids=str,
)
def test_a_relative_spread_has_a_closed_form(spread, third):
    """E[d^3] / d_m^3 is a number: (1 + v)(1 + 2v) for gamma, (1 + v)^3 for lognormal, v = cv^2."""
    assert calibrated_diameter("matched", 200.0, 20.0, spread) == pytest.approx((30.0 / third) ** 0.5, rel=1e-15)


@pytest.mark.parametrize(
    ("law", "turning", "least"), [("lognormal", 2.0**0.5, 27.0 / 4.0), ("gamma", 2.0**0.25, 3.0 + 2.0 * 2.0**0.5)]
)
def test_the_least_mean_area_of_each_law(law, turning, least):
    """(m^2 + s^2)^3 / m^4 is least at m = sqrt(2) s, (m^2 + s^2)(m^2 + 2 s^2) / m^2 at 2^(1/4) s."""
    spread, area = Spread(absolute=0.2, law=law), least / 3.0 * 20.0 * 0.2**2
    assert calibrated_diameter("matched", area * 1.000001, 20.0, spread) == pytest.approx(turning * 0.2, rel=3e-3)
    with pytest.raises(NoMatchingDiameter) as refusal:
        calibrated_diameter("matched", area * 0.999999, 20.0, spread)
    assert refusal.value.factor == pytest.approx(least / 3.0, rel=1e-14)


@pytest.mark.parametrize("spread", [Spread(law="exponential"), Spread(law="gamma", relative=0.5), FIG5], ids=str)
def test_exact_and_paper_take_no_notice_of_the_sizes(spread):
    assert calibrated_diameter("exact", 200.0, 20.0, spread) == pytest.approx(30.0**0.5, rel=1e-15)
    assert calibrated_diameter("paper", 200.0, 20.0, spread) == pytest.approx((10.0 / 0.327) ** 0.5, rel=1e-15)


def test_matched_takes_the_larger_root():
    diameter = calibrated_diameter("matched", 100.0, 20.0, Spread(absolute=1.5))
    assert diameter > 0.887855 * 1.5


def test_no_match_below_the_least_mean_area():
    least = 1.609247 * 20.0 * 0.2**2
    assert calibrated_diameter("matched", least * 1.0001, 20.0, FIG5) == pytest.approx(0.887855 * 0.2, rel=0.03)
    with pytest.raises(NoMatchingDiameter, match=r"1\.609247 N_jm spread\^2 = 1\.2874") as refusal:
        calibrated_diameter("matched", least * 0.9999, 20.0, FIG5)
    assert refusal.value.minimum == pytest.approx(least, rel=1e-6)


# The slider's constants against a matrix exponential and quadrature, for every kind of damping.
CRITICAL = 2.0 * np.sqrt(300.0 * 0.005)
SLIDERS = {
    "undamped": Slider(mass=0.005, stiffness=300.0, damping=0.0),
    "light": Slider(mass=0.005, stiffness=300.0, damping=0.05),
    "critical": Slider(mass=1.0, stiffness=4.0, damping=4.0),
    "nearly critical": Slider(mass=0.005, stiffness=300.0, damping=CRITICAL * (1 + 1e-14)),
    "over-damped": Slider(mass=0.005, stiffness=300.0, damping=60.0),
}


@frozen
def oracle(slider, speed, tick):
    """The same by a series matrix exponential and Gauss-Legendre, at 40 digits."""
    with mpmath.workdps(40):
        m, k, c = (mpmath.mpf(value) for value in (slider.mass, slider.stiffness, slider.damping))
        generator = mpmath.matrix([[0, 1], [-k / m, -c / m]])
        step = mpmath.mpf(tick) / mpmath.mpf(speed)
        free = mpmath.expm(generator * step, method="taylor") - mpmath.eye(2)

        def response(y, row, order):
            moved = mpmath.expm(generator * (step * (1 - y)), method="taylor")[row, 1]
            return moved * mpmath.legendre(order, 2 * y - 1) * (2 * order + 1) / (m * mpmath.mpf(speed))

        gains = [
            [float(mpmath.quad(lambda y, r=r, i=i: response(y, r, i), [0, 1], maxdegree=5)) for i in range(3)]
            for r in range(2)
        ]
        return [[float(free[i, j]) for j in range(2)] for i in range(2)], gains


@pytest.mark.parametrize("name", SLIDERS)
@pytest.mark.parametrize("speed", [50.0, 1e5])
def test_constants_of_every_damping(name, speed):
    constants = propagator(under_force(SLIDERS[name]), speed, 0.05, 1)
    transition, gains = (np.array(each) for each in oracle(SLIDERS[name], speed, 0.05))
    assert np.allclose(constants.transition, transition, rtol=1e-14, atol=0)
    # A higher moment moves a slider little, so of each row the largest gain counts.
    assert np.all(np.abs(constants.gains - gains) < 1e-13 * np.abs(gains).max(axis=1, keepdims=True))


def test_cells_divide_the_tick():
    slider = under_force(SLIDERS["light"])
    assert np.array_equal(propagator(slider, 1e3, 0.4, 8).gains, propagator(slider, 1e3, 0.05, 1).gains)
