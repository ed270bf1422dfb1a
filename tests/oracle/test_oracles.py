"""The slow references held to what is known without them, and to each other."""

from __future__ import annotations

import ast
import json
import math
from math import exp, factorial, pi
from pathlib import Path

import numpy as np
import pytest

from tests.oracle import sliders
from tests.oracle.sliders import Motion, Oscillator, stepped_motion, straight_motion, theta_motion, triangle_areas
from tests.oracle.slow_contact import (
    Doubles,
    Rows,
    brackets,
    davies,
    junction_area,
    lens_age,
    lens_area,
    level,
    naive_rows,
    panjer,
    traces,
    triangle_area,
)

# Two references for the slider that share only the list of junctions give the same motion, and see small faults.
SPEED = 1000.0
MASS, STIFFNESS = 0.005, 300.0
CRITICAL = 2 * math.sqrt(MASS * STIFFNESS)
EQUILIBRIUM = (250 * 204.6736 / STIFFNESS, 0.0)
SLIDERS = {
    "figure 5": (0.05, 200.0),
    "over-damped": (20 * CRITICAL, 40.0),
    "critical": (CRITICAL, 40.0),
    "nearly critical": (1.001 * CRITICAL, 40.0),
}
AGREEMENT = 1e-12


def slider(damping: float) -> Oscillator:
    return Oscillator(mass=MASS, stiffness=STIFFNESS, damping=damping)


def figure_5_rows(distance: float) -> Rows:
    generator = np.random.default_rng(20)
    return naive_rows(
        mean_area=200, mean_count=20, diameter_std=0.2, strength=250, distance=distance, generator=generator
    )


def ticks(distance: float, tick: float) -> Doubles:
    return np.arange(round(distance / tick) + 1) * tick


def difference(one: Motion, other: Motion) -> float:
    """Return the largest difference of displacement or velocity, each relative to its largest value."""
    displacement = np.abs(one.displacement - other.displacement).max() / np.abs(one.displacement).max()
    velocity = np.abs(one.velocity - other.velocity).max() / np.abs(one.velocity).max()
    return float(max(displacement, velocity))


@pytest.mark.parametrize("name", SLIDERS)
def test_both_references_give_the_same_motion(name: str) -> None:
    damping, distance = SLIDERS[name]
    rows, places = figure_5_rows(distance), ticks(distance, 2.0)
    theta = theta_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    stepped = stepped_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) < AGREEMENT


def test_both_references_agree_from_rest_and_in_motion_at_a_slow_speed() -> None:
    rows, places = figure_5_rows(12.0), ticks(12.0, 1.0)
    start = (0.0, 500.0)
    theta = theta_motion(slider(0.05), 50.0, places, rows, start)
    stepped = stepped_motion(slider(0.05), 50.0, places, rows, start)
    assert difference(theta, stepped) < AGREEMENT


@pytest.mark.parametrize("name", SLIDERS)
def test_both_references_for_triangles_give_the_same_motion(name: str) -> None:
    damping, distance = SLIDERS[name]
    rows, places = figure_5_rows(distance), ticks(distance, 2.0)
    rows = rows.ending_early(7, rows.birth[7] + 0.4 * rows.diameter[7])
    rows = rows.ending_early(33, rows.birth[33] + 1.3 * rows.diameter[33])
    straight = straight_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    triangles = stepped_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM, triangle_areas)
    lenses = stepped_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    assert difference(straight, triangles) < AGREEMENT
    assert difference(straight, lenses) > 1e-3


@pytest.mark.parametrize("damping", [0.05, CRITICAL, 20 * CRITICAL])
def test_the_theta_reference_does_not_depend_on_its_ticks(damping: float) -> None:
    rows = figure_5_rows(40.0)
    coarse = theta_motion(slider(damping), SPEED, ticks(40.0, 2.0), rows, EQUILIBRIUM)
    fine = theta_motion(slider(damping), SPEED, ticks(40.0, 0.1), rows, EQUILIBRIUM)
    sampled = Motion(displacement=fine.displacement[::20], velocity=fine.velocity[::20])
    assert difference(coarse, sampled) < 1e-13


def test_a_junction_that_ends_early_ends_early_in_both() -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    row = int(np.searchsorted(rows.birth, 5.0))
    for share in (0.4, 1.3):
        changed = rows.ending_early(row, rows.birth[row] + share * rows.diameter[row])
        theta = theta_motion(slider(0.05), SPEED, places, changed, EQUILIBRIUM)
        stepped = stepped_motion(slider(0.05), SPEED, places, changed, EQUILIBRIUM)
        whole = theta_motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
        assert difference(theta, stepped) < AGREEMENT
        assert difference(whole, stepped) > 1e-3


