"""A slip integrated again for `verify`, at its most delicate place."""

import numpy as np
import pytest

from rubnoise.analysis.verifying import slips

MASS, STIFFNESS, DAMPING, DRIVE = 0.005, 300.0, 0.05, 1000.0
BORDER = 0.00136


@pytest.mark.parametrize("most", [1e-3, 2e-3])
def test_a_slip_that_begins_with_no_speed_and_no_acceleration_finds_its_border(most: float) -> None:
    """Without a contact and with f = k x + c V = 0 it goes as k V t^3 / 6 m, and Newton's first steps go astray."""
    oscillator = slips.Oscillator(MASS, STIFFNESS, DAMPING, DRIVE, longest=2e-3, limit=1e-12, error=1e-9)
    start = slips.Start(way=1.0, displacement=-DAMPING * DRIVE / STIFFNESS, since=0.0, path=0.0, speed=0.0)
    nobody = slips.Lives(*(np.empty(1) for _ in range(4)))
    clocks = (0, 0)
    time, path, u, landed = slips._step(oscillator, start, most, BORDER, clocks, 0, nobody, 0, np.empty((8, 2)))
    assert landed
    assert path == BORDER
    # u = y' with m y'' + c y' + k y = k V t: the first terms of its series are enough for so short a time.
    cubic = np.cbrt(6.0 * MASS * BORDER / (STIFFNESS * DRIVE))
    assert time == pytest.approx(cubic * (1.0 + DAMPING * cubic / (12.0 * MASS)), rel=1e-3)
    assert u == pytest.approx(3.0 * BORDER / time, rel=1e-2)
