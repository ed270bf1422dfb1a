"""Event counts of whole runs: a golden that needs no tolerance."""

import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.simulation import draws
from rubnoise.simulation.observer import Observer
from tests.models import bare, model, run_to_end

GOLDEN = {
    "figure 5, 20 mm": (model(distance=20_000.0, tick=0.1), (37, 36542, 74008, 110536)),
    "no slider": (bare(distance=2000.0, tick=0.5), (4, 3717, 7490, 11196)),
    "dense": (bare(count=5000.0, distance=20.0, tick=0.1), (3, 148320, 301840, 444900)),
    "thin": (bare(count=0.01, distance=100_000.0, tick=50.0), (1, 4, 13, 17)),
    "triangles born regularly": (
        model(births="regular", pulse=TRIANGLE, distance=2000.0, tick=0.5),
        (4, 3983, 8024, 11987),
    ),
    "one size, from empty": (bare(spread=Spread(), start="empty", distance=2000.0, tick=0.5), (4, 3700, 7473, 11168)),
}


@pytest.fixture(autouse=True)
def each_block_alone(monkeypatch):
    """Blocks that are played together take some events less."""
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)


@pytest.mark.parametrize("name", GOLDEN)
def test_event_count(name):
    run, expected = GOLDEN[name]
    _, state = run_to_end(run)
    assert (state.block, state.junctions, state.events) == expected[:3]


@pytest.mark.parametrize("name", GOLDEN)
def test_event_count_with_an_observer(name):
    """Births and deaths are observed without another event, mid-lives with one each."""
    run, expected = GOLDEN[name]
    told = []
    _, state = run_to_end(run, observe=Observer(birth=lambda *_: None, death=lambda *_: None))
    assert state.events == expected[2]
    _, state = run_to_end(run, observe=Observer(mid_life=lambda *what: told.append(what)))
    assert state.events == expected[3]
    assert abs(state.events - expected[2] - len(told)) <= state.block