def test_a_death_moved_by_a_hundredth_of_a_life_is_seen() -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    row = int(np.searchsorted(rows.birth, 1.0))
    moved = rows.ending_early(row, rows.birth[row] + 1.98 * rows.diameter[row])
    theta = theta_motion(slider(0.05), SPEED, places, moved, EQUILIBRIUM)
    stepped = stepped_motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) > 1e4 * AGREEMENT


def test_a_forgotten_kink_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    stepped = stepped_motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    cut = sliders.pieces

    def without_mid_life(rows: Rows, row: int, places: Doubles) -> Doubles:
        cuts = cut(rows, row, places)
        return cuts[cuts != rows.birth[row] + rows.diameter[row]]

    monkeypatch.setattr(sliders, "pieces", without_mid_life)
    theta = theta_motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) > 1e4 * AGREEMENT


def test_free_motion_is_the_textbook_one() -> None:
    # Without junctions the under-damped answer is a decaying cosine; a wrong transition cannot hide behind the force.
    none = np.empty(0)
    rows = Rows(birth=none, diameter=none, strength=none, death=none)
    places = ticks(100.0, 1.0)
    decay = 0.05 / (2 * MASS)
    rate = math.sqrt(STIFFNESS / MASS - decay**2)
    time = places / SPEED
    expected = 3.0 * np.exp(-decay * time) * (np.cos(rate * time) + decay / rate * np.sin(rate * time))
    for motion in (theta_motion, stepped_motion):
        x = motion(slider(0.05), SPEED, places, rows, (3.0, 0.0)).displacement
        assert np.abs(x - expected).max() < 1e-11


# The slow contact held to what is known without it: geometry, exact integrals and shot-noise cumulants.
HERE = Path(__file__).parent
LIFE_INTEGRALS = json.loads((HERE.parent / "reference" / "pulse.json").read_text(encoding="utf-8"))["c"]
MEAN_DIAMETER = math.sqrt(200 / 20 / 0.327)
STD = 0.2
SAMPLES = 400
SAMPLE_GAP = 2 * (MEAN_DIAMETER + 12 * STD)


def one_junction(*, birth: float, diameter: float, death: float) -> Rows:
    return Rows(
        birth=np.array([birth]), diameter=np.array([diameter]), strength=np.array([250.0]), death=np.array([death])
    )


@pytest.mark.parametrize("s", [0.0, 1e-3, 0.4, 2.9, 3.0, 3.1, 5.5, 6.0, 7.0])
def test_the_paper_and_the_lens_give_one_area(s: float) -> None:
    assert junction_area(s, 3.0) == pytest.approx(lens_area(s, 3.0), abs=1e-14 * 9)


def test_the_area_is_full_at_mid_life_and_a_third_of_the_square_on_average() -> None:
    assert lens_area(3.0, 3.0) == pytest.approx(math.pi * 9 / 4, rel=1e-15)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    rising = sum(w * lens_area(1.5 * (1 + t), 3.0) for t, w in zip(nodes, weights, strict=True)) / 2
    assert rising == pytest.approx(9 / 3, rel=1e-6)


def test_the_triangle_is_as_high_as_the_lens_and_straight() -> None:
    assert triangle_area(3.0, 3.0) == pytest.approx(lens_area(3.0, 3.0), rel=1e-15)
    assert [triangle_area(s, 3.0) / triangle_area(3.0, 3.0) for s in (-1, 0, 1.5, 4.5, 6, 7)] == [0, 0, 0.5, 0.5, 0, 0]


def test_a_junction_counts_from_its_birth_up_to_its_death() -> None:
    area, count, force = traces(one_junction(birth=1.0, diameter=2.0, death=5.0), [0.5, 1.0, 3.0, 4.999, 5.0, 6.0])
    assert count.tolist() == [0, 1, 1, 1, 0, 0]
    assert area[2] == pytest.approx(math.pi)
    assert np.array_equal(force, 250 * area)


def test_a_junction_that_ends_early_is_gone() -> None:
    area, count, _ = traces(one_junction(birth=0.0, diameter=2.0, death=2.5), [2.4, 2.5])
    assert count.tolist() == [1, 0]
    assert area[0] > 2
    assert area[1] == 0


