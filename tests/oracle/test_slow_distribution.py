"""The slow distribution held to sums that are known, and its two routes to each other."""

from math import exp, factorial, pi

import numpy as np
import pytest

from tests.oracle.slow_distribution import brackets, davies, lens_age, level, panjer

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
