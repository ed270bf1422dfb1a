"""Numbers of several runs: their mean, its interval, and their ratios."""

import numpy as np
import pytest

from rubnoise.analysis.replicates import PooledEstimate, estimate, ratio


def test_an_estimate_is_the_mean_of_the_runs_with_student_s_interval() -> None:
    found = estimate([1.0, 2.0, 3.0, 6.0])
    assert found.value == 3.0
    assert found.standard_error == pytest.approx(np.std([1, 2, 3, 6], ddof=1) / 2.0)
    assert found.interval[1] - 3.0 == pytest.approx(3.182446 * found.standard_error, rel=1e-6)


def test_the_errors_of_both_numbers_of_a_ratio_add_up() -> None:
    one, other = (
        PooledEstimate(value=8.0, standard_error=0.3, runs=5),
        PooledEstimate(value=2.0, standard_error=0.4, runs=7),
    )
    found = ratio(one, other)
    assert (found.value, found.runs) == (4.0, 5)
    assert found.standard_error == pytest.approx(4.0 * np.hypot(0.3 / 8.0, 0.4 / 2.0))
