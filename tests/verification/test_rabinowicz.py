"""Numbers known from elsewhere: Rabinowicz's constant area, and theory to 20 or 30 digits."""

import json
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import struve

import rubnoise
from rubnoise.contact.laws import Spread
from rubnoise.contact.overlap import life_integral
from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.simulation.draws import birth_distances, births_per_block, first_birth, start
from rubnoise.theory.cumulants import area_cumulants, force_cumulants
from rubnoise.theory.live_count import length_biased_mean_diameter, mean_count
from rubnoise.theory.motion import response
from rubnoise.theory.sampling import standard_errors
from rubnoise.theory.second_order import density_at_zero, spectral_density
from tests.models import bare, recorded
from tests.unit.theory_models import paper_model
from tests.verification.scores import seed_of

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
    spacing = regular(count, pulse).births.mean
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


def test_the_scenario_with_lenses_is_left_with_its_ripple() -> None:
    area = rubnoise.simulate(rubnoise.load(ANCESTORS / "rabinowicz_lens.toml"))["trace"]["real_contact_area"]
    assert area.std() / area.mean() == pytest.approx(ripple(20.0, LENS), rel=1e-3)
    assert area.std() / area.mean() == pytest.approx(0.000996, rel=1e-3)


@pytest.mark.parametrize("count", [1.0, 3.0, 7.0, 21.0])
def test_an_odd_number_leaves_a_triangular_wave(count: float) -> None:
    # The mean square of such a wave, of height a and period D, over points h apart is off by (h^2/8) 32 a^2/D at most,
    # that is 12 (h/D)^2 of itself.
    assert ripple(count, TRIANGLE) == pytest.approx(1.0 / (sqrt(3.0) * count**2), rel=1e-9)
    assert sampled_ripple(count, TRIANGLE) == pytest.approx(1.0 / (sqrt(3.0) * count**2), rel=1e-5)


@pytest.mark.parametrize("count", [0.5, 2.5, 6.3])
def test_a_number_between_leaves_more(count: float) -> None:
    assert sampled_ripple(count, TRIANGLE) == pytest.approx(ripple(count, TRIANGLE), rel=1e-5)


@pytest.mark.parametrize("count", [1.0, 2.0, 2.5, 10.0, 20.0])
def test_lenses_leave_a_ripple_for_every_number(count: float) -> None:
    assert sampled_ripple(count, LENS) == pytest.approx(ripple(count, LENS), rel=1e-4)


def test_the_ripples_that_are_told_of() -> None:
    told = {(2.5, TRIANGLE): 0.052, (2.0, LENS): 0.074, (10.0, LENS): 0.0038, (20.0, LENS): 0.000996}
    for (count, pulse), share in told.items():
        assert ripple(count, pulse) == pytest.approx(share, rel=0.02)


def test_poisson_births_of_triangles_are_far_from_constant() -> None:
    run = bare(count=20.0, pulse=TRIANGLE, spread=ONE_SIZE, tick=0.5, distance=20_000.0)
    area = recorded(run, seed_of("poisson triangles"))["trace"]["real_contact_area"]
    expected, error = 200.0 * 2.0 / sqrt(60.0), standard_errors(run).std
    assert abs(area.std() - expected) <= 4.0 * error
    assert abs(area.std() - 200.0 * ripple(20.0, LENS)) > 5.0 * error
    assert abs(area.std() - 1.1 * expected) > 5.0 * error


@pytest.mark.parametrize("count", [1.0, 2.0, 20.0])
def test_so_many_are_alive_at_every_tick(count: float) -> None:
    alive = recorded(regular(count, distance=300.0), seed_of(f"alive/{count}"))["trace"]["junction_count"]
    assert np.all(alive == count)


def test_a_number_between_is_its_two_neighbours_by_turns() -> None:
    alive = recorded(regular(2.5, tick=0.01, distance=300.0), 3)["trace"]["junction_count"]
    assert set(alive.tolist()) == {2, 3}
    assert alive.mean() == pytest.approx(2.5, abs=0.01)


def test_births_lie_at_whole_multiples_of_their_spacing() -> None:
    run, seed = regular(20.0, distance=20_000.0), seed_of("multiples")
    record = recorded(run, seed)["junctions"]
    number = record["junction"] - np.sum(record["state"] & JunctionState.ALIVE_AT_START > 0)
    expected = first_birth(run, seed) + number * run.births.mean
    assert np.array_equal(record["birth_distance"], expected)
    assert number[-1] > 30 * births_per_block(run)
    # Added up one by one, as random gaps are, they would have drifted by then.
    added = np.add.accumulate(np.concatenate([[first_birth(run, seed)], np.full(number[-1], run.births.mean)]))
    assert abs(added[-1] - expected[-1]) > 10 * np.spacing(expected[-1])


