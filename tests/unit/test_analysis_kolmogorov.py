"""Kolmogorov distances: by the definition, their tails, and samples of any size."""

import numpy as np
import pytest
from scipy.special import ndtr

from rubnoise.analysis.kolmogorov import UniformSample, distance_tail, kolmogorov_figure, sample_distance
from tests.verification.seeds import seed_of


def uniform(count: int, name: str) -> np.ndarray:
    return np.random.default_rng(seed_of(f"kolmogorov/{name}")).random(count)


def naive(values: np.ndarray) -> float:
    places = np.linspace(0.0, 1.0, 20_001)
    return float(np.max(np.abs((values[:, None] <= places).mean(axis=0) - places)))


def test_the_distance_is_the_largest_difference() -> None:
    values = uniform(50, "few")
    assert sample_distance(values, values) == pytest.approx(naive(values), abs=1e-4)


def test_the_tail_is_that_of_the_exact_law() -> None:
    from scipy.stats import kstwo

    for count, distance in ((10, 0.6), (40, 0.3), (900, 0.06)):
        assert distance_tail(distance, count) == pytest.approx(float(kstwo.sf(distance, count)), rel=1e-3)
    assert distance_tail(0.02, 10_000) == pytest.approx(float(kstwo.sf(0.02, 10_000)), rel=0.05)
    assert distance_tail(0.0, 10) == distance_tail(0.0, 10_000) == 1.0
    assert distance_tail(2.0, 10) == 0.0


def test_a_law_is_accepted_and_another_rejected() -> None:
    values = np.random.default_rng(seed_of("kolmogorov/normal")).standard_normal(5000)
    right = kolmogorov_figure("x", sample_distance(values, ndtr(values)), 5000)
    wrong = kolmogorov_figure("x", sample_distance(values, ndtr(values - 0.2)), 5000)
    assert abs(right.z or 0.0) <= 4.0
    assert (wrong.z or 0.0) > 5.0


def test_scores_of_right_samples_are_unit_normals() -> None:
    figures = [
        kolmogorov_figure("x", sample_distance(u, u), 2000) for u in uniform(400 * 2000, "many").reshape(400, -1)
    ]
    scores = np.array([figure.z for figure in figures])
    plain = [(figure.observed - (figure.expected or 0.0)) / (figure.standard_error or 1.0) for figure in figures]
    assert abs(scores.mean()) <= 4.0 / 20.0
    assert abs(scores.std() - 1.0) <= 4.0 / np.sqrt(2.0 * 400)
    assert abs(float(np.mean(plain))) <= 4.0 / 20.0


def test_few_values_are_never_called_too_good() -> None:
    even = (np.arange(20) + 0.5) / 20
    assert kolmogorov_figure("x", sample_distance(even, even), 20).z == 0.0


def test_small_distances_of_a_law_with_an_atom_are_never_called_too_good() -> None:
    """Of mostly one value the distance is that of a few: it says nothing, and a large one still does."""
    values = np.maximum(uniform(20_000, "atom") - 0.9, 0.0)
    distance = sample_distance(values, values + 0.9, atom=0.9)
    assert (kolmogorov_figure("x", distance, 20_000).z or 0.0) < -2.0
    assert kolmogorov_figure("x", distance, 20_000, 0.9).z == 0.0
    assert (kolmogorov_figure("x", 0.02, 20_000, 0.9).z or 0.0) > 5.0


@pytest.mark.parametrize("pieces", [1, 9])
def test_counts_in_bins_give_the_distance(pieces: int) -> None:
    values = uniform(30_000, "bins")
    sample = UniformSample()
    for piece in np.array_split(values, pieces):
        sample.add(piece)
    assert sample.count == 30_000
    assert sample.distance() <= sample_distance(values, values)
    assert sample.distance() == pytest.approx(sample_distance(values, values), abs=1e-4)


def test_counts_take_the_ends() -> None:
    sample = UniformSample()
    sample.add(np.array([0.0, 1.0]))
    assert sample.distance() == pytest.approx(0.5, abs=1e-5)


def test_an_atom_at_zero_is_compared_as_one() -> None:
    generator = np.random.default_rng(seed_of("kolmogorov/atom"))
    values = np.maximum(generator.random(4000) - 0.3, 0.0)
    heights = values + 0.3
    assert sample_distance(values, heights, atom=0.3) * 4000**0.5 < 2.2
    assert sample_distance(values[values > 0.0], heights[values > 0.0], atom=0.3) >= 0.3
    assert sample_distance(np.zeros(10), np.full(10, 0.3), atom=0.3) == pytest.approx(0.7)
