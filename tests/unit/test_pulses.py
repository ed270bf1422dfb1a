"""Pulses and sizes: the registry of shapes, overlaps, calibrations, grids, and the constants of the slider."""

import json
from math import pi, sqrt
from pathlib import Path

import mpmath
import numpy as np
import pytest

from rubnoise.contact.calibration import Uncalibrated, calibrated_diameter
from rubnoise.contact.laws import LAWS, Spread, law_for
from rubnoise.contact.pulses import LENS, PARABOLA, PULSES
from rubnoise.model import Slider
from rubnoise.simulation.linear import linear_system, propagator
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.unit_pulse import amplitude
from tests.frozen import frozen
from tests.models import model

# Every pulse of the registry has its entry in each table that goes by shape, and what it says of itself agrees.
every_pulse = pytest.mark.parametrize("pulse", PULSES.values(), ids=PULSES)


SLOPES = {
    "lens": lambda r: np.sqrt(1.0 - r * r),
    "triangle": lambda r: np.full_like(r, 0.25 * pi),
    "parabola": lambda r: 0.5 * pi * r,
}
"""-dL/dr over a life of unit diameter."""


@every_pulse
def test_squared_slope_is_the_integral_of_the_slope_squared(pulse):
    places, weights = np.polynomial.legendre.leggauss(8)
    rising = 0.5 * weights @ np.square(SLOPES[pulse.shape](0.5 + 0.5 * places))
    assert 2.0 * rising == pytest.approx(pulse.squared_slope, rel=1e-14)
    rise = 0.5 * weights @ SLOPES[pulse.shape](0.5 + 0.5 * places)
    assert rise == pytest.approx(float(pulse.overlap(0.0)), rel=1e-3)


# The parabola's exact figures beside those of a second program (tests/reference/family.json), and two errors of it.
REFERENCE = json.loads((Path(__file__).parents[1] / "reference" / "family.json").read_text(encoding="utf-8"))[
    "parabola"
]
RAYLEIGH = Spread(relative=sqrt(4.0 / pi - 1.0), law="weibull")


@pytest.mark.parametrize(("spread", "key"), [(Spread(), "cv_sqrtN_fixed"), (RAYLEIGH, "cv_sqrtN_rayleigh")], ids=str)
def test_variations_are_those_of_the_reference(spread: Spread, key: str) -> None:
    found = area_cumulants(model(spread=spread, calibration="matched", pulse=PARABOLA))
    assert found.mean == pytest.approx(200.0, rel=1e-13)
    assert sqrt(20.0) * found.std / found.mean == pytest.approx(REFERENCE[key], rel=1e-12)
    lens = area_cumulants(model(spread=spread, calibration="matched", pulse=LENS))
    assert sqrt(20.0) * lens.std / lens.mean != pytest.approx(REFERENCE[key], rel=0.01)


def test_its_transform_is_the_integral_of_its_life() -> None:
    z = np.array([0.0, 1e-3, 0.5, 0.999, 1.0, 1.001, 4.0, 20.0, 60.0])
    x, w = np.polynomial.legendre.leggauss(80)
    expected = (0.25 * pi * (1.0 - x * x) * np.cos(np.multiply.outer(z, x))) @ w
    assert amplitude(PARABOLA, z) == pytest.approx(expected, abs=1e-10)


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
    assert float(LENS.area(s, d)) == pytest.approx(expected, abs=1e-15 * d * d, rel=1e-12)


@pytest.mark.parametrize("power", [1, 2, 3, 4, 5, 6])
def test_life_integrals_are_the_known_ones(power: int) -> None:
    assert LENS.life_integral(power) == pytest.approx(float(CONSTANTS[str(power)]), rel=5e-15)


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


def test_matched_takes_the_larger_root():
    diameter = calibrated_diameter("matched", 100.0, 20.0, Spread(absolute=1.5))
    assert diameter > 0.887855 * 1.5


def test_no_match_below_the_least_mean_area():
    least = 1.609247 * 20.0 * 0.2**2
    assert calibrated_diameter("matched", least * 1.0001, 20.0, FIG5) == pytest.approx(0.887855 * 0.2, rel=0.03)
    with pytest.raises(Uncalibrated, match=r"1\.609247 mean_junction_count \* spread\^2 = 1\.287398"):
        calibrated_diameter("matched", least * 0.9999, 20.0, FIG5)


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
    constants = propagator(linear_system(model(slider=SLIDERS[name])), speed, 0.05, 1)
    transition, gains = (np.array(each) for each in oracle(SLIDERS[name], speed, 0.05))
    assert np.allclose(constants.transition, transition, rtol=1e-14, atol=0)
    # A higher moment moves a slider little, so of each row the largest gain counts.
    assert np.all(np.abs(constants.gains - gains) < 1e-13 * np.abs(gains).max(axis=1, keepdims=True))
