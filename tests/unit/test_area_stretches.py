"""A few lives of few ticks among many of many: summed by stretches, to the bits of one pass over everything."""

import numpy as np
import pytest

from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.simulation import area
from rubnoise.simulation.area import Room
from rubnoise.simulation.grid import Grid
from rubnoise.simulation.kernels_fine import FINEST
from rubnoise.simulation.state import LiveRows

GRID = Grid.around(0, 12_000, 1.0)
COARSE = {100.3: 20.0, 130.7: 31.0, 3_000.2: 17.5, 9_500.9: 40.25}


def rows() -> LiveRows:
    """Return lives of many ticks all along, and four of few: two that meet, and two by themselves."""
    fine = np.arange(-150.0, 11_900.0, 37.1)
    birth = np.concatenate([fine, list(COARSE)])
    diameter = np.concatenate([np.full(fine.size, 1.3 * FINEST), list(COARSE.values())])
    order = np.argsort(birth)
    return LiveRows(
        junction=np.arange(birth.size),
        birth=birth[order],
        diameter=diameter[order],
        strength=np.ones(birth.size),
        departure=np.full(birth.size, np.inf),
    )


@pytest.mark.parametrize("pulse", [LENS, TRIANGLE], ids=["lens", "triangle"])
def test_stretches_have_the_bits_of_one_pass(pulse: Pulse, monkeypatch: pytest.MonkeyPatch) -> None:
    lives = rows()
    weight = lives.diameter**2
    total, moments = (each.copy() for each in area._weighted(pulse, GRID, lives, weight, Room()))
    monkeypatch.setattr(area, "_LONG", 1_000_000)
    at_once, moments_at_once = area._weighted(pulse, GRID, lives, weight, Room())
    assert np.array_equal(total, at_once)
    assert np.array_equal(moments, moments_at_once)
    without = lives.at(np.flatnonzero(lives.diameter > FINEST))
    bare, _ = area._weighted(pulse, GRID, without, without.diameter**2, Room())
    assert np.count_nonzero(total != bare) > 200


def test_lives_that_meet_are_one_stretch() -> None:
    lives = rows()
    coarse = lives.at(np.flatnonzero(lives.diameter < FINEST))
    assert [(some.start, some.stop) for some in area._apart(GRID, coarse)] == [(0, 2), (2, 3), (3, 4)]
    assert [(some.start, some.stop) for some in area._apart(GRID, lives)] == [(0, len(lives))]
