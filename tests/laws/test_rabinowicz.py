"""Numbers known from elsewhere: Rabinowicz's constant area, and theory to 20 or 30 digits."""

from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.special import struve

import rubnoise
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.simulation.draws import births_per_block, start
from rubnoise.theory.sampling import standard_errors
from tests.laws.scores import seed_of
from tests.models import bare, recorded

# Rabinowicz's contact: regular births of equal triangles, whose areas add up to a constant, or all but.
ANCESTORS = Path(__file__).parents[2] / "scenarios" / "ancestors"
ONE_SIZE = Spread()
TICKS_A_SPACING = 1_000


def regular(count: float, pulse: Pulse = TRIANGLE, spread: Spread = ONE_SIZE, **changes: float) -> Model:
    """Return a contact of regular births."""
    return bare(count=count, pulse=pulse, spread=spread, births="regular", calibration="exact", **changes)


def ripple(count: float, pulse: Pulse) -> float:
    """Return std over mean of regular births of one size: the root of 2 sum |A^(2 pi n / D) / A^(0)|^2 over n >= 1.

    D = 2d/N is their spacing, so that k d = pi n N; A^(k)/A^(0) is sinc^2(n N/2) for the triangle, and for the lens
    (3/2) pi H_1(k d) / (k d)^2.
    """
    n = np.arange(1, 20_001)
    z = pi * n * count
    shares = np.sinc(n * count / 2.0) ** 2 if pulse is TRIANGLE else 1.5 * pi * struve(1, z) / z**2
    return float(sqrt(2.0 * np.sum(shares**2)))


def sampled_ripple(count: float, pulse: Pulse) -> float:
    """Return std over mean of three spacings of a run, cut into a thousand ticks each."""
    spacing = regular(count, pulse).births.mean_spacing
    run = regular(count, pulse, tick=spacing / TICKS_A_SPACING, distance=3.01 * spacing)
    area = recorded(run, seed_of(f"ripple/{count}"))["trace"]["real_contact_area"][: 3 * TICKS_A_SPACING]
    return float(area.std() / area.mean())


@pytest.mark.parametrize("count", [2.0, 4.0, 10.0, 20.0, 50.0])
def test_an_even_number_of_triangles_adds_up_to_a_constant(count: float) -> None:
    run = regular(count, tick=0.13, distance=2_000.0)
    area = recorded(run, seed_of(f"even/{count}"))["trace"]["real_contact_area"]
    # Each birth and each tick is rounded to half an ulp of the distance, the slopes are pi d/4, N of them: at worst
    # 2 ulp/d of the mean (pi/8) d^2 N.
    bound = 2.0 * np.spacing(2_000.0) / run.calibrated_diameter
    assert np.abs(area / 200.0 - 1.0).max() < bound + 1e-15 * count


def test_the_scenario_is_constant_over_its_whole_run() -> None:
    record = rubnoise.simulate(rubnoise.load(ANCESTORS / "rabinowicz.toml"))
    area, slider = record["trace"]["real_contact_area"], record["slider"]
    assert area.size > 250_000
    assert area.std() < 1e-12 * area.mean()
    assert abs(area.mean() - 200.0) < 1e-9
    assert np.all(record["trace"]["junction_count"] == 20)
    # Where it starts, in equilibrium with a constant force, the slider stays.
    assert np.ptp(slider["displacement"]) < 1e-9
    assert np.abs(slider["velocity"]).max() < 1e-5


@pytest.mark.parametrize("count", [1.0, 3.0, 7.0, 21.0])
def test_an_odd_number_leaves_a_triangular_wave(count: float) -> None:
    # The mean square of such a wave, of height a and period D, over points h apart is off by (h^2/8) 32 a^2/D at most,
    # that is 12 (h/D)^2 of itself.
    assert ripple(count, TRIANGLE) == pytest.approx(1.0 / (sqrt(3.0) * count**2), rel=1e-9)
    assert sampled_ripple(count, TRIANGLE) == pytest.approx(1.0 / (sqrt(3.0) * count**2), rel=1e-5)


def test_poisson_births_of_triangles_are_far_from_constant() -> None:
    run = bare(count=20.0, pulse=TRIANGLE, spread=ONE_SIZE, tick=0.5, distance=20_000.0)
    area = recorded(run, seed_of("poisson triangles"))["trace"]["real_contact_area"]
    expected, error = 200.0 * 2.0 / sqrt(60.0), standard_errors(run)["std"]
    assert abs(area.std() - expected) <= 4.0 * error
    assert abs(area.std() - 200.0 * ripple(20.0, LENS)) > 5.0 * error
    assert abs(area.std() - 1.1 * expected) > 5.0 * error


