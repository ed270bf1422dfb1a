"""A figure of several runs, and the exact value of each figure alone."""

from dataclasses import replace
from math import inf, isinf, isnan, nan, sqrt

import numpy as np
import pytest

from rubnoise.analysis.replicates import Pooled, pooled, ratio, ratio_of_pairs
from rubnoise.analysis.summary import EXPECTED_FIGURES, expected_figure, summarise
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from tests.models import bare, model
from tests.verification.seeds import seed_of


@pytest.mark.parametrize(
    "run", [model(), model(start="empty"), model(slider=None), bare(), replace(bare(), hardness=1e3)]
)
def test_exact_values_are_those_of_the_summary(run: Model) -> None:
    tally = Tally()
    simulate(run, 1, tally, engine="batch")
    expected = {figure.name: figure.expected for figure in summarise(run, tally)}
    for name in EXPECTED_FIGURES:
        value = expected_figure(run, name)
        assert value == pytest.approx(expected[name], rel=1e-12) if name in expected else isnan(value)


def test_every_figure_has_an_exact_value() -> None:
    tally = Tally()
    run = replace(model(), hardness=1000.0)
    simulate(run, 1, tally, engine="batch")
    assert [figure.name for figure in summarise(run, tally)] == list(EXPECTED_FIGURES)


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


@pytest.mark.parametrize(("name", "truth"), [("x_mean", 0.8), ("x_std", 0.8)])
def test_pairs_tell_a_ratio_as_well_as_they_say(name: str, truth: float) -> None:
    """Of 1000 intervals of 95 % some 950 hold it; what a pair has in common makes them ten times narrower."""
    rng = np.random.Generator(np.random.PCG64(seed_of(f"pairs/{name}")))
    held = missed = 0
    widths = []
    for _ in range(1000):
        common = rng.uniform(3.0, 7.0, 12)
        first, second = (share * common + 0.02 * rng.normal(size=12) for share in (truth, 1.0))
        found = ratio_of_pairs(name, first.tolist(), second.tolist())
        held += abs(found.value - truth) <= found.reach
        missed += abs(found.value - 1.01 * truth) <= found.reach
        widths.append(
            found.standard_error / ratio(pooled(name, first.tolist()), pooled(name, second.tolist())).standard_error
        )
    assert 922 <= held <= 978
    assert missed < 850
    assert np.median(widths) < 0.1


def test_pairs_with_nothing_in_them_have_no_ratio() -> None:
    assert ratio_of_pairs("x_std", [2.0, nan, 4.0], [1.0, 1.0, 2.0]) == Pooled(value=2.0, standard_error=0.0, runs=2)
    assert isinf(ratio_of_pairs("x_mean", [2.0], [1.0]).standard_error)
    for first, second in (([], []), ([nan], [1.0]), ([1.0, 1.0], [0.0, 0.0])):
        assert isnan(ratio_of_pairs("x_mean", first, second).value)
    assert ratio_of_pairs("x_std", [0.0, 0.0], [1.0, 2.0]).value == 0.0
