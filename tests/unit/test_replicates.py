"""A figure of several runs, and the exact value of each figure alone."""

from math import inf, isinf, isnan, nan, sqrt

import numpy as np
import pytest

from rubnoise.analysis.expected_figures import FIGURES, expected_figure
from rubnoise.analysis.replicates import Pooled, pooled, ratio
from rubnoise.analysis.summary import summarise
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from tests.models import bare, model
from tests.verification.seeds import seed_of


@pytest.mark.parametrize("run", [model(), model(start="empty"), model(slider=None), bare()])
def test_exact_values_are_those_of_the_summary(run: Model) -> None:
    tally = Tally()
    simulate(run, 1, tally, engine="batch")
    expected = {figure.name: figure.expected for figure in summarise(run, tally)}
    for name in FIGURES:
        value = expected_figure(run, name)
        assert value == pytest.approx(expected[name], rel=1e-12) if name in expected else isnan(value)


def test_every_figure_has_an_exact_value() -> None:
    tally = Tally()
    simulate(model(), 1, tally, engine="batch")
    assert [figure.name for figure in summarise(model(), tally)] == list(FIGURES)


def test_means_are_pooled_as_they_are_and_standard_deviations_as_squares() -> None:
    values = [3.0, nan, 4.0, 5.0]
    mean = pooled("area_mean", values)
    assert (mean.value, mean.runs) == (4.0, 3)
    assert mean.standard_error == pytest.approx(1.0 / sqrt(3.0))
    assert mean.reach == pytest.approx(4.302652729749462 / sqrt(3.0))
    std = pooled("area_std", values)
    assert std.value == pytest.approx(sqrt(50.0 / 3.0))
    assert std.standard_error == pytest.approx(np.std([9.0, 16.0, 25.0], ddof=1) / sqrt(3.0) / 2.0 / std.value)


def test_one_run_has_the_error_of_theory_or_none() -> None:
    assert pooled("area_std", [3.0], 0.5).reach == pytest.approx(0.98, rel=1e-3)
    assert isinf(pooled("area_std", [3.0]).reach)
    assert pooled("area_std", [3.0, nan], 0.5).standard_error == 0.5
    nothing = pooled("area_std", [nan], 0.5)
    assert isnan(nothing.value)
    assert (nothing.standard_error, nothing.runs) == (inf, 0)
    assert pooled("area_std", [0.0, 0.0]).standard_error == 0.0


@pytest.mark.parametrize(("name", "truth"), [("x_mean", 5.0), ("x_std", 2.0)])
def test_intervals_hold_the_truth_as_often_as_they_say(name: str, truth: float) -> None:
    """Of 1000 intervals of 95 % some 950 hold it, give or take 4 sqrt(1000 0.95 0.05) = 28."""
    rng = np.random.Generator(np.random.PCG64(seed_of(f"replicates/{name}")))
    held = missed = 0
    for _ in range(1000):
        runs = rng.normal(5.0, 2.0, (12, 400))
        found = pooled(name, (runs.mean(axis=1) if name == "x_mean" else runs.std(axis=1)).tolist())
        held += abs(found.value - truth) <= found.reach
        missed += abs(found.value - 1.03 * truth) <= found.reach
    assert 922 <= held <= 978
    assert missed < 850


def test_a_ratio_is_as_uncertain_as_both_together() -> None:
    first, second = (Pooled(value=v, standard_error=e, runs=n) for v, e, n in ((6.0, 0.3, 9), (-2.0, 0.06, 12)))
    found = ratio(first, second)
    assert (found.value, found.runs) == (-3.0, 9)
    assert found.standard_error == pytest.approx(3.0 * sqrt(0.05**2 + 0.03**2))