def test_a_block_begins_where_the_one_before_ended() -> None:
    run, seed = regular(20.0), seed_of("blocks")
    before = birth_distances(run, seed, 4, 0.0)
    after = birth_distances(run, seed, 5, 0.0)
    assert before[-1] == after[0]


def test_an_empty_start_has_nobody_born_before() -> None:
    rows = recorded(bare(births="regular", start="empty", distance=100.0), 5)["junctions"]
    assert rows["birth_distance"][0] >= 0.0
    assert not np.any(rows["state"] & JunctionState.ALIVE_AT_START)


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


def test_rows_alive_at_the_start_are_in_order_and_reach_it() -> None:
    live = start(regular(20.0, spread=Spread(relative=2.0)), 9).live
    assert len(live) > 20
    assert np.all(np.diff(live.birth) > 0.0)
    assert np.all(live.birth < 0.0)
    assert np.all(live.death > 0.0)


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
REFERENCE = Path(__file__).parent.parent / "reference"


def read(name: str) -> dict[str, Any]:
    return json.loads((REFERENCE / name).read_text())


def of(row: dict[str, Any]) -> Model:
    return paper_model(
        row["mean_real_contact_area_input"],
        row["mean_junction_count_input"],
        row["diameter_std"],
        row["calibration"],
        slider=None,
    )


def label(row: dict[str, Any]) -> str:
    keys = ("calibration", "mean_real_contact_area_input", "mean_junction_count_input", "diameter_std")
    return "-".join(f"{row[key]}" for key in keys)


MOMENT_ROWS = read("moments.json")["rows"]
SPECTRUM_ROWS = read("spectrum.json")["rows"]


@pytest.mark.parametrize("row", MOMENT_ROWS, ids=label)
def test_moments_of_area_and_count(row: dict[str, Any]) -> None:
    model = of(row)
    area = area_cumulants(model)
    found = {
        "mean_diameter_calibrated": model.calibrated_diameter,
        "mean_life_distance": model.mean_life_distance,
        "mean_birth_spacing": model.mean_birth_spacing,
        "junction_count_mean": mean_count(model),
        "area_mean": area.mean,
        "area_std": area.std,
        "area_skewness": area.skewness,
        "area_excess_kurtosis": area.excess_kurtosis,
        "length_biased_mean_diameter": length_biased_mean_diameter(model),
    }
    assert found == pytest.approx({key: row[key] for key in found}, rel=1e-12)


def test_every_row_is_there_and_two_of_them_redraw() -> None:
    assert len(MOMENT_ROWS) >= 27
    assert sum(row["diameter_std"] > 0.5 * row["mean_diameter_calibrated"] for row in MOMENT_ROWS) == 2


@pytest.mark.parametrize("power", range(1, 7))
def test_life_integrals(power: int) -> None:
    assert life_integral(power) == pytest.approx(float(read("pulse.json")["c"][str(power)]), rel=1e-15)


@pytest.mark.parametrize("row", SPECTRUM_ROWS, ids=label)
def test_spectral_density(row: dict[str, Any]) -> None:
    found = spectral_density(of(row), row["wavenumber_rad_per_um"])
    np.testing.assert_allclose(found, row["spectral_density_um4_per_rad_per_um"], rtol=1e-7)


@pytest.mark.parametrize(("mean_count_", "density"), [(10, 65_651), (20, 23_438), (50, 6_103)])
def test_spectral_density_at_zero(mean_count_: float, density: float) -> None:
    assert density_at_zero(paper_model(mean_count=mean_count_)) == pytest.approx(density, abs=0.5)


def test_slider_of_figure_5() -> None:
    model = paper_model()
    found = response(model)
    assert force_cumulants(model).mean == pytest.approx(51_168.4, abs=0.05)
    assert force_cumulants(model).std == pytest.approx(14_107.34, abs=0.005)
    assert found.mean_displacement == pytest.approx(170.561, abs=0.0005)
    assert found.displacement_std == pytest.approx(195.3059, abs=0.00005)
    assert found.velocity_std == pytest.approx(47_241.1, abs=0.05)
    assert found.one_way_validity == pytest.approx(47.2411, abs=0.00005)


def test_slider_of_figure_5_at_a_hundred_times_the_speed() -> None:
    assert response(paper_model(speed=100_000.0)).displacement_std == pytest.approx(22.10, abs=0.005)
