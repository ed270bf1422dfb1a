"""Every pulse of the registry has its entry in each table that goes by shape, and what it says of itself agrees."""

import mpmath
import numpy as np
import pytest

from rubnoise.contact.pulses import PULSES
from rubnoise.storage.schema import JUNCTION_AREA_FORMULAS
from rubnoise.theory.live_area import unit_density
from rubnoise.theory.transform import transform_of
from tests.oracle.second import sums

every_pulse = pytest.mark.parametrize("pulse", PULSES.values(), ids=PULSES)
AGES = np.linspace(0.0, 1.0, 101)


@every_pulse
def test_every_pulse_is_known_to_each_table(pulse):
    assert JUNCTION_AREA_FORMULAS[pulse.shape].startswith(f"A(s) = {pulse.formula} with")
    assert transform_of(pulse).amplitude(0.0) == pytest.approx(pulse.life_integral(1), rel=1e-14)
    assert unit_density(pulse)(np.array([0.3])) > 0.0
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
