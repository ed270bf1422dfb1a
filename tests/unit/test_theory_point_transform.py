import numpy as np
import pytest
from numpy.polynomial import legendre

from rubnoise.theory.inversion import point_transform
from rubnoise.theory.live_area import NODES, Piecewise, series
from rubnoise.theory.quadrature import panels


@pytest.mark.parametrize("count", [64, 4096])
def test_sums_over_points_are_those_of_the_definition(count: int) -> None:
    generator = np.random.default_rng(7)
    places = generator.integers(-(2**32), 2**32, 200) * 2.0**-31  # so short that whole turns are told exactly
    places[:2] = 0.0, 0.5
    weights = generator.normal(size=places.size)
    found = point_transform(places, weights, count)
    rows = np.unique(np.linspace(0, count - 1, 50).astype(int))
    expected = np.exp(2j * np.pi * np.mod(np.multiply.outer(rows, places), 1.0)) @ weights
    assert np.max(np.abs(found[rows] - expected)) < 1e-14 * np.sum(np.abs(weights))


def test_many_points_are_taken_in_parts() -> None:
    places = (np.arange(40_000) + 0.5) / 40_000
    found = point_transform(places, np.full(places.size, 1.0 / places.size), 32)
    np.testing.assert_allclose(found, np.arange(32) == 0, atol=1e-14)


def test_pieces_of_a_polynomial_are_the_polynomial() -> None:
    edges = np.array([-1.0, 0.0, 0.5, 3.0])
    t, _ = panels(edges, NODES)
    pieces = Piecewise(edges=edges, coefficients=series((t**3 - 2.0 * t).reshape(3, NODES)))
    x = np.array([[-1.0, -0.3, 0.0], [0.5, 2.0, 3.0]])
    np.testing.assert_allclose(pieces(x), x**3 - 2.0 * x, atol=1e-13)
    np.testing.assert_allclose(pieces.integral()(x), (x**4 - 1.0) / 4.0 - (x**2 - 1.0), atol=1e-13)
    np.testing.assert_allclose(pieces.scaled(-2.0)(x), 4.0 * x - 2.0 * x**3, atol=1e-13)
    np.testing.assert_allclose(pieces(np.array([-9.0, 9.0])), [1.0, 21.0], atol=1e-12)


def test_series_of_several_functions_at_once() -> None:
    x, _ = legendre.leggauss(NODES)
    found = series(np.stack([[np.ones(NODES), x], [x**2, legendre.legval(x, [0.0, 0.0, 0.0, 1.0])]]))
    assert found.shape == (NODES, 2, 2)
    np.testing.assert_allclose(found[:4, 0, 1], [0.0, 1.0, 0.0, 0.0], atol=1e-13)
    np.testing.assert_allclose(found[:4, 1, 0], [1.0 / 3.0, 0.0, 2.0 / 3.0, 0.0], atol=1e-13)
    np.testing.assert_allclose(found[:4, 1, 1], [0.0, 0.0, 0.0, 1.0], atol=1e-13)
