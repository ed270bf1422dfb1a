"""The overlap of two circles, held to geometry and to integrals known without it."""

import json
from pathlib import Path

import mpmath
import numpy as np
import pytest

from rubnoise.contact.overlap import junction_area, life_integral, max_area

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
