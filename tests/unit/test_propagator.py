"""The slider's constants against a matrix exponential and quadrature, for every kind of damping."""

import mpmath
import numpy as np
import pytest

from rubnoise.model import Slider
from rubnoise.simulation.slider import propagator
from tests.frozen import frozen

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
    constants = propagator(SLIDERS[name], speed, 0.05, 1)
    transition, gains = oracle(SLIDERS[name], speed, 0.05)
    assert np.allclose(constants.transition, transition, rtol=1e-14, atol=0)
    assert np.allclose(constants.gains, gains, rtol=1e-13, atol=0)


def test_cells_divide_the_tick():
    slider = SLIDERS["light"]
    assert np.array_equal(propagator(slider, 1e3, 0.4, 8).gains, propagator(slider, 1e3, 0.05, 1).gains)
