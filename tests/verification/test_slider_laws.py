"""The slider under triangles, regular births and unequal strengths, against references that share no line with it."""

import math
from typing import Any

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.model import Model, Slider
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation.cells import cells_per_tick, narrow
from rubnoise.simulation.kernels import triangle
from tests.models import FIG5_SLIDER, UNEQUAL, recorded
from tests.models import model as figure_5
from tests.oracle import dop853_slider, straight_slider, theta_slider
from tests.oracle.oscillator import Motion, Oscillator
from tests.verification.seeds import seed_of
from tests.verification.test_interrupts import ends
from tests.verification.test_slider_oracle import PROMISED, difference, rows_of

CRITICAL = 2.0 * math.sqrt(FIG5_SLIDER.mass * FIG5_SLIDER.stiffness)
DAMPING_RATIOS = {"figure 5": 0.05 / CRITICAL, "critical": 1.0, "over-damped": 20.0}
ONE_SIZE = Spread()


def model(ratio: float = 0.05 / CRITICAL, **changes: Any) -> Model:
    """Return Fig. 5 with triangles, a damping ratio and other changes."""
    slider = Slider(mass=FIG5_SLIDER.mass, stiffness=FIG5_SLIDER.stiffness, damping=ratio * CRITICAL)
    return figure_5(**{"pulse": TRIANGLE, "slider": slider} | changes)


def reference(run: Model, record: MemoryRecord) -> Motion:
    """Return the reference's motion at every tick of a record."""
    assert run.slider is not None
    slider = Oscillator(mass=run.slider.mass, stiffness=run.slider.stiffness, damping=run.slider.damping)
    oracle: Any = straight_slider if run.pulse is TRIANGLE else theta_slider
    start = (run.equilibrium_displacement, 0.0)
    motion: Motion = oracle.motion(slider, run.sliding_speed, record["slider"]["distance"], rows_of(record), start)
    return motion


@pytest.mark.parametrize("speed", [1e2, 1e3, 1e5, 1e7])
@pytest.mark.parametrize("name", DAMPING_RATIOS)
def test_the_promise_holds_for_triangles_at_every_speed_and_damping(name: str, speed: float) -> None:
    run = model(DAMPING_RATIOS[name], speed=speed, distance=12.0, tick=0.05)
    record = recorded(run, seed_of("triangle speeds"))
    assert difference(record, reference(run, record)) < PROMISED


@pytest.mark.parametrize(
    "run",
    [
        model(count=0.5, distance=200.0, tick=0.5, speed=100.0),
        model(count=200.0, distance=3.0, tick=0.02, speed=100.0),
        model(count=5.0, distance=30.0, tick=1.0, speed=300.0),
        model(1.0, distance=6.0, tick=0.2, speed=10.0),
        model(births="regular", count=3.0, spread=ONE_SIZE, distance=30.0, tick=0.05),
        model(births="regular", count=2.5, spread=ONE_SIZE, distance=30.0, tick=0.25),
        model(1.0, births="regular", count=21.0, spread=ONE_SIZE, distance=6.0, tick=0.05),
        model(20.0, births="regular", count=21.0, spread=ONE_SIZE, distance=6.0, tick=0.05, speed=1e4),
        model(1.0, births="regular", count=20.0, distance=6.0, tick=0.05, speed=100.0),
        model(1.0, births="regular", count=20.0, spread=ONE_SIZE, distance=6.0, tick=0.05, pulse=LENS),
        model(0.02, births="regular", count=9.0, spread=ONE_SIZE, distance=6.0, tick=0.1, pulse=LENS, speed=100.0),
        model(strength=UNEQUAL, distance=20.0, tick=0.1),
        model(strength=UNEQUAL, distance=20.0, tick=0.1, pulse=LENS),
        model(strength=UNEQUAL, births="regular", spread=ONE_SIZE, distance=20.0, tick=0.1),
    ],
    ids=[
        "few", "many", "long ticks", "follows the force", "three regular", "two and a half regular",
        "odd regular, critical", "odd regular, over-damped", "regular of some sizes", "regular lenses",
        "nine regular lenses", "unequal", "unequal lenses", "Rabinowicz with his fluctuation",
    ],
)  # fmt: skip
def test_the_promise_holds_for_other_laws(run: Model) -> None:
    record = recorded(run, seed_of("laws"))
    assert difference(record, reference(run, record)) < PROMISED


def test_an_adaptive_integrator_agrees() -> None:
    run = model(births="regular", strength=UNEQUAL, distance=20.0, tick=0.25)
    record = recorded(run, seed_of("dop853 triangles"))
    assert run.slider is not None
    slider = Oscillator(mass=run.slider.mass, stiffness=run.slider.stiffness, damping=run.slider.damping)
    start = (run.equilibrium_displacement, 0.0)
    ticks, rows = record["slider"]["distance"], rows_of(record)
    stepped = dop853_slider.motion(slider, 1000.0, ticks, rows, start, dop853_slider.triangle_areas)
    assert difference(record, stepped) < PROMISED


@pytest.mark.parametrize("speed", [1000.0, 20.0])
def test_triangles_that_end_early_act_until_then(speed: float) -> None:
    run = model(distance=30.0, tick=0.1, speed=speed)
    assert narrow(run, cells_per_tick(run)) == (speed < 1000.0)
    seed = seed_of("triangles end early")
    rows = rows_of(recorded(run, seed))
    places = {12: 1.93, 30: 0.31, 40: 1.4, 41: 0.02, 42: 1.0}
    when = {n: float(rows.birth[n] + share * rows.diameter[n]) for n, share in places.items()}
    when = {n: place for n, place in when.items() if place > 0.0}
    record = recorded(run, seed, intervene=ends(when))
    assert np.sum(record["junctions"]["state"] & 4 > 0) >= 3
    assert difference(record, reference(run, record)) < PROMISED
    assert difference(record, reference(run, recorded(run, seed))) > 1e-3


def test_a_kernel_that_passes_over_the_kinks_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    run = model(distance=20.0, tick=0.5, count=5.0)
    seed = seed_of("triangle kinks")
    for name in ("deposit_moments", "_add_kinks"):
        monkeypatch.setattr(triangle, name, getattr(triangle, name).py_func)
    record = recorded(run, seed)
    assert difference(record, reference(run, record)) < PROMISED
    monkeypatch.setattr(triangle, "add_kink", lambda *_: None)
    assert difference(recorded(run, seed), reference(run, record)) > 1e-4


def test_lenses_in_place_of_triangles_are_seen() -> None:
    run = model(distance=20.0, tick=0.1)
    record = recorded(run, seed_of("which pulse"))
    start, slider = (run.equilibrium_displacement, 0.0), Oscillator(mass=0.005, stiffness=300.0, damping=0.05)
    lenses = theta_slider.motion(slider, 1000.0, record["slider"]["distance"], rows_of(record), start)
    assert difference(record, lenses) > 1e-3


def test_ticks_are_divided_finer_where_the_force_hardly_varies() -> None:
    """The velocity's error counts beside the largest velocity, which regular births of one size make small."""
    laws: list[dict[str, Any]] = [{}, {"births": "regular"}, {"births": "regular", "spread": ONE_SIZE}]
    cells = [cells_per_tick(model(1.0, distance=6.0, tick=0.1, speed=100.0, count=51.0, **law)) for law in laws]
    assert cells[0] <= cells[1] < cells[2]
    lone = [cells_per_tick(model(1.0, distance=6.0, tick=0.1, speed=100.0, count=0.5, **law)) for law in laws]
    assert lone[0] == lone[2]
