"""The slow contact held to what is known without it: geometry, exact integrals and shot-noise cumulants."""

from __future__ import annotations

import ast
import json
import math
from pathlib import Path

import numpy as np
import pytest

from tests.oracle.slow_contact import Rows, junction_area, lens_area, naive_rows, traces, triangle_area

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
