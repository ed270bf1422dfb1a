"""Free normal motion: the engine beside small steps of Verlet, its bits, and what is exact of its statistics."""

import numpy as np
import pytest
from scipy.signal import lsim
from scipy.special import stdtr

from rubnoise.analysis.agreement import normal_deviate
from rubnoise.contact.laws import Spread, law_for
from rubnoise.simulation.free import motion
from rubnoise.simulation.free.contacts import DRAG
from rubnoise.simulation.free.encounters import RoughSurface
from rubnoise.simulation.free.fold import FreeContact, FreeRun
from tests.oracle.sliders import bounce

SPEED = 1.0


def _ticks(contact, seed, count, **how):
    moving = FreeRun(contact, seed, **how)
    rows = list(moving.through(count))
    return np.concatenate([each.ticks for each in rows], axis=1), rows


def _share(restitution=None, impact_damping=None, damping_ratio=0.0):
    """Return how much of an overlap's elastic force is borne, by its rate."""
    if restitution is None:
        return lambda rate: np.maximum(0.0, 1.0 + impact_damping * rate)
    return lambda rate: np.where(rate > 0.0, 1.0, restitution**2)


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
    near = np.abs(around.place) < 9.0
    summits, drag = (around.place[near], around.height[near]), loss.get("damping_ratio", 0.0)
    z = bounce(*summits, live, SPEED, _share(**loss), duration, steps, drag)
    assert np.ptp(z) > 0.1
    assert np.abs(moved[motion.TICK_Z] - z).max() < 2e-7
    if "restitution" in loss and loss["restitution"] < 1.0:
        # Its own error, where steps in which a force jumps are not made finer, and another restitution, both show.
        coarse = bounce(*summits, live, SPEED, _share(**loss), duration, steps, finer=1)
        assert np.abs(moved[motion.TICK_Z] - coarse).max() > 2e-7
        other = bounce(*summits, live, SPEED, _share(loss["restitution"] + 0.1), duration, steps)
        assert np.abs(moved[motion.TICK_Z] - other).max() > 1e-4


def test_a_slider_along_the_surface_is_pushed_by_unequal_strengths():
    """x'' + g x' + k x = F, solved anew by scipy for the force that stands in the ticks."""
    drag, spring, tick = 0.3, 4.0, 0.002
    contact = FreeContact(live=2.0, speed=SPEED, tick=tick, restitution=0.7, slider=(drag, spring, 0.0))
    strengths = law_for(250.0, Spread(relative=0.6, law="lognormal"))
    ticks, rows = _ticks(contact, 3, 16_000, strengths=strengths)
    touches = np.concatenate([each.touches for each in rows], axis=1)
    _, first = np.unique(touches[motion.TOUCH_NUMBER], return_index=True)
    shares = touches[motion.TOUCH_SHARE, first]
    error = 0.6 / np.sqrt(shares.size)
    assert shares.size > 20
    assert abs(shares.mean() - 1.0) < 4.0 * error
    force = ticks[motion.TICK_SHARED]
    assert np.ptp(force / np.maximum(ticks[motion.TICK_OVERLAP], 1e-9)) > 0.5, "shares matter"
    slider = [[0.0, 1.0], [-spring, -drag]], [[0.0], [1.0]], np.eye(2), np.zeros((2, 1))
    time = tick * np.arange(force.size)
    _, flow, _ = lsim(slider, force, time)
    # Between ticks lsim takes the force for linear: its second derivative is bounded by the events' jumps alone.
    assert np.abs(ticks[motion.TICK_X] - flow[:, 0]).max() < 1e-5 * np.ptp(flow[:, 0])
    assert np.abs(ticks[motion.TICK_U] - flow[:, 1]).max() < 1e-4 * np.ptp(flow[:, 1])
    _, equal, _ = lsim(slider, ticks[motion.TICK_OVERLAP], time)
    assert np.abs(ticks[motion.TICK_X] - equal[:, 0]).max() > 0.01 * np.ptp(equal[:, 0])


def test_bits_do_not_depend_on_how_deep_the_pool_is_or_where_the_run_is_cut():
    contact = FreeContact(live=0.5, speed=3.0, tick=0.05, restitution=0.7)
    ticks, rows = _ticks(contact, 1, 4000)
    deeper, _ = _ticks(contact, 1, 4000, layers=3)
    assert np.array_equal(ticks, deeper)
    assert len(rows) > 3
    state, found = None, []
    while not found or found[-1].shape[1] == found[0].shape[1]:
        moving = FreeRun(contact, 1, state)
        found.append(next(moving.through(4000)).ticks)
        state = moving.state
    assert np.array_equal(np.concatenate(found, axis=1), ticks)
    other, _ = _ticks(contact, 2, 4000)
    assert not np.array_equal(ticks, other)


def test_the_next_layer_is_drawn_where_the_slider_falls_below_the_first(monkeypatch):
    contact = FreeContact(live=0.5, speed=0.3, tick=0.05, restitution=0.7)
    ticks, _ = _ticks(contact, 1, 2000)
    assert ticks[motion.TICK_Z].min() < -1.0

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
    kept = drawn.height > bottom
    return type(drawn)(place=drawn.place[kept], height=drawn.height[kept], number=drawn.number[kept])


LOSSES = (
    {"restitution": 1.0, "damping_ratio": 0.05},
    {"restitution": 0.7},
    {"restitution": 0.0},
    {"impact_damping": 0.3},
)
LIVE = (0.01, 0.1, 0.5, 2.0, 10.0)
CONTACTS = [
    (live, (0.3, 1.0, 3.0, 0.5, 2.0)[(k + j) % 5], loss) for k, live in enumerate(LIVE) for j, loss in enumerate(LOSSES)
]


@pytest.mark.parametrize(("live", "speed", "loss"), CONTACTS)
def test_the_load_is_the_weight_in_the_mean(live, speed, loss):
    """Momentum: over a time T the mean of P is 1 + ([z'] + 2 zeta [z])/T; ticks give it with an error of the mean 0."""
    contact = FreeContact(live=live, speed=speed, tick=min(0.05, 0.1 * speed * live**0.5), **loss)
    ticks, _ = _ticks(contact, 7 + CONTACTS.index((live, speed, loss)), int(400.0 * speed / contact.tick))
    length = (ticks.shape[1] - 1) // 20
    ends = length * np.arange(21)
    load, momentum = ticks[motion.TICK_LOAD], ticks[motion.TICK_W] + contact.constants()[DRAG] * ticks[motion.TICK_Z]
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (load[1:] + load[:-1]))])
    means = np.diff(whole[ends]) / length - np.diff(momentum[ends]) * speed / (length * contact.tick)
    error = means.std(ddof=1) / 20.0**0.5

    def deviate(weight):
        t = (means.mean() - weight) / error
        return normal_deviate(float(stdtr(19, t)), float(stdtr(19, -t)))

    assert abs(deviate(1.0)) < 4.0
    assert deviate(1.05) < -4.0


@pytest.mark.parametrize("loss", [{"restitution": 0.7}, {"impact_damping": 0.3}])
def test_contact_is_lost_and_made_in_turn(loss):
    ticks, rows = _ticks(FreeContact(live=0.1, speed=1.0, tick=0.05, **loss), 1, 40_000)
    assert 0.75 < (ticks[motion.TICK_LIVE, 8000:] == 0).mean() < 0.9
    marks = np.concatenate([each.marks for each in rows], axis=1)
    kinds = marks[motion.MARK_KIND]
    assert (np.diff(kinds) != 0).all()
    assert (marks[motion.MARK_SPEED] > 0.0).all()
