"""The slider's response, its spectrum, and the errors of measured motions."""

from dataclasses import replace
from itertools import pairwise
from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.distributions import Lognormal, Normal
from rubnoise.contact.pulses import LENS
from rubnoise.model import Model, Slider
from rubnoise.theory.motion import drive_of, motion_spectrum, response
from rubnoise.theory.sampling import mean_force_error, motion_errors, standard_errors
from rubnoise.theory.second_order import area_noise, autocovariance, spectral_density
from rubnoise.theory.sizes import panels
from tests.unit.theory_models import FIG5_SLIDER, excess, model_of, one_size, paper_model

Doubles = NDArray[np.float64]

SPEEDS = [10.0, 1e3, 1e5, 1e7]  # 1e-2 mm/s to 10 m/s, in um/s
DAMPING_RATIOS = [1e-6, 1e-3, 0.02, 0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 4.0, 1e3]


def slider_of(damping_ratio: float, stiffness: float = 300.0) -> Slider:
    return Slider(mass=0.005, stiffness=stiffness, damping=2.0 * damping_ratio * sqrt(0.005 * stiffness))


def free_motion(slider: Slider, time: Doubles) -> tuple[Doubles, Doubles]:
    """Return exp(-a t) cosh(r t) and exp(-a t) sinh(r t)/r with r^2 = a^2 - w_0^2, by two exponentials or a series."""
    rate = slider.damping / (2.0 * slider.mass)
    root = np.emath.sqrt(rate**2 - slider.stiffness / slider.mass)
    even = 0.5 * (np.exp((root - rate) * time) + np.exp(-(root + rate) * time))
    small = np.abs(root) * time < 1e-3
    series = time * (1.0 + (root * time) ** 2 / 6.0 * (1.0 + (root * time) ** 2 / 20.0)) * np.exp(-rate * time)
    odd = 0.5 * (np.exp((root - rate) * time) - np.exp(-(root + rate) * time)) / (root or 1.0)
    return even.real, np.where(small, series, odd).real


def stds_in_time(model: Model) -> tuple[float, float]:
    """Return both stds from R(tau) and the autocorrelation of the slider's impulse response, without any spectrum.

    int h(u) h(u + t) du = (even + a odd)/(2 c k), and minus its second derivative is (even - a odd)/(2 c m).
    """
    slider, longest = model.slider, 2.0 * model.sizes.support[1]
    rate = slider.damping / (2.0 * slider.mass)
    turns = longest / model.sliding_speed * slider.natural_angular_frequency * max(1.0, 2.0 * slider.damping_ratio)
    edges = np.union1d(
        np.linspace(0.0, longest, 2 * int(8 + min(turns, 4000.0) / 8)), longest * 2.0 ** -np.arange(40.0)
    )
    x, w = np.polynomial.legendre.leggauss(16)
    half = 0.5 * np.diff(edges)[:, None]
    lags = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * x
    even, odd = free_motion(slider, lags / model.sliding_speed)
    weighted = 2.0 * half * w / model.sliding_speed * autocovariance(model, lags) * model.strengths.moment(2)
    displacement = np.sum(weighted * (even + rate * odd)) / (2.0 * slider.damping * slider.stiffness)
    velocity = np.sum(weighted * (even - rate * odd)) / (2.0 * slider.damping * slider.mass)
    return sqrt(displacement), sqrt(velocity)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("damping_ratio", DAMPING_RATIOS)
def test_both_stds_against_the_time_domain(damping_ratio: float, speed: float) -> None:
    model = one_size(slider=slider_of(damping_ratio), speed=speed)
    found = response(model)
    assert (found.displacement_std, found.velocity_std) == pytest.approx(stds_in_time(model), rel=2e-8)


@pytest.mark.parametrize("law", [Normal(centre=5.53, std=0.2), Normal(centre=2.0, std=3.0)], ids=["narrow", "wide"])
@pytest.mark.parametrize(("damping_ratio", "speed"), [(0.02, 1e3), (1e-4, 200.0), (3.0, 1e5)])
def test_spread_sizes_against_the_time_domain(law: Normal, damping_ratio: float, speed: float) -> None:
    model = model_of(law, law.centre, slider=slider_of(damping_ratio), speed=speed)
    found = response(model)
    assert (found.displacement_std, found.velocity_std) == pytest.approx(stds_in_time(model), rel=2e-8)


def test_a_coarse_grid_would_miss_the_resonance() -> None:
    model = one_size(slider=slider_of(1e-6))
    drive = drive_of(model)
    k = np.linspace(0.0, 20.0 * drive.resonance, 10_000)
    gain = np.square(np.abs(drive.compliance(k)))
    coarse = np.trapezoid(spectral_density(model, k) * gain, k) * model.strengths.moment(2) / np.pi
    assert abs(sqrt(coarse) / response(model).displacement_std - 1.0) > 0.5


