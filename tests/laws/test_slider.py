"""The slider of whole runs against references that share no line with it."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.model import Model, Slider
from rubnoise.record.rows import MemoryRecord
from tests.laws.scores import seed_of
from tests.laws.test_observer import ends
from tests.models import FIG5_SLIDER, UNEQUAL, model, recorded
from tests.models import model as figure_5
from tests.oracle import sliders
from tests.oracle.sliders import Motion, Oscillator, stepped_motion, straight_motion, theta_motion
from tests.oracle.slow_contact import Rows

# The slider of whole runs against two references that share no line with it: theta substitution and DOP853.
MASS, STIFFNESS = FIG5_SLIDER.mass, FIG5_SLIDER.stiffness
CRITICAL = 2.0 * math.sqrt(MASS * STIFFNESS)
DAMPING_RATIOS = {"figure 5": 0.05 / CRITICAL, "nearly undamped": 1e-3, "critical": 1.0, "over-damped": 20.0}

SPEEDS = {
    "0.01 mm/s": 10.0,
    "0.1 mm/s": 1e2,
    "1 mm/s": 1e3,
    "10 mm/s": 1e4,
    "0.1 m/s": 1e5,
    "1 m/s": 1e6,
    "10 m/s": 1e7,
}
PROMISED = 1e-9


def sliding(ratio: float, start: Any = "equilibrium", **changes: Any) -> Model:
    """Return Fig. 5 with a damping ratio, a start of the slider and other changes."""
    slider = Slider(mass=MASS, stiffness=STIFFNESS, damping=ratio * CRITICAL, start=start)
    return model(slider=slider, **changes)


def rows_of(record: MemoryRecord) -> Rows:
    columns = record["junctions"]
    return Rows(
        birth=columns["birth_distance"],
        diameter=columns["diameter"],
        strength=columns["shear_strength"],
        death=columns["death_distance"],
    )


def reference(run: Model, record: MemoryRecord, motion_of: Any = theta_motion, every: int = 1) -> Motion:
    """Return the reference's motion at every n-th tick of a record."""
    assert run.slider is not None
    slider = Oscillator(mass=run.slider.mass, stiffness=run.slider.stiffness, damping=run.slider.damping)
    ticks = record["slider"]["distance"][::every]
    start = (run.equilibrium_displacement, 0.0)
    motion: Motion = motion_of(slider, run.sliding_speed, ticks, rows_of(record), start)
    return motion


def difference(record: MemoryRecord, motion: Motion, every: int = 1) -> float:
    """Return the largest difference of displacement or velocity, each relative to its largest value."""
    place, speed = (record["slider"][name][::every] for name in ("displacement", "velocity"))
    return max(relative(place, motion.displacement), relative(speed, motion.velocity))


def relative(found: NDArray[np.float64], true: NDArray[np.float64]) -> float:
    return float(np.abs(found - true).max() / np.abs(true).max())


@pytest.mark.slow
@pytest.mark.parametrize("name", DAMPING_RATIOS)
def test_an_adaptive_integrator_agrees(name: str) -> None:
    run = sliding(DAMPING_RATIOS[name], distance=40.0, tick=0.05)
    record = recorded(run, seed_of("dop853"))
    bound = 1e-10 if name == "figure 5" else PROMISED
    assert difference(record, reference(run, record, stepped_motion, every=40), every=40) < bound


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("name", DAMPING_RATIOS)
def test_the_promise_holds_for_every_speed_and_damping(name: str, speed: str) -> None:
    run = sliding(DAMPING_RATIOS[name], speed=SPEEDS[speed], distance=16.0, tick=0.05)
    record = recorded(run, seed_of("speeds"))
    assert difference(record, reference(run, record)) < PROMISED


def test_junctions_that_end_early_act_until_then() -> None:
    run = sliding(DAMPING_RATIOS["figure 5"], distance=60.0, tick=0.1)
    seed = seed_of("ends early")
    rows = rows_of(recorded(run, seed))
    places = {5: 1.93, 30: 0.31, 40: 1.4, 41: 0.02, 42: 1.0}
    when = {number: rows.birth[number] + share * rows.diameter[number] for number, share in places.items()}
    when = {number: float(place) for number, place in when.items() if place > 0.0}
    record = recorded(run, seed, intervene=ends(when))
    assert difference(record, reference(run, record)) < 1e-10
    assert difference(record, reference(run, recorded(run, seed))) > 1e-3


def test_a_first_order_hold_would_be_worse_than_1e_6() -> None:
    """What scipy's lsim does: the force taken as straight between ticks, carried by the exact transition."""
    from scipy.signal import lsim

    run = sliding(DAMPING_RATIOS["figure 5"], distance=100.0, tick=0.05)
    record = recorded(run, seed_of("hold"))
    system = ([[0.0, 1.0], [-STIFFNESS / MASS, -0.05 / MASS]], [[0.0], [1.0 / MASS]], np.eye(2), np.zeros((2, 1)))
    slider = record["slider"]
    start = [slider["displacement"][0], slider["velocity"][0]]
    held = lsim(system, slider["friction_force"], slider["time"], X0=start)[1]
    true = reference(run, record)
    assert relative(held[:, 0], true.displacement) > 1e-6
    assert difference(record, true) < 1e-10


