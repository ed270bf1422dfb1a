"""Exact laws of the two-way slider, and closed forms for contacts that do not change or rise steadily."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.model import Model, Slider
from rubnoise.simulation.state import LiveRows
from tests.models import CoupledRun, among, coupled, field_of, model, oscillator_of, recorded
from tests.oracle.coupled_slider import BREAKAWAY, FORWARD, REVERSAL, STICK, frozen
from tests.oracle.second.balance import area_so_far
from tests.oracle.slow_contact import Rows

# Exact laws of the two-way slider: energy, the mean force, and the order in which its cells converge.


@pytest.mark.parametrize("run", [model(distance=40.0), model(distance=60.0, count=5.0)])
def test_finer_cells_converge(run: Model) -> None:
    """A life begins as u^1.5, of which a cubic misses h^1.5, and of its second integral h^3.5."""
    exact = coupled(run, 2, cells=3200).slider["displacement"]
    errors = []
    for cells in (50, 200, 800):
        found = coupled(run, 2, cells=cells).slider["displacement"]
        count = min(found.size, exact.size)
        errors.append(float(np.abs(found[:count] - exact[:count]).max() / np.abs(exact).max()))
    assert errors[0] < 1e-4
    assert errors[2] < 1e-9
    assert errors[0] > 10.0 * errors[1] > 100.0 * errors[2]


def test_fast_sliding_is_one_way() -> None:
    """Coupling changes the vibration by some 1.5 Pi, Pi = psi^2 S_A(0)/(2 m c V^3): 3e-6 at 1 m/s, 0.02 at 50 mm/s."""
    ratios = []
    for speed in (1e6, 5e4):
        run = model(distance=40_000.0, speed=speed, tick=0.5)
        one_way = recorded(run, 4, engine="batch")["slider"]["displacement"]
        two_way = coupled(run, 4).slider["displacement"]
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
    found = among(run, constant(), displacement=start, most=landmarks).landmarks
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
    found = among(run, lives, displacement=0.0)
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
    """Let go far out, the slider swings over the same junctions again and again; they weigh next to nothing.

    The last one is born shortly before the slider turns round, so that it is passed twice before its row is written.
    """
    births, start = [1000.0, 5000.0, 13200.0], 6822.0
    rows = triangles([-1.5 * SIZE, -0.5 * SIZE, *births], BEARS / (0.25 * math.pi * SIZE * SIZE))
    light = rows.strength * np.array([1.0, 1.0, 1e-12, 1e-12, 1e-12])
    slider = Slider(mass=0.005, stiffness=300.0, damping=0.0)
    run = model(pulse=TRIANGLE, slider=slider, distance=13400.0)
    found = among(run, replace(rows, strength=light), displacement=start, most=6)
    # Forward past all of them, back behind all but the first, forward again.
    assert found.landmarks["kind"][:2].tolist() == [REVERSAL, FORWARD]
    far, back = found.landmarks["distance"][:2]
    assert back < births[0] < births[2] < far
    junctions, times = found.passed("birth")
    assert junctions.tolist() == [2, 3, 4]
    rest, rate = BEARS / 300.0, math.sqrt(300.0 / 0.005)

    def beyond(time: float, place: float) -> float:
        return 1000.0 * time - (rest + (start - rest) * math.cos(rate * time) - start) - place

    first = [brentq(beyond, 0.0, math.pi / rate, args=(place,), xtol=1e-15) for place in births]
    assert np.abs(times - first).max() < 1e-11


DAMPED = Slider(mass=0.005, stiffness=300.0, damping=1.0)


def lens_so_far(u: np.ndarray) -> np.ndarray:
    """Return int_0^u of a lens's area over d^2, u in diameters: (2/3) at the end of a life."""
    rise = area_so_far(LENS, np.clip(np.minimum(u, 2.0 - u), 0.0, 1.0))
    return np.where(u <= 1.0, rise, 2.0 / 3.0 - rise)


