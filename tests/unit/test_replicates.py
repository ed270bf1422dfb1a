"""Numbers of several runs: their mean, its interval, and what counts as agreement."""

import numpy as np
import pytest

from rubnoise.analysis.replicates import PooledEstimate, difference, estimate, ratio


def test_an_estimate_is_the_mean_of_the_runs_with_student_s_interval() -> None:
    found = estimate([1.0, 2.0, 3.0, 6.0])
    assert found.value == 3.0
    assert found.standard_error == pytest.approx(np.std([1, 2, 3, 6], ddof=1) / 2.0)
    assert found.interval[1] - 3.0 == pytest.approx(3.182446 * found.standard_error, rel=1e-6)


def test_agreement_is_as_strict_as_four_standard_deviations_of_a_normal_number() -> None:
    many = PooledEstimate(value=0.0, standard_error=1.0, runs=100_000)
    assert many.agrees_with(3.99)
    assert not many.agrees_with(4.01)
    few = PooledEstimate(value=0.0, standard_error=1.0, runs=4)
    assert few.agrees_with(4.5), "few runs know their own error badly"


def test_errors_of_differences_and_ratios_add_up() -> None:
    one, other = (
        PooledEstimate(value=8.0, standard_error=0.3, runs=5),
        PooledEstimate(value=2.0, standard_error=0.4, runs=7),
    )
    assert difference(one, other) == PooledEstimate(value=6.0, standard_error=0.5, runs=5)
    found = ratio(one, other)
    assert (found.value, found.runs) == (4.0, 5)
    assert found.standard_error == pytest.approx(4.0 * np.hypot(0.3 / 8.0, 0.4 / 2.0))
