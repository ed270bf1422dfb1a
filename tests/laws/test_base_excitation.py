"""Asperities that lift the slider, as it runs: its motion, moments and spectrum, and what has no run."""

import itertools
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rubnoise
from rubnoise.analysis.moments import WORTH_A_WARNING
from rubnoise.arrays import Doubles
from rubnoise.figures.tracks import Stretch
from rubnoise.model import Model
from rubnoise.pages.report import in_words
from rubnoise.scenario import Scenario
from rubnoise.simulation import draws
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.motion import motion_spectrum, response
from tests.models import contents, recorded
from tests.shell.terminal import call

FILE = Path(__file__).parents[2] / "scenarios" / "ancestors" / "rice_moslehy.toml"
OVER_SPEED = {"one_way_validity": 0.26}
MANY = ["interface.mean_junction_count=20", "interface.mean_real_contact_area=200 um^2", "slider.heights=sum"]


def base(*changes: str) -> Scenario:
    return rubnoise.load(FILE, changes)


def test_the_motion_over_a_base_is_a_lift_and_no_sliding() -> None:
    """Nothing holds the separation, and the speed of sliding is no measure of a velocity normal to it."""
    changes = [word for change in MANY for word in ("--set", change)]
    told = " ".join(call("check", FILE, *changes).out.split())
    told += " ".join(call("theory", FILE, *changes).out.split())
    told += " ".join(in_words(Stretch.of(rubnoise.simulate(base(*MANY)).reader()), OVER_SPEED))
    assert "regime lifted by a base" in told
    assert "it moves normal to the surfaces" in told
    for wrong in ("held", "one way validity", "sliding speed)", "spreads by"):
        assert wrong not in told
    assert response(base(*MANY).model()).one_way_validity > WORTH_A_WARNING


def integrated(model: Model, junctions: Any, time: Doubles, start: tuple[float, float]) -> Doubles:
    """Return x and x' at times by a general integrator, from one kink of the base to the next."""
    slider, speed = model.slider, model.sliding_speed
    assert slider is not None
    assert speed is not None
    birth, diameter = junctions["birth_distance"][:], junctions["diameter"][:]
    slope = slider.asperity_height * np.ones_like(diameter)
    kinks = np.unique(np.concatenate([birth, birth + diameter, birth + 2.0 * diameter])) / speed
    edges = np.concatenate([[0.0], kinks[(kinks > 0.0) & (kinks < time[-1])], [time[-1]]])
    found, state = np.empty((2, time.size)), np.array(start)
    found[:, 0] = state
    for begin, end in itertools.pairwise(edges):
        middle = 0.5 * (begin + end) * speed
        age = middle - birth
        live = (age > 0.0) & (age < 2.0 * diameter)
        rate = (slope * np.where(age < diameter, 1.0, -1.0))[live].sum() * speed
        height = (slope * np.minimum(age, 2.0 * diameter - age))[live].sum()

        def moved(t: float, y: Doubles, rate: float = rate, height: float = height, middle: float = middle) -> Any:
            lifted = height + rate * (t - middle / speed)
            pull = slider.stiffness * (lifted - y[0]) + slider.damping * (rate - y[1])
            return [y[1], pull / slider.mass]

        inside = (time > begin) & (time <= end)
        solved = solve_ivp(
            moved, (begin, end), state, "DOP853", np.unique([*time[inside], end]), rtol=1e-13, atol=1e-17, max_step=1e-3
        )
        found[:, inside], state = solved.y[:, : inside.sum()], solved.y[:, -1]
    return found


