"""A few lives of few ticks among many of many: summed by stretches, to the bits of one pass over everything."""

import numpy as np
import pytest

from rubnoise.contact.pulses import PULSES, Pulse
from rubnoise.simulation.kernels import Grid, Scratch, choice, deposit
from rubnoise.simulation.kernels.fine import FINEST
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


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_stretches_have_the_bits_of_one_pass(pulse: Pulse, monkeypatch: pytest.MonkeyPatch) -> None:
    lives = rows()
    weight = lives.diameter**2
    found = deposit(pulse.shape, GRID, lives, weight, Scratch(0))
    monkeypatch.setattr(choice, "_LONG", 1_000_000)
    at_once = deposit(pulse.shape, GRID, lives, weight, Scratch(0))
    assert np.array_equal(found.total, at_once.total)
    assert np.array_equal(found.moments, at_once.moments)
    without = lives.at(np.flatnonzero(lives.diameter > FINEST))
    bare = deposit(pulse.shape, GRID, without, without.diameter**2, Scratch(0))
    assert np.count_nonzero(found.total != bare.total) > 200


def test_lives_that_meet_are_one_stretch() -> None:
    lives = rows()
    coarse = lives.at(np.flatnonzero(lives.diameter < FINEST))
    assert [(some.start, some.stop) for some in choice._apart(GRID, coarse)] == [(0, 2), (2, 3), (3, 4)]
    assert [(some.start, some.stop) for some in choice._apart(GRID, lives)] == [(0, len(lives))]
