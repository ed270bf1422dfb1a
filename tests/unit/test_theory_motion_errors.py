from dataclasses import replace
from itertools import pairwise
from math import inf, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.overlap import junction_area
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.campbell import force_cumulants
from rubnoise.theory.motion_errors import expected_mean_displacement, mean_force_error, motion_errors
from rubnoise.theory.response import response
from rubnoise.theory.sampling import standard_errors
from tests.unit.theory_models import excess, one_size, paper_model

Doubles = NDArray[np.float64]
Runs = tuple[Model, Doubles, Doubles, Doubles]

RUNS, LIVES, TICKS_A_LIFE = 400, 60, 32
SLIDER = Slider(mass=0.005, stiffness=300.0, damping=0.5)  # damping ratio 0.204: a start is forgotten within two lives


def forces(model: Model, generator: np.random.Generator) -> tuple[Doubles, float]:
    """Return friction force at ticks, a column each run, of births drawn uniformly over the run and one life before."""
    diameter = model.sizes.support[1]
    tick, ticks = 2.0 * diameter / TICKS_A_LIFE, LIVES * TICKS_A_LIFE + 1
    count = generator.poisson(model.birth_rate * 2.0 * diameter * (LIVES + 1), RUNS)
    run = np.repeat(np.arange(RUNS), count)
    births = generator.uniform(-2.0 * diameter, 2.0 * diameter * LIVES, run.size)
    first = np.ceil(births / tick).astype(int)
    force = np.zeros(ticks * RUNS)
    for step in range(TICKS_A_LIFE + 1):
        at = first + step
        inside = (at >= 0) & (at < ticks)
        areas = junction_area(at[inside] * tick - births[inside], diameter)
        force += np.bincount(at[inside] * RUNS + run[inside], areas, minlength=force.size)
    return 250.0 * force.reshape(ticks, RUNS), tick / model.sliding_speed


def ridden(slider: Slider, force: Doubles, step: float, position: float, velocity: float) -> tuple[Doubles, Doubles]:
    """Return displacement and velocity at ticks, the force linear between them, by a fourth-order Runge-Kutta step."""

    def rate(x: Doubles, v: Doubles, f: Doubles) -> tuple[Doubles, Doubles]:
        return v, (f - slider.damping * v - slider.stiffness * x) / slider.mass

    x, v = [np.full(force.shape[1], position)], [np.full(force.shape[1], velocity)]
    for now, then in pairwise(force):
        half = 0.5 * (now + then)
        a = rate(x[-1], v[-1], now)
        b = rate(x[-1] + 0.5 * step * a[0], v[-1] + 0.5 * step * a[1], half)
        c = rate(x[-1] + 0.5 * step * b[0], v[-1] + 0.5 * step * b[1], half)
        d = rate(x[-1] + step * c[0], v[-1] + step * c[1], then)
        x.append(x[-1] + step * (a[0] + 2 * b[0] + 2 * c[0] + d[0]) / 6.0)
        v.append(v[-1] + step * (a[1] + 2 * b[1] + 2 * c[1] + d[1]) / 6.0)
    return np.array(x), np.array(v)


@pytest.fixture(scope="module")
def runs() -> Runs:
    model = one_size(slider=SLIDER)
    force, step = forces(model, np.random.default_rng(21))
    still = response(model).mean_displacement
    return model, force, *ridden(SLIDER, force, step, still, 0.0)


def distance(model: Model) -> float:
    return 2.0 * model.sizes.support[1] * LIVES


def test_stds_of_drawn_runs_are_those_of_the_response(runs: Runs) -> None:
    model, _, x, v = runs
    errors, exact = motion_errors(model, distance(model)), response(model)
    # A std is a root, so its mean lies below by half the square of its error over itself; that much is added back.
    settled = slice(4 * TICKS_A_LIFE, None)
    mean = exact.mean_displacement
    for found, std, error in (
        (np.sqrt(np.mean((x[settled] - mean) ** 2, axis=0)), exact.displacement_std, errors.displacement_std),
        (np.sqrt(np.mean(v[settled] ** 2, axis=0)), exact.velocity_std, errors.velocity_std),
    ):
        bias = 0.5 * error**2 / std
        assert abs(found.mean() + bias - std) <= 4.0 * error / np.sqrt(RUNS)


def test_errors_of_the_stds_of_displacement_and_velocity(runs: Runs) -> None:
    model, _, x, v = runs
    errors = motion_errors(model, distance(model))
    assert abs(excess(x.std(axis=0), errors.displacement_std)) <= 4.0
    assert abs(excess(v.std(axis=0), errors.velocity_std)) <= 4.0


def test_error_of_the_mean_force(runs: Runs) -> None:
    model, force, *_ = runs
    assert abs(excess(force.mean(axis=0), mean_force_error(model, distance(model)))) <= 4.0


def test_error_of_the_mean_displacement_is_a_bound_that_long_runs_reach(runs: Runs) -> None:
    model, _, x, _ = runs
    bound = motion_errors(model, distance(model)).mean_displacement
    assert excess(x.mean(axis=0), bound) <= 4.0
    assert x.mean(axis=0).std() > 0.75 * bound
    static = mean_force_error(model, 1e8) / SLIDER.stiffness
    assert motion_errors(model, 1e8).mean_displacement == pytest.approx(static, rel=1e-3)


def test_a_quarter_of_the_error_would_be_noticed(runs: Runs) -> None:
    model, _, x, _ = runs
    errors = motion_errors(model, distance(model))
    assert excess(x.std(axis=0), 0.25 * errors.displacement_std) > 40.0


@pytest.mark.parametrize("damping_ratio", [0.0204, 0.9, 1.0, 7.0])
@pytest.mark.parametrize("length", [50.0, 3000.0])
def test_a_start_from_rest_lowers_the_mean_displacement(damping_ratio: float, length: float) -> None:
    slider = Slider(mass=0.005, stiffness=300.0, damping=2.0 * damping_ratio * sqrt(1.5), start="rest")
    model = one_size(slider=slider)
    ticks = 4001
    force = np.full((ticks, 1), force_cumulants(model).mean)
    x, _ = ridden(slider, force, length / model.sliding_speed / (ticks - 1), 0.0, 0.0)
    found = np.trapezoid(x[:, 0]) / (ticks - 1)
    assert expected_mean_displacement(model, length) == pytest.approx(found, rel=1e-4)
    at_equilibrium = replace(model, slider=replace(slider, start="equilibrium"))
    assert expected_mean_displacement(at_equilibrium, length) == response(model).mean_displacement


def test_paper_run_of_40_mm_spreads_by_three_and_a_half_percent() -> None:
    model = paper_model()
    assert motion_errors(model, 40_000.0).displacement_std / response(model).displacement_std == pytest.approx(
        0.035, abs=5e-4
    )
    assert mean_force_error(model) == pytest.approx(250.0 * standard_errors(model).mean, rel=1e-8)


def test_nothing_is_stationary_without_damping() -> None:
    found = motion_errors(paper_model(slider=replace(SLIDER, damping=0.0)), 1e4)
    assert (found.mean_displacement, found.displacement_std, found.velocity_std) == (inf, inf, inf)


def test_a_force_needs_a_strength() -> None:
    with pytest.raises(Refused, match="strength"):
        mean_force_error(replace(paper_model(), strengths=None))