def samples() -> tuple[np.ndarray, np.ndarray]:
    """Return areas and counts so far apart that no junction is seen twice: independent draws."""
    rows = naive_rows(
        mean_area=200,
        mean_count=20,
        diameter_std=STD,
        strength=250,
        distance=SAMPLES * SAMPLE_GAP,
        generator=np.random.default_rng(3),
    )
    area, count, _ = traces(rows, np.arange(SAMPLES) * SAMPLE_GAP)
    return area, count


def normal_moment(n: int) -> float:
    """Return E[d^n] of a normal diameter; what redrawing at 27 standard deviations changes is below rounding."""
    return sum(
        math.comb(n, j) * MEAN_DIAMETER ** (n - j) * STD**j * math.prod(range(1, j, 2)) for j in range(0, n + 1, 2)
    )


def cumulant(n: int) -> float:
    """Return kappa_n = lambda c_n m_(2n+1) of the area (Campbell; Rice 1944), lambda = N_jm/(2 d_m)."""
    return 20 / (2 * MEAN_DIAMETER) * float(LIFE_INTEGRALS[str(n)]) * normal_moment(2 * n + 1)


def test_area_and_count_have_their_exact_means_and_variances() -> None:
    area, count = samples()
    assert abs(area.mean() - cumulant(1)) <= 4 * math.sqrt(cumulant(2) / SAMPLES)
    spread = math.sqrt((cumulant(4) + 2 * cumulant(2) ** 2) / SAMPLES)
    assert abs(area.var(ddof=1) - cumulant(2)) <= 4 * spread
    # A Poisson number of mean 20: its fourth cumulant is 20 too.
    assert abs(count.mean() - 20) <= 4 * math.sqrt(20 / SAMPLES)
    assert abs(count.var(ddof=1) - 20) <= 4 * math.sqrt((20 + 2 * 20**2) / SAMPLES)


def test_a_tenth_more_junctions_would_be_noticed() -> None:
    area, count = samples()
    assert abs(count.mean() - 22) > 4 * math.sqrt(22 / SAMPLES)
    assert abs(area.mean() - 1.1 * cumulant(1)) > 4 * math.sqrt(1.1 * cumulant(2) / SAMPLES)


def test_diameters_are_redrawn_until_positive() -> None:
    generator = np.random.default_rng(4)
    rows = naive_rows(mean_area=1, mean_count=3, diameter_std=2.0, strength=1, distance=200, generator=generator)
    assert len(rows.diameter) > 100
    assert (rows.diameter > 0).all()
    assert (np.diff(rows.birth) > 0).all()
    assert (rows.death > 0).all()


@pytest.mark.parametrize("path", sorted(HERE.glob("*.py")), ids=lambda path: path.name)
def test_no_reference_imports_what_it_judges(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert not any(name.split(".")[0] == "rubnoise" for name in imported)


# The slow distribution held to sums that are known, and its two routes to each other.
ONE_SIZE = (np.array([2.0]), np.ones(1))


def test_panjer_sums_a_poisson_number_of_ones_and_twos() -> None:
    found = panjer(np.array([0.0, 0.75, 0.25]), 2.0, 4)
    chances = [1.0, 1.5, 1.5**2 / 2.0 + 0.5, 1.5**3 / 6.0 + 1.5 * 0.5]
    np.testing.assert_allclose(found, np.cumsum(chances) * exp(-2.0), rtol=1e-14)


def test_panjer_counts_areas_of_nothing() -> None:
    found = panjer(np.array([0.4, 0.6]), 2.0, 6)
    np.testing.assert_allclose(found, np.cumsum([1.2**n / factorial(n) for n in range(6)]) * exp(-1.2), rtol=1e-14)


def test_age_of_a_lens_gives_back_its_area() -> None:
    u = np.array([0.0, 1e-3, 0.3, 0.9, 1.0])
    x = 1.0 - u
    np.testing.assert_allclose(lens_age(0.5 * (np.arccos(x) - x * np.sqrt(1.0 - x * x))), u, atol=1e-9)
    np.testing.assert_allclose(level(ONE_SIZE, np.array([0.0, pi, 9.0])), [0.0, 1.0, 1.0], atol=1e-12)


@pytest.mark.parametrize("sizes", [ONE_SIZE, (np.array([1.0, 2.0, 2.5]), np.array([0.2, 0.5, 0.3]))])
def test_both_routes_agree(sizes: tuple[np.ndarray, np.ndarray]) -> None:
    places = 0.04 * np.arange(1500)
    below, above = brackets(sizes, 20.0, 0.04, 1500)
    found = davies(sizes, 20.0, places, 200.0, 600)
    assert np.all(below < found + 1e-8)
    assert np.all(found < above + 1e-8)
    assert np.max(np.abs(found - 0.5 * (below + above))) < 2e-3
