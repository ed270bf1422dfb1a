"""Runs under a load that weighs: against an integrator of the tests' own, theory, and faults that show."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import log, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rubnoise
from rubnoise.analysis.figures import summarise
from rubnoise.analysis.measured import Measured
from rubnoise.analysis.moments import forgetting
from rubnoise.analysis.spectra import heard_bands
from rubnoise.contact.distributions import Lognormal
from rubnoise.model import Model, Slider
from rubnoise.record.rows import MemoryRecord
from rubnoise.simulation import draws, run
from rubnoise.simulation import linear as engine
from rubnoise.simulation.run import simulate
from rubnoise.theory.coupling import THIRD, level, load_motion
from rubnoise.theory.sampling import load_errors
from tests.laws.scores import BOUND, REJECTED, seed_of
from tests.models import contents, loaded, recorded
from tests.unit.tampering import change, scenario_of

UNEQUAL = Lognormal(mean=250.0, std=100.0)
SHORT = {"distance": 60.0, "tick": 0.05}
KINDS = {
    "one strength": loaded(**SHORT),
    "unequal strengths": loaded(**SHORT, strength=UNEQUAL),
    "whole ticks": loaded(distance=60.0, tick=0.02, height=2.0, strength=UNEQUAL, ratio=0.3),
    "over-damped": loaded(**SHORT, ratio=3.0),
    "the slider's own frequency": loaded(**SHORT, height=2e5 / 300.0),
    "fast": loaded(**SHORT, relative_speed=10.0),
    "neither slider nor strength": loaded(**SHORT, slider=None, strength=None),
}


def integrated(model: Model, record: MemoryRecord) -> np.ndarray[Any, Any]:
    """Return x, x', z, z' at the ticks by DOP853 from the rows of /junctions, anew at every birth, death and tick."""
    held, slider, speed = model.separation, model.slider, model.sliding_speed or 0.0
    assert held is not None
    rows = record["junctions"]
    birth, d = rows["birth_distance"], rows["diameter"]
    psi = rows.get("shear_strength", np.zeros(birth.size))
    mean = model.strengths.mean if model.strengths else 0.0
    ticks, death = record["trace"]["distance"], birth + 2.0 * d

    def moves(t: float, y: Any, live: Any) -> list[float]:
        s = speed * t
        area = np.pi / 4.0 * (d[live] ** 2 - (s - birth[live] - d[live]) ** 2)
        pressed = held.load * (area.sum() / model.mean_real_contact_area - y[2] / held.height_scale)
        force = float(psi[live] @ area) - mean * model.mean_real_contact_area * y[2] / held.height_scale
        pushed = 0.0 if slider is None else (force - slider.stiffness * y[0] - slider.damping * y[1]) / slider.mass
        return [y[1], pushed, y[3], (pressed - held.load - held.damping * y[3]) / held.mass]

    inside = [event for event in (*birth, *death) if 0.0 < event < ticks[-1]]
    y = np.array([model.equilibrium_displacement, 0.0, 0.0, 0.0])
    at_ticks, next_tick = [y], 1
    for begin, end in pairwise(np.unique([*ticks, *inside])):
        live = np.flatnonzero((birth <= begin) & (begin < death))
        span = (begin / speed, end / speed)
        y = solve_ivp(moves, span, y, "DOP853", args=(live,), rtol=1e-13, atol=1e-14).y[:, -1]
        if end == ticks[next_tick]:
            at_ticks.append(y)
            next_tick += 1
    return np.array(at_ticks).T


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_motion_is_that_of_another_integrator(name: str) -> None:
    model = KINDS[name]
    record = recorded(model, seed=3)
    right = integrated(model, record)
    columns = [] if model.slider is None else [("slider", "displacement", 0), ("slider", "velocity", 1)]
    columns += [("load", "separation", 2), ("load", "velocity", 3)]
    for group, column, n in columns:
        largest = np.abs(right[n]).max()
        assert np.abs(record[group][column] - right[n]).max() < 1e-9 * largest, column


@pytest.mark.parametrize("name", KINDS)
def test_both_engines_give_equal_bits_in_blocks(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model = replace(KINDS[name], distance=900.0, tick=0.3, tick_count=3000)
    monkeypatch.setattr(draws, "BLOCK", 1000)
    by_events, at_once = (contents(recorded(model, seed=4, engine=played)) for played in ("events", "batch"))
    assert by_events == at_once


def test_columns_are_what_they_say() -> None:
    model = loaded(**SHORT, count=1.5)
    record = recorded(model, seed=5)
    held, trace, load = model.separation, record["trace"], record["load"]
    assert held is not None
    area, live = trace["real_contact_area"], trace["junction_count"]
    pressed = held.load * (area / model.mean_real_contact_area - load["separation"] / held.height_scale)
    assert np.allclose(load["load"], pressed, rtol=1e-12, atol=1e-9 * held.load)
    assert np.allclose(trace["friction_force"], 0.25 * load["load"], rtol=1e-12, atol=1e-9 * held.load)
    assert np.array_equal(trace["friction_force"], record["slider"]["friction_force"])
    alive = live > 0
    assert not alive.all()
    square = model.sizes.moment(2)
    overlap = 4.0 * held.height_scale * area[alive] / (np.pi * square * live[alive])
    assert np.allclose(load["live_overlap"][alive], overlap, rtol=1e-12)
    assert np.isnan(load["live_overlap"][~alive]).all()
    assert (load["separation"][0], load["velocity"][0]) == (0.0, 0.0)


# Runs beside theory, in standard errors that it gives them; every fault is seen.
STIFF = Slider(mass=5e-3, stiffness=3e5, damping=8.0)
LONG: dict[str, Any] = {"distance": 20_000.0, "tick": 0.1, "relative_speed": 0.5, "ratio": 0.3, "slider": STIFF}


def scores(model: Model, name: str) -> dict[str, float]:
    """Return how far a run is from theory, in standard errors."""
    seen = Measured(model)
    simulate(model, seed_of(name), seen, engine="batch")
    return {figure.name: figure.z for figure in summarise(seen) if figure.z is not None}


@pytest.mark.slow
@pytest.mark.parametrize("v", [0.15, 0.5, 2.0])
@pytest.mark.parametrize("ratio", [0.05, 0.3])
@pytest.mark.parametrize("strength", [250.0, UNEQUAL])
def test_spreads_are_those_of_theory(v: float, ratio: float, strength: Any) -> None:
    found = scores(loaded(**LONG | {"relative_speed": v, "ratio": ratio}, strength=strength), f"load {v} {ratio}")
    assert {"separation_std", "normal_velocity_std", "load_std", "friction_force_std", "displacement_std"} <= set(found)
    assert {name: z for name, z in found.items() if abs(z) > BOUND} == {}


def upside_down(model: Model) -> Any:
    """P - W has the wrong sign: the slider falls where many junctions meet."""
    right = engine.slider_constants(model)
    assert right is not None
    gains = right.gains.copy()
    gains[:2] *= -1.0
    return replace(right, gains=gains)


def undamped(model: Model) -> Any:
    """The damping is left out of the motion."""
    held = model.separation
    assert held is not None
    return engine.slider_constants(replace(model, separation=replace(held, damping=1e-3 * held.damping)))


@pytest.mark.slow
def test_faults_of_the_motion_are_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    model = loaded(**LONG)
    assert all(abs(z) <= BOUND for z in scores(model, "load, right").values())
    for fault in (upside_down, undamped):
        with monkeypatch.context() as patch:
            patch.setattr(run, "slider_constants", fault)
            found = scores(model, "load, right")
        assert max(abs(found[name]) for name in ("separation_std", "load_std", "normal_velocity_std")) > REJECTED


# The file.
@pytest.fixture
def result(tmp_path: Path) -> Path:
    scenario = scenario_of(
        "diameter",
        interface={"mean_real_contact_area": None, "load": "0.2 N", "hardness": "1 GPa"},
        load={"height_scale": "0.5 um", "mass": "5 g", "damping_ratio": 0.05},
        sliding={"distance": "1500 um"},
        output={"tick": "0.05 um"},
    )
    rubnoise.run(scenario, tmp_path / "x.h5", seed=2).close()
    return tmp_path / "x.h5"


FAULTS: dict[str, tuple[str, Callable[[Any], Any], str]] = {
    "W - P for P - W": ("load/load", lambda load: 4e5 - load, "load"),
    "the slider falls where it should rise": ("load/separation", lambda z: -z, "load"),
    "the force is not that of the load": ("trace/friction_force", lambda force: 1.001 * force, "friction_force"),
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_compare_and_verify_see_faults_of_the_columns(result: Path, fault: str) -> None:
    column, by, seen = FAULTS[fault]
    with rubnoise.open(result) as file:
        assert file.compare().outside == ()
        assert file.verify().different == []
    change(result, column, by)
    with rubnoise.open(result) as file:
        assert seen in file.compare().outside
        assert column.split("/")[0] in {check.name for check in file.verify().different}


def test_errors_are_what_runs_scatter_by() -> None:
    model = loaded(**LONG | {"distance": 3000.0})
    first = forgetting(model)["load"]
    errors, motion = load_errors(model, model.distance - first * model.tick), load_motion(model)
    runs = []
    for n in range(64):
        seen = Measured(model)
        simulate(model, seed_of(f"scatter {n}"), seen, engine="batch")
        runs.append([seen.moments["load", name].std for name in ("separation", "velocity", "load")])
    scatter = np.std(np.array(runs), axis=0, ddof=1)
    known = np.array([errors["separation_std"], errors["velocity_std"], errors["load_std"]])
    # The scatter of 64 runs is itself uncertain by 1/sqrt(2 * 63) = 9 %.
    assert np.all(np.abs(scatter / known - 1.0) < BOUND / sqrt(2.0 * 63.0))
    assert motion.separation_std == pytest.approx(np.mean(runs, axis=0)[0], abs=BOUND * known[0] / 8.0)


def test_third_octaves_of_a_run_are_those_of_theory(result: Path) -> None:
    with rubnoise.open(result) as file:
        heard, motion = heard_bands(file.reader(), file.model()).columns, load_motion(file.model())
        std = next(figure.value for figure in file.summary if figure.name == "normal_velocity_std")
    assert heard["frequency"].size > 10
    # The power of a band of width B over a time T scatters by 1/sqrt(B T), 10/ln(10) dB for each part of it.
    bound = BOUND * 10.0 / log(10.0) / np.sqrt(1.5 * heard["frequency"] * (THIRD - 1.0 / THIRD))
    assert np.all(np.abs(heard["level"] - heard["exact"]) < bound)
    assert not np.all(np.abs(heard["level"] + 1.0 - heard["exact"]) < bound)
    assert level(std) == pytest.approx(motion.velocity_level, abs=1.0)