def friction_integral(field: Rows, begin: float, end: float) -> float:
    """Return int G ds in uN um between two distances, from the lives' own primitives."""
    ages = [(s - field.birth) / field.diameter for s in (begin, end)]
    return float(np.sum(field.strength * field.diameter**3 * (lens_so_far(ages[1]) - lens_so_far(ages[0]))))


def slider_of(run: Model) -> tuple[Slider, float]:
    assert run.slider is not None
    assert run.sliding_speed is not None
    return run.slider, run.sliding_speed


def work_of_friction(run: Model, seed: int, found: CoupledRun) -> tuple[float, float]:
    """Return int G |ds| and int G ds over the whole path, piece by monotone piece."""
    field = field_of(run, seed, min(float(found.slider["distance"].min()) - 1.0, 0.0))
    # A reversal may end in a stick, which goes on forward.
    kinds, places = found.landmarks["kind"], found.landmarks["distance"]
    turns = [float(s) for n, s in enumerate(places) if kinds[n] >= 2 or (kinds[n] == 0 and n and kinds[n - 1] == 2)]
    path = [0.0, *turns, found.balance["distance"]]
    pieces = [friction_integral(field, a, b) for a, b in pairwise(path)]
    return math.fsum(abs(piece) for piece in pieces), math.fsum(pieces)


def mean_force_times_time(run: Model, found: CoupledRun) -> float:
    """Return int F dt = m [x'] + c [x] + k int x dt in uN s."""
    slider, _ = slider_of(run)
    velocity = found.balance["velocity"]
    moved = found.balance["displacement"] - found.start
    return slider.mass * velocity + slider.damping * moved + slider.stiffness * found.balance["displacement_integral"]


def energy_gained(run: Model, found: CoupledRun) -> float:
    slider, _ = slider_of(run)
    velocity, x = found.balance["velocity"], found.balance["displacement"]
    return 0.5 * slider.mass * velocity**2 + 0.5 * slider.stiffness * (x**2 - found.start**2)


RUNS = [
    (model(distance=400.0), None),
    (model(distance=400.0, slider=DAMPED), None),
    (model(distance=600.0, count=5.0), -300.0),
    (model(distance=800.0, count=2.0), -800.0),
    (model(distance=300.0, speed=1e4), None),
    (model(distance=40.0, speed=100.0), None),
    (model(distance=300.0, speed=1e6), None),
]


@pytest.mark.parametrize(("run", "start"), RUNS)
def test_energy(run: Model, start: float | None) -> None:
    """V int F dt = int G |ds| + c int x'^2 dt + [m x'^2/2 + k x^2/2]."""
    found = coupled(run, 4, displacement=start)
    slider, speed = slider_of(run)
    along, across = work_of_friction(run, 4, found)
    assert found.balance["friction_work"] == pytest.approx(along, rel=1e-8)
    assert 2.0 * found.balance["reverse_work"] == pytest.approx(along - across, rel=1e-8, abs=1e-10 * along)
    given = speed * mean_force_times_time(run, found)
    stored = energy_gained(run, found)
    taken = along + slider.damping * found.balance["velocity_squared_integral"] + stored
    assert abs(given - taken) < 1e-8 * abs(given)
    # The drive's speed off by 1 in 10^6.
    assert abs(given * (1.0 + 1e-6) - taken) > 1e-8 * abs(given)


@pytest.mark.parametrize(("run", "start"), RUNS[:4])
def test_the_mean_force(run: Model, start: float | None) -> None:
    """<F> V T = int G ds + 2 int_(w < 0) G |ds| + c int x'^2 dt + [E]."""
    found = coupled(run, 9, displacement=start)
    slider, speed = slider_of(run)
    _, across = work_of_friction(run, 9, found)
    stored = energy_gained(run, found)
    expected = (
        across
        + 2.0 * found.balance["reverse_work"]
        + slider.damping * found.balance["velocity_squared_integral"]
        + stored
    )
    assert speed * mean_force_times_time(run, found) == pytest.approx(expected, rel=1e-8)
    # Time averages are not averages over distance: the dashpot's share is not small.
    assert slider.damping * found.balance["velocity_squared_integral"] > 1e-4 * abs(across)
