"""The slow references held to what is known without them, and to each other."""

from __future__ import annotations

import ast
import json
import math
from math import exp, pi
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
)

# Two references for the slider that share only the list of junctions give the same motion, and see small faults.
SPEED = 1000.0
MASS, STIFFNESS = 0.005, 300.0
CRITICAL = 2 * math.sqrt(MASS * STIFFNESS)
EQUILIBRIUM = (250 * 204.6736 / STIFFNESS, 0.0)
SLIDERS = {
    "figure 5": (0.05, 80.0),
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


@pytest.mark.slow
@pytest.mark.parametrize("name", SLIDERS)
def test_both_references_give_the_same_motion(name: str) -> None:
    damping, distance = SLIDERS[name]
    rows, places = figure_5_rows(distance), ticks(distance, 2.0)
    theta = theta_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    stepped = stepped_motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) < AGREEMENT


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_death_moved_by_a_hundredth_of_a_life_is_seen() -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    row = int(np.searchsorted(rows.birth, 1.0))
    moved = rows.ending_early(row, rows.birth[row] + 1.98 * rows.diameter[row])
    theta = theta_motion(slider(0.05), SPEED, places, moved, EQUILIBRIUM)
    stepped = stepped_motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) > 1e4 * AGREEMENT


@pytest.mark.slow
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


# The slow contact held to what is known without it: geometry, exact integrals and shot-noise cumulants.
HERE = Path(__file__).parent
LIFE_INTEGRALS = json.loads((HERE.parent / "reference" / "pulse.json").read_text(encoding="utf-8"))["c"]
MEAN_DIAMETER = math.sqrt(200 / 20 / 0.327)
STD = 0.2
SAMPLES = 400
SAMPLE_GAP = 2 * (MEAN_DIAMETER + 12 * STD)


@pytest.mark.parametrize("s", [0.0, 1e-3, 0.4, 2.9, 3.0, 3.1, 5.5, 6.0, 7.0])
def test_the_paper_and_the_lens_give_one_area(s: float) -> None:
    assert junction_area(s, 3.0) == pytest.approx(lens_area(s, 3.0), abs=1e-14 * 9)


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


@pytest.mark.slow
def test_area_and_count_have_their_exact_means_and_variances() -> None:
    area, count = samples()
    assert abs(area.mean() - cumulant(1)) <= 4 * math.sqrt(cumulant(2) / SAMPLES)
    spread = math.sqrt((cumulant(4) + 2 * cumulant(2) ** 2) / SAMPLES)
    assert abs(area.var(ddof=1) - cumulant(2)) <= 4 * spread
    # A Poisson number of mean 20: its fourth cumulant is 20 too.
    assert abs(count.mean() - 20) <= 4 * math.sqrt(20 / SAMPLES)
    assert abs(count.var(ddof=1) - 20) <= 4 * math.sqrt((20 + 2 * 20**2) / SAMPLES)


@pytest.mark.slow
def test_a_tenth_more_junctions_would_be_noticed() -> None:
    area, count = samples()
    assert abs(count.mean() - 22) > 4 * math.sqrt(22 / SAMPLES)
    assert abs(area.mean() - 1.1 * cumulant(1)) > 4 * math.sqrt(1.1 * cumulant(2) / SAMPLES)


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