def test_a_missing_kink_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reference without mid-life in its list of breaks: the smallest form of the fault."""
    run = sliding(DAMPING_RATIOS["figure 5"], distance=30.0, tick=0.1)
    record = recorded(run, seed_of("kink"))
    cut = sliders.pieces

    def without_mid_life(rows: Rows, row: int, ticks: NDArray[np.float64]) -> NDArray[np.float64]:
        cuts = cut(rows, row, ticks)
        return cuts[cuts != rows.birth[row] + rows.diameter[row]]

    monkeypatch.setattr(sliders, "pieces", without_mid_life)
    assert difference(record, reference(run, record)) > 1e-7


# The slider under triangles, regular births and unequal strengths, against references that share no line with it.
CRITICAL_OF_FIG5 = 2.0 * math.sqrt(FIG5_SLIDER.mass * FIG5_SLIDER.stiffness)
FEW_RATIOS = {"figure 5": 0.05 / CRITICAL_OF_FIG5, "critical": 1.0, "over-damped": 20.0}
ONE_SIZE = Spread()


def slider_run(ratio: float = 0.05 / CRITICAL_OF_FIG5, **changes: Any) -> Model:
    """Return Fig. 5 with triangles, a damping ratio and other changes."""
    slider = Slider(mass=FIG5_SLIDER.mass, stiffness=FIG5_SLIDER.stiffness, damping=ratio * CRITICAL_OF_FIG5)
    return figure_5(**{"pulse": TRIANGLE, "slider": slider} | changes)


def straight_reference(run: Model, record: MemoryRecord) -> Motion:
    """Return the reference's motion at every tick of a record."""
    return reference(run, record, straight_motion if run.pulse is TRIANGLE else theta_motion)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [1e2, 1e3, 1e5, 1e7])
@pytest.mark.parametrize("name", FEW_RATIOS)
def test_the_promise_holds_for_triangles_at_every_speed_and_damping(name: str, speed: float) -> None:
    run = slider_run(FEW_RATIOS[name], speed=speed, distance=12.0, tick=0.05)
    record = recorded(run, seed_of("triangle speeds"))
    assert difference(record, straight_reference(run, record)) < PROMISED


@pytest.mark.slow("many", "odd regular, over-damped", "Rabinowicz with his fluctuation")
@pytest.mark.parametrize(
    "run",
    [
        slider_run(count=0.5, distance=200.0, tick=0.5, speed=100.0),
        slider_run(count=200.0, distance=3.0, tick=0.02, speed=100.0),
        slider_run(count=5.0, distance=30.0, tick=1.0, speed=300.0),
        slider_run(1.0, distance=6.0, tick=0.2, speed=10.0),
        slider_run(births="regular", count=3.0, spread=ONE_SIZE, distance=30.0, tick=0.05),
        slider_run(births="regular", count=2.5, spread=ONE_SIZE, distance=30.0, tick=0.25),
        slider_run(1.0, births="regular", count=21.0, spread=ONE_SIZE, distance=6.0, tick=0.05),
        slider_run(20.0, births="regular", count=21.0, spread=ONE_SIZE, distance=6.0, tick=0.05, speed=1e4),
        slider_run(1.0, births="regular", count=20.0, distance=6.0, tick=0.05, speed=100.0),
        slider_run(0.02, births="regular", count=9.0, spread=ONE_SIZE, distance=6.0, tick=0.1, pulse=LENS, speed=100.0),
        slider_run(strength=UNEQUAL, distance=20.0, tick=0.1),
        slider_run(strength=UNEQUAL, distance=20.0, tick=0.1, pulse=LENS),
        slider_run(strength=UNEQUAL, births="regular", spread=ONE_SIZE, distance=20.0, tick=0.1),
    ],
    ids=[
        "few", "many", "long ticks", "follows the force", "three regular", "two and a half regular",
        "odd regular, critical", "odd regular, over-damped", "regular of some sizes",
        "nine regular lenses", "unequal", "unequal lenses", "Rabinowicz with his fluctuation",
    ],
)  # fmt: skip
def test_the_promise_holds_for_other_laws(run: Model) -> None:
    record = recorded(run, seed_of("laws"))
    assert difference(record, straight_reference(run, record)) < PROMISED


def test_a_nearly_constant_force_is_right_to_1e_9_of_itself() -> None:
    """Regular lenses of one size hardly move the slider: its velocity is small beside that of any other run."""
    run = slider_run(1.0, births="regular", count=20.0, spread=ONE_SIZE, distance=6.0, tick=0.05, pulse=LENS)
    record = recorded(run, seed_of("laws"))
    motion, found = straight_reference(run, record), record["slider"]
    assert run.slider is not None
    largest = float(np.abs(motion.displacement).max())
    assert np.abs(found["displacement"] - motion.displacement).max() < PROMISED * largest
    swing = run.slider.natural_angular_frequency * largest
    assert np.abs(found["velocity"] - motion.velocity).max() < PROMISED * swing
    assert np.abs(motion.velocity).max() < 1e-3 * swing


def test_lenses_in_place_of_triangles_are_seen() -> None:
    run = slider_run(distance=20.0, tick=0.1)
    record = recorded(run, seed_of("which pulse"))
    start, slider = (run.equilibrium_displacement, 0.0), Oscillator(mass=0.005, stiffness=300.0, damping=0.05)
    lenses = theta_motion(slider, 1000.0, record["slider"]["distance"], rows_of(record), start)
    assert difference(record, lenses) > 1e-3
