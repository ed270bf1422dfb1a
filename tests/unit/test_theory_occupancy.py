from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Normal
from rubnoise.model import Model
from rubnoise.theory.occupancy import (
    count_covariance,
    count_from_empty,
    expected_births,
    expected_junction_rows,
    length_biased_mean_diameter,
    mean_count,
    mean_count_error,
)
from tests.unit.theory_models import model_of, one_size, paper_model

Doubles = NDArray[np.float64]

WIDE = model_of(Normal(centre=2.0, std=3.0), 2.0)


def dense(model: Model, function: Callable[[Doubles], Doubles]) -> float:
    """Return E[g(d)] by the trapezium rule on 400 001 points."""
    d = np.linspace(*model.sizes.support, 400_001)
    return np.trapezoid(function(d) * model.sizes.density(d), d)


@pytest.mark.parametrize("lag", [0.0, 0.3, 4.0, 11.0, 30.0])
def test_covariance_is_the_life_that_is_left(lag: float) -> None:
    expected = WIDE.birth_rate * dense(WIDE, lambda d: np.maximum(2.0 * d - lag, 0.0))
    assert count_covariance(WIDE, lag) == pytest.approx(expected, rel=1e-8, abs=1e-9)
    assert count_covariance(WIDE, -lag) == count_covariance(WIDE, lag)


def test_covariance_of_one_size_falls_in_a_straight_line_to_zero() -> None:
    np.testing.assert_allclose(
        count_covariance(one_size(), [0.0, 5.53, 11.06, 50.0]), [20.0, 10.0, 0.0, 0.0], atol=1e-12
    )


def test_spread_makes_more_junctions_alive_than_asked_for() -> None:
    at_turning = model_of(Normal(centre=1.0, std=1.0), 1.0)
    assert mean_count(at_turning) / 20.0 == pytest.approx(1.288, abs=5e-4)
    assert mean_count(one_size()) == pytest.approx(20.0, rel=1e-15)


def test_length_bias_is_the_law_weighted_by_life() -> None:
    expected = dense(WIDE, np.square) / dense(WIDE, lambda d: d)
    assert length_biased_mean_diameter(WIDE) == pytest.approx(expected, rel=1e-9)


def test_an_empty_start_fills_in_one_longest_life() -> None:
    distances = np.array([0.0, 0.5, 3.0, 20.0, 2.0 * WIDE.sizes.support[1], 1e6])
    expected = [WIDE.birth_rate * dense(WIDE, lambda d, s=s: np.minimum(s, 2.0 * d)) for s in distances]
    found = count_from_empty(WIDE, distances)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-12)
    assert found[-1] == pytest.approx(mean_count(WIDE), rel=1e-12)


def test_expected_rows_count_those_alive_at_a_stationary_start() -> None:
    model = paper_model()
    assert expected_births(model) == pytest.approx(40_000.0 / 0.55300126, rel=1e-7)
    assert expected_junction_rows(model) - expected_births(model) == pytest.approx(20.0, rel=1e-9)
    assert expected_junction_rows(replace(model, start="empty")) == expected_births(model)


@pytest.mark.parametrize("distance", [3.0, 11.06, 200.0, 40_000.0])
def test_error_of_the_mean_count_in_closed_form(distance: float) -> None:
    life, reach = 11.06, min(distance, 11.06)
    integral = distance * life * reach - (distance + life) * reach**2 / 2.0 + reach**3 / 3.0
    variance = 2.0 * one_size().birth_rate * integral / distance**2
    assert mean_count_error(one_size(), distance) == pytest.approx(np.sqrt(variance), rel=1e-12)