@pytest.mark.parametrize("count", [1.0, 2.0, 20.0])
def test_so_many_are_alive_at_every_tick(count: float) -> None:
    alive = recorded(regular(count, distance=300.0), seed_of(f"alive/{count}"))["trace"]["junction_count"]
    assert np.all(alive == count)


def test_births_lie_at_whole_multiples_of_their_spacing() -> None:
    run, seed = regular(20.0, distance=20_000.0), seed_of("multiples")
    record = recorded(run, seed)["junctions"]
    number = record["junction"] - np.sum(record["state"] & JunctionState.ALIVE_AT_START > 0)
    expected = start(run, seed).next_birth + number * run.births.mean_spacing
    assert np.array_equal(record["birth_distance"], expected)
    assert number[-1] > 2 * births_per_block(run)
    # Added up one by one, as random gaps are, they would have drifted by then.
    gaps = np.full(number[-1], run.births.mean_spacing)
    added = np.add.accumulate(np.concatenate([[start(run, seed).next_birth], gaps]))
    assert abs(added[-1] - expected[-1]) > 10 * np.spacing(expected[-1])


def starts(run: Model, seeds: int) -> tuple[list[int], list[float], list[float]]:
    """Return how many are alive at the start of each of some runs, and all their diameters and ages over lives."""
    counts, diameters, ages = [], [], []
    for n in range(seeds):
        live = start(run, seed_of(f"starts/{n}")).live
        counts.append(len(live))
        diameters.extend(live.diameter.tolist())
        ages.extend((-live.birth / (2.0 * live.diameter)).tolist())
    return counts, diameters, ages


def test_the_start_of_regular_births_is_stationary() -> None:
    """Alive is whom length has favoured, d f(d), at an age uniform on the life, N_jm m_1/d_m in number on average."""
    run = regular(10.0, spread=Spread(relative=0.5))
    m = run.sizes.moment
    counts, diameters, ages = starts(run, 300)
    # Given the phase each birth is alive or not by itself: the variance of a count is below its mean.
    expected = 10.0 * m(1) / run.calibrated_diameter
    assert abs(np.mean(counts) - expected) <= 4.0 * sqrt(expected / 300.0)
    alive, spread = m(2) / m(1), sqrt((m(3) / m(1) - (m(2) / m(1)) ** 2) / len(diameters))
    assert abs(np.mean(diameters) - alive) <= 4.0 * spread
    assert abs(np.mean(diameters) - m(1)) > 5.0 * spread
    assert abs(np.mean(ages) - 0.5) <= 4.0 * sqrt(1.0 / 12.0 / len(ages))
    # Counted as Poisson births are, they would scatter more.
    assert np.var(counts, ddof=1) < 0.7 * expected


def autocorrelation(lag: float) -> float:
    """Return the normalised overlap of a triangle of base 2 with itself: the cubic spline, 0 beyond 2."""
    t = abs(lag)
    return 1.0 - 1.5 * t**2 + 0.75 * t**3 if t <= 1.0 else 0.25 * max(2.0 - t, 0.0) ** 3


def test_unequal_strengths_let_the_force_vary_over_a_constant_area() -> None:
    """Given the births, the force is a sum over independent strengths, of variance Var[psi] lam c_2 d^5 everywhere."""
    scenario = rubnoise.load(ANCESTORS / "rabinowicz_strengths.toml")
    run = scenario.model()
    trace = rubnoise.simulate(scenario, seed=seed_of("strengths"))["trace"]
    assert trace["real_contact_area"].std() < 1e-12 * 200.0
    cv = 0.2
    expected = (cv * 2.0 / sqrt(60.0) * 250.0 * 200.0) ** 2
    # Strengths are normal but for one in 3.5 million, and so is their sum: Var[var] = 2 var^2 / L int rho^2.
    square = 2.0 * np.mean([autocorrelation(t) ** 2 for t in np.linspace(0.0, 2.0, 20_001)]) * 2.0
    error = expected * sqrt(2.0 * square * run.calibrated_diameter / run.distance)
    assert abs(trace["friction_force"].var() - expected) <= 4.0 * error
    assert abs(trace["friction_force"].var() - 1.25 * expected) > 5.0 * error


# The theory against values computed elsewhere with 20 to 30 digits.