@pytest.mark.parametrize(
    "changes",
    [
        [],
        ["slider.start=rest", "sliding.start=empty"],
        ["slider.damping=1 N*s/m", *MANY],
        ["slider.damping=1 N*s/m", "slider.mass=0.1 g", "output.tick=0.7 um"],
    ],
)
def test_the_motion_is_that_of_an_integrator(changes: list[str]) -> None:
    made = base(*changes, "sliding.distance=60 um")
    run = rubnoise.simulate(made)
    seen = np.array([run.slider["displacement"][:], run.slider["velocity"][:]])
    assert abs(seen[1, 0]) <= 1e-12 * np.abs(seen[1]).max()
    wanted = integrated(made.model(), run.junctions, run.slider["time"][:], (seen[0, 0], 0.0))
    assert (np.abs(seen - wanted).max(axis=1) <= 1e-9 * np.abs(wanted).max(axis=1)).all()
    one_half = made.model().slider
    assert one_half is not None
    halved = replace(made.model(), slider=replace(one_half, damping=0.5 * one_half.damping))
    other = integrated(halved, run.junctions, run.slider["time"][:], (seen[0, 0], 0.0))
    assert (np.abs(seen - other).max(axis=1) > 1e-3 * np.abs(wanted).max(axis=1)).all()


@pytest.mark.slow
@pytest.mark.parametrize("changes", [MANY, ["slider.damping=1 N*s/m", "slider.mass=0.1 g", *MANY]])
def test_both_engines_have_the_same_bits_in_blocks(
    changes: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = base(*changes, "sliding.distance=2 mm")
    monkeypatch.setattr(draws, "BLOCK", 1000)
    by_events, at_once = (contents(recorded(made.model(), 3, engine=engine)) for engine in ("events", "batch"))
    assert by_events == at_once
    rubnoise.run(made, tmp_path / "x.h5").close()
    assert call("verify", str(tmp_path / "x.h5")).code == 0


@pytest.mark.slow
@pytest.mark.parametrize("changes", [[], MANY])
def test_100_runs_have_the_exact_moments_and_spectrum(changes: list[str]) -> None:
    made = base(*changes, "sliding.distance=4 mm", "output.tick=1 um")
    model = made.model()
    theory, area = response(model), area_cumulants(model)
    base_mean, base_std = model.base_per_area * area.mean, model.base_per_area * area.std
    assert theory.mean_displacement == pytest.approx(base_mean, rel=1e-12)
    slider = model.slider
    assert slider is not None
    later = 1500  # ticks of 1 ms: the start, which decays at 5 1/s, has fallen to e^-7.5 of its size
    runs = [recorded(model, seed, engine="batch")["slider"] for seed in range(100)]
    place = np.array([each["displacement"][later:] for each in runs])
    speed = np.array([each["velocity"][later:] for each in runs])
    height = np.array([each["base_displacement"] for each in runs])

    def z(samples: Doubles, expected: float) -> float:
        return float((samples.mean() - expected) / (samples.std(ddof=1) / sqrt(samples.size)))

    squares = np.square(place - theory.mean_displacement).mean(axis=1)
    assert abs(z(height.mean(axis=1), base_mean)) <= 4.0
    assert abs(z(np.square(height - base_mean).mean(axis=1), base_std**2)) <= 4.0
    assert abs(z(place.mean(axis=1), theory.mean_displacement)) <= 4.0
    assert abs(z(squares, theory.displacement_std**2)) <= 4.0
    assert abs(z(np.square(speed).mean(axis=1), theory.velocity_std**2)) <= 4.0
    # The control: at half the damping the variance of x is twice as large.
    quiet = response(replace(model, slider=replace(slider, damping=0.5 * slider.damping)))
    assert abs(z(squares, quiet.displacement_std**2)) > 4.0

    count = place.shape[1]
    window = np.hanning(count)
    waves = np.fft.rfft(window * (place - theory.mean_displacement), axis=1)
    step = model.tick / 1000.0
    density = step * np.square(np.abs(waves)) / np.square(window).sum()
    angular = 2.0 * np.pi * np.fft.rfftfreq(count, step)
    for hertz in (10.0, 60.0, 90.0):
        near = np.abs(angular / (2.0 * np.pi) - hertz) < 2.0
        expected = float(motion_spectrum("displacement", model, angular[near]).mean())
        assert abs(z(density[:, near].mean(axis=1), expected)) <= 4.0
        assert abs(z(density[:, near].mean(axis=1), 1.5 * expected)) > 4.0
