"""Exact laws of the two-way slider, and closed forms for contacts that do not change or rise steadily."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model, Slider
from rubnoise.simulation.state import LiveRows
from tests.models import among, coupled, model, oscillator_of, recorded
from tests.oracle.coupled_slider import BREAKAWAY, FORWARD, REVERSAL, STICK, frozen

# Exact laws of the two-way slider: energy, the mean force, and the order in which its cells converge.


@pytest.mark.parametrize("run", [model(distance=40.0), model(distance=60.0, count=5.0)])
def test_the_tolerance_is_kept(run: Model) -> None:
    """The motion at a tolerance differs from that at 1e-13 by no more than some times as much."""
    exact = coupled(run, 2, tolerance=1e-13).slider["displacement"]
    errors = []
    for tolerance in (1e-5, 1e-7, 1e-9, 1e-11):
        found = coupled(run, 2, tolerance=tolerance).slider["displacement"]
        count = min(found.size, exact.size)
        errors.append(float(np.abs(found[:count] - exact[:count]).max() / np.abs(exact).max()))
        assert errors[-1] < 3.0 * tolerance
    assert errors[0] > 1e3 * errors[-1]


def test_fast_sliding_is_one_way() -> None:
    """Coupling changes the vibration by some 1.5 Pi, Pi = psi^2 S_A(0)/(2 m c V^3): 3e-6 at 1 m/s, 0.02 at 50 mm/s."""
    ratios = []
    for speed in (1e6, 5e4):
        run = model(distance=40_000.0, speed=speed, tick=0.5)
        one_way = recorded(run, 3, engine="batch")["slider"]["displacement"]
        two_way = coupled(run, 3).slider["displacement"]
        count = min(one_way.size, two_way.size)
        ratios.append(float(two_way[:count].std() / one_way[:count].std()))
    assert abs(ratios[0] - 1.0) < 3e-4
    assert abs(ratios[1] - 1.0) > 4e-4


# The slider two-way coupled to a contact that does not change, or rises steadily: closed forms.
BEARS = 51168.0
"""G in uN."""
SIZE = 1e5
"""Diameter of triangles (um) that are straight wherever a slider goes."""


def triangles(birth: list[float], strength: float) -> LiveRows:
    count = len(birth)
    return LiveRows(
        junction=np.arange(count, dtype=np.int64),
        birth=np.array(birth),
        diameter=np.full(count, SIZE),
        strength=np.full(count, strength),
        departure=np.full(count, np.inf),
    )


def constant() -> LiveRows:
    """Return a rising and a falling triangle that add up to G."""
    return triangles([-1.5 * SIZE, -0.5 * SIZE], BEARS / (0.25 * math.pi * SIZE * SIZE))


@pytest.mark.parametrize(
    ("damping", "speed", "start", "landmarks"),
    [
        (0.0, 1000.0, -6822.0, 20),
        (0.02, 1000.0, -9000.0, 20),
        (0.05, 1000.0, -6800.0, 15),
        (0.05, 30000.0, -5100.0, 12),
        (0.05, 1000.0, 0.0, 2),
    ],
)
def test_a_constant_force(damping: float, speed: float, start: float, landmarks: int) -> None:
    slider = Slider(mass=0.005, stiffness=300.0, damping=damping)
    run = model(pulse=TRIANGLE, slider=slider, speed=speed, distance=4000.0)
    found = among(run, constant(), displacement=start, tolerance=1e-12, most=landmarks).landmarks
    expected = frozen(oscillator_of(run), speed, BEARS, start, landmarks)
    assert len(expected) == landmarks
    kinds, times, places = (np.array(column) for column in zip(*expected, strict=True))
    assert found["kind"][:landmarks].tolist() == kinds.tolist()
    assert np.abs(found["time"][:landmarks] - times).max() < 1e-12
    assert np.abs(found["displacement"][:landmarks] - places).max() < 1e-11 * max(np.abs(places).max(), 1.0)
    if damping > 0.0:
        # Static and kinetic force are the same: after one stick it never sticks again.
        assert (found["kind"] == STICK).sum() <= 1


@pytest.mark.parametrize("slope", [0.0, 400.0, 5000.0])
def test_on_a_steady_rise_without_damping_every_period_ends_in_a_stick_of_no_length(slope: float) -> None:
    """w = k V/(k + G') (1 - cos Omega t), Omega^2 = (k + G')/m, touches 0 once a period: nothing crosses it."""
    slider = Slider(mass=0.005, stiffness=300.0, damping=0.0)
    period = 2.0 * math.pi * math.sqrt(0.005 / (300.0 + slope))
    each = 300.0 * 1000.0 / (300.0 + slope) * period
    run = model(pulse=TRIANGLE, slider=slider, distance=round(12.0 * each + 20.0, 1))
    lives = triangles([-BEARS / slope], slope / (0.25 * math.pi * SIZE)) if slope else constant()
    found = among(run, lives, displacement=0.0, tolerance=1e-11)
    kind, time = found.landmarks["kind"], found.landmarks["time"]
    assert kind.size >= 14
    assert kind.tolist() == [STICK, BREAKAWAY] * (kind.size // 2)
    slips = time[1::2]
    assert np.abs(np.diff(slips) - period).max() < 1e-9 * period
    assert np.abs(slips[1:] - time[2::2]).max() < 1e-9 * period
    # Between them, the closed form.
    rows = found.slider
    inside = (rows["time"] > slips[0]) & (rows["time"] < slips[6])
    phase = 2.0 * math.pi * (rows["time"][inside] - slips[0]) / period
    expected = 1000.0 - 300.0 * 1000.0 / (300.0 + slope) * (1.0 - np.cos(phase))
    assert np.abs(rows["velocity"][inside] - expected).max() < 1e-6 * 1000.0


def test_a_breakaway_begins_as_the_cube_of_time() -> None:
    """w = k V t^2/2m, s - s_0 = k V t^3/6m: whoever looks for w = 0 there would stick for ever."""
    run = model(pulse=TRIANGLE, distance=40.0, tick=0.001)
    found = among(run, constant(), displacement=100.0)
    stick, slip = found.landmarks["time"][:2]
    assert found.landmarks["kind"].tolist() == [STICK, BREAKAWAY]
    assert slip - stick == pytest.approx((BEARS / 300.0 - found.landmarks["displacement"][0] - 0.05 / 0.3) / 1000.0)
    rows = found.slider
    early = (rows["time"] > slip) & (rows["time"] < slip + 1e-4)
    since = rows["time"][early] - slip
    moved = rows["distance"][early] - found.landmarks["distance"][1]
    assert early.sum() > 50
    assert moved == pytest.approx(300.0 * 1000.0 * since**3 / (6 * 0.005), rel=2e-3, abs=1e-13)
    assert 1000.0 - rows["velocity"][early] == pytest.approx(
        300.0 * 1000.0 * since**2 / (2 * 0.005), rel=2e-3, abs=1e-9
    )


def test_births_that_are_passed_again_are_told_once_and_when_they_were_passed_first() -> None:
    """Let go far out, the slider swings over the same junctions again and again; they weigh next to nothing."""
    births, start = [1000.0, 5000.0, 9000.0], 6822.0
    rows = triangles([-1.5 * SIZE, -0.5 * SIZE, *births], BEARS / (0.25 * math.pi * SIZE * SIZE))
    light = rows.strength * np.array([1.0, 1.0, 1e-12, 1e-12, 1e-12])
    slider = Slider(mass=0.005, stiffness=300.0, damping=0.0)
    run = model(pulse=TRIANGLE, slider=slider, distance=13400.0)
    found = among(run, replace(rows, strength=light), displacement=start, most=6)
    # Forward past all of them, back behind all but the first, forward again.
    assert found.landmarks["kind"][:2].tolist() == [REVERSAL, FORWARD]
    far, back = found.landmarks["distance"][:2]
    assert back < births[0] < births[2] < far
    junctions, times = found.births
    assert junctions.tolist() == [2, 3, 4]
    rest, rate = BEARS / 300.0, math.sqrt(300.0 / 0.005)

    def beyond(time: float, place: float) -> float:
        return 1000.0 * time - (rest + (start - rest) * math.cos(rate * time) - start) - place

    first = [brentq(beyond, 0.0, math.pi / rate, args=(place,), xtol=1e-15) for place in births]
    assert np.abs(times - first).max() < 1e-11