def test_a_sharp_resonance_takes_the_density_where_it_stands() -> None:
    """White noise of density S_F drives a lightly damped oscillator to Var x = S_F / (2 c k)."""
    model = one_size(slider=slider_of(1e-6))
    drive, slider = drive_of(model), model.slider
    force_density = model.strengths.moment(2) * spectral_density(model, drive.resonance) / drive.speed
    expected = sqrt(force_density / (2.0 * slider.damping * slider.stiffness))
    assert response(model).displacement_std == pytest.approx(expected, rel=1e-5)


@pytest.mark.slow
def test_both_spectra_integrate_to_the_spreads_of_figure_5() -> None:
    """Panels of a fifth of the half-width over the resonance, 5 rad/s wide, and wider ones on either side."""
    model, natural = paper_model(), FIG5_SLIDER.natural_angular_frequency
    edges = np.unique(np.concatenate([np.linspace(0.0, 2.0 * natural, 501), np.geomspace(2.0 * natural, 1e6, 1501)]))
    w, weights = panels(edges, 12)
    stds = [np.sqrt(weights @ motion_spectrum(name, model, w) / np.pi) for name in ("displacement", "velocity")]
    assert stds == pytest.approx([195.3059, 47241.1], rel=3e-6)
    motion = response(model)
    assert stds == pytest.approx([motion.displacement_std, motion.velocity_std], rel=1e-7)


@pytest.mark.parametrize("strengths", [None, Lognormal(mean=250.0, std=75.0)], ids=["equal", "unequal"])
def test_integral_and_lines_of_regular_births_are_the_variance(strengths: Lognormal | None) -> None:
    slider = replace(FIG5_SLIDER, damping=1.0)
    model = replace(paper_model(slider=slider), births=RegularBirths(mean_spacing=0.5))
    model = model if strengths is None else replace(model, strengths=strengths)
    w, weights = panels(np.concatenate([np.linspace(0.0, 600.0, 61), np.geomspace(700.0, 1e5, 80)]), 20)
    k, power = area_noise(model).lines
    lines = 2.0 * model.strengths.mean**2 * np.sum(power * np.square(np.abs(drive_of(model).compliance(k))))
    found = weights @ motion_spectrum("displacement", model, w) / np.pi + lines
    assert found == pytest.approx(response(model).displacement_std ** 2, rel=1e-7)


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
        areas = LENS.area(at[inside] * tick - births[inside], diameter)
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
        (np.sqrt(np.mean((x[settled] - mean) ** 2, axis=0)), exact.displacement_std, errors["displacement_std"]),
        (np.sqrt(np.mean(v[settled] ** 2, axis=0)), exact.velocity_std, errors["velocity_std"]),
    ):
        bias = 0.5 * error**2 / std
        assert abs(found.mean() + bias - std) <= 4.0 * error / np.sqrt(RUNS)


def test_errors_of_the_stds_of_displacement_and_velocity(runs: Runs) -> None:
    model, _, x, v = runs
    errors = motion_errors(model, distance(model))
    assert abs(excess(x.std(axis=0), errors["displacement_std"])) <= 4.0
    assert abs(excess(v.std(axis=0), errors["velocity_std"])) <= 4.0


def test_error_of_the_mean_displacement_is_a_bound_that_long_runs_reach(runs: Runs) -> None:
    model, _, x, _ = runs
    bound = motion_errors(model, distance(model))["mean_displacement"]
    assert excess(x.mean(axis=0), bound) <= 4.0
    assert x.mean(axis=0).std() > 0.75 * bound
    static = mean_force_error(model, 1e8) / SLIDER.stiffness
    assert motion_errors(model, 1e8)["mean_displacement"] == pytest.approx(static, rel=1e-3)


def test_a_quarter_of_the_error_would_be_noticed(runs: Runs) -> None:
    model, _, x, _ = runs
    errors = motion_errors(model, distance(model))
    assert excess(x.std(axis=0), 0.25 * errors["displacement_std"]) > 40.0


def test_paper_run_of_40_mm_spreads_by_three_and_a_half_percent() -> None:
    model = paper_model()
    assert motion_errors(model, 40_000.0)["displacement_std"] / response(model).displacement_std == pytest.approx(
        0.035, abs=5e-4
    )
    assert mean_force_error(model) == pytest.approx(250.0 * standard_errors(model)["mean"], rel=1e-8)
