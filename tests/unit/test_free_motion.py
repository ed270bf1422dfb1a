"""Free normal motion: the engine beside small steps of Verlet, its bits, and what is exact of its statistics."""

import numpy as np
import pytest

from rubnoise.simulation.free.contact_run import FreeContact, FreeRun
from rubnoise.simulation.free.encounters import RoughSurface
from tests.oracle.sliders import bounce

SPEED = 1.0


def _ticks(contact, seed, count, **how):
    moving = FreeRun(contact, seed, **how)
    rows = list(moving.through(count))
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
    contact = FreeContact(live=live, speed=SPEED, tick=SPEED * duration / steps * 10.0, **loss)
    moved, _ = _ticks(contact, 3, steps // 10)
    surface = FreeRun(contact, 3).surface
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
    contact = FreeContact(live=0.5, speed=3.0, tick=0.05, restitution=0.7)
    ticks, rows = _ticks(contact, 1, 4000)
    deeper, _ = _ticks(contact, 1, 4000, layers=3)
    assert np.array_equal(ticks, deeper)
    assert len(rows) > 3
    other, _ = _ticks(contact, 2, 4000)
    assert not np.array_equal(ticks, other)


def test_the_next_layer_is_drawn_where_the_slider_falls_below_the_first(monkeypatch):
    contact = FreeContact(live=0.5, speed=0.3, tick=0.05, restitution=0.7)
    ticks, _ = _ticks(contact, 1, 2000)
    assert ticks["z"].min() < -1.0

    def shallow(surface, layers):
        return -1.0 if layers == 1 else -float(surface.base + layers - 2)

    right = RoughSurface.around
    monkeypatch.setattr(RoughSurface, "bottom", shallow)
    monkeypatch.setattr(
        RoughSurface,
        "around",
        lambda surface, block, layers: _above(right(surface, block, 1), shallow(surface, layers)),
    )
    again, rows = _ticks(contact, 1, 2000)
    assert max(each.layers for each in rows) > 1
    assert np.array_equal(ticks, again)


def _above(drawn, bottom):
    return drawn[drawn["height"] > bottom]
