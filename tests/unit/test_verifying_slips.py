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
    no_lives = slips.Lives(*(np.empty(1) for _ in range(4)))
    clocks = (0, 0)
    time, path, u, landed = slips._step(oscillator, start, most, BORDER, clocks, 0, no_lives, 0, np.empty((8, 2)))
    assert landed
    assert path == BORDER
    # u = y' with m y'' + c y' + k y = k V t: the first terms of its series are enough for so short a time.
    cubic = np.cbrt(6.0 * MASS * BORDER / (STIFFNESS * DRIVE))
    assert time == pytest.approx(cubic * (1.0 + DAMPING * cubic / (12.0 * MASS)), rel=1e-3)
    assert u == pytest.approx(3.0 * BORDER / time, rel=1e-2)


def test_a_border_that_is_reached_slowly_after_a_fast_start_is_found() -> None:
    """Without a contact and c = V = 0 it goes as l = u_0 sin(omega t)/omega; the border lies near where it turns."""
    omega, fast = np.sqrt(STIFFNESS / MASS), 1300.0
    oscillator = slips.Oscillator(MASS, STIFFNESS, 0.0, 0.0, longest=0.5 * np.pi / omega, limit=1e-12, error=1e-9)
    start = slips.Start(way=1.0, displacement=0.0, since=0.0, path=0.0, speed=fast)
    no_lives = slips.Lives(*(np.empty(1) for _ in range(4)))
    for phase in (0.9, 0.97, 0.99):
        border = fast / omega * np.sin(0.5 * np.pi * phase)
        time, path, u = _passed(oscillator, start, border, no_lives)
        assert path == border
        assert time == pytest.approx(0.5 * np.pi * phase / omega, rel=1e-8)
        assert u == pytest.approx(fast * np.cos(0.5 * np.pi * phase), rel=1e-6)


def _passed(oscillator: slips.Oscillator, start: slips.Start, border: float, lives: slips.Lives) -> tuple[float, ...]:
    """Go on by steps until the border is reached; return time, path and u there."""
    time, landed, table = 0.0, False, np.empty((8, 2))
    while not landed:
        h, path, u, landed = slips._step(oscillator, start, oscillator.longest, border, (0, 0), 0, lives, 0, table)
        assert np.isfinite(path)
        time += h
        start = start._replace(since=time, path=path, speed=u)
    return time, path, u
