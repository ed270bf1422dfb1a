"""Free normal motion: the engine beside small steps of Verlet, its bits, and what is exact of its statistics."""

import numpy as np
import pytest

from rubnoise.simulation.free.encounters import RoughSurface
from rubnoise.simulation.free.step import Constants
from rubnoise.simulation.free_motion import FreeRun
from tests.oracle.sliders import bounce

SPEED = 1.0


def _ticks(live, speed, tick, seed, count, layers=1, restitution=1.0, impact_damping=0.0, damping_ratio=0.0):
    law = Constants(speed, 1.0 / live, 2.0 * damping_ratio, restitution**2, impact_damping)
    rows = list(FreeRun(law, RoughSurface.of(live, seed, tick), layers=layers).through(count))
    return np.concatenate([each.ticks for each in rows]), rows


def _share(restitution=None, impact_damping=None, damping_ratio=0.0):
    """Return how much of an overlap's elastic force is borne, by its rate."""
    if restitution is None:
        return lambda rate: np.maximum(0.0, 1.0 + impact_damping * rate)
    return lambda rate: np.where(rate > 0.0, 1.0, restitution**2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("live", "loss"),
    [
        (5.0, {"restitution": 1.0, "damping_ratio": 0.05}),
        (5.0, {"restitution": 0.7}),
        (2.0, {"restitution": 0.3}),
        (5.0, {"restitution": 0.0}),
        (0.5, {"impact_damping": 0.3}),
    ],
)
def test_verlet_goes_the_same_way(live, loss):
    duration, steps = 2.0, 10_000
    tick = SPEED * duration / steps * 10.0
    moved, _ = _ticks(live, SPEED, tick, 3, steps // 10, **loss)
    surface = RoughSurface.of(live, 3, tick)
    around = surface.around(0, 1)
    assert duration * SPEED < surface.length
    near = np.abs(around["place"]) < 9.0
    summits, drag = (around["place"][near], around["height"][near]), loss.get("damping_ratio", 0.0)
    z = bounce(*summits, live, SPEED, _share(**loss), duration, steps, drag)
    assert np.ptp(z) > 0.1
    assert np.abs(moved["z"] - z).max() < 2e-7
    if "restitution" in loss and loss["restitution"] < 1.0:
        # Its own error, where steps in which a force jumps are not made finer, and another restitution, both show.
        coarse = bounce(*summits, live, SPEED, _share(**loss), duration, steps, finer=1)
        assert np.abs(moved["z"] - coarse).max() > 2e-7
        other = bounce(*summits, live, SPEED, _share(loss["restitution"] + 0.1), duration, steps)
        assert np.abs(moved["z"] - other).max() > 1e-4


def test_bits_do_not_depend_on_how_deep_the_pool_is():
    contact = {"live": 0.5, "speed": 3.0, "tick": 0.05, "restitution": 0.7}
    ticks, rows = _ticks(seed=1, count=4000, **contact)
    deeper, _ = _ticks(seed=1, count=4000, layers=3, **contact)
    assert np.array_equal(ticks, deeper)
    assert len(rows) > 3
    other, _ = _ticks(seed=2, count=4000, **contact)
    assert not np.array_equal(ticks, other)


def test_the_next_layer_is_drawn_where_the_slider_falls_below_the_first(monkeypatch):
    contact = {"live": 0.5, "speed": 0.3, "tick": 0.05, "restitution": 0.7}
    ticks, _ = _ticks(seed=1, count=2000, **contact)
    assert ticks["z"].min() < -1.0

    def shallow(surface, layers):
        return -1.0 if layers == 1 else -float(surface.base + layers - 2)

    right = RoughSurface.around
    monkeypatch.setattr(RoughSurface, "bottom", shallow)
    drawn = set()

    def around(surface, block, layers):
        drawn.add(layers)
        found = right(surface, block, 1)
        return found[found["height"] > shallow(surface, layers)]

    monkeypatch.setattr(RoughSurface, "around", around)
    again, _ = _ticks(seed=1, count=2000, **contact)
    assert max(drawn) > 1
    assert np.array_equal(ticks, again)
