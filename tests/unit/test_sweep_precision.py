"""A sweep with a precision: how many replicates, and the same ones whatever happens between rounds."""

from collections.abc import Callable
from math import inf, nan, sqrt
from pathlib import Path
from random import Random

import numpy as np
import pytest

from rubnoise.runs.sweep import AdaptiveReplicates
from rubnoise.scenario.document import FEWEST, SWEEP_RUNS, Sweeping
from rubnoise.scenario.sweep import Point, Sweep, points_of
from tests.laws.scores import seed_of
from tests.unit.scenarios import GRID, std_of, sweep_of, sweep_refusal

# A precision asks for as many replicates as it takes, in a way that only their own figures decide.
PRECISE = Sweeping(precision=0.01, quantity="real_contact_area_std", most_replicates=1000)
POINTS = GRID.replace("replicates = 2\n", "")


def _line(*lines: str) -> str:
    return POINTS.replace("[sweep]\n", "\n".join(["[sweep]", *lines, ""]))


def test_runs_that_a_precision_may_come_to_are_counted(tmp_path: Path) -> None:
    most = SWEEP_RUNS // 6 + 1
    report = sweep_refusal(tmp_path, _line("precision = 0.1", f"most_replicates = {most}"))
    assert "sweep: too many: 6 points, 100,002 runs with replicates" in report
    assert "fewer values or most_replicates" in report
    sweep_of(tmp_path, _line("precision = 0.1", f"most_replicates = {most - 1}"))


def test_what_is_reached_is_the_relative_standard_error_of_the_mean() -> None:
    values = np.random.Generator(np.random.PCG64(seed_of("precision/reached"))).normal(50.0, 5.0, 40)
    error = values.std(ddof=1) / sqrt(40) / values.mean()
    assert PRECISE.reached(values.tolist()) == pytest.approx(error, rel=1e-12)
    assert PRECISE.reached([*values.tolist(), nan]) == pytest.approx(error, rel=1e-12)
    assert PRECISE.reached((-values).tolist()) == pytest.approx(error, rel=1e-12)
    assert PRECISE.reached([3.0]) == PRECISE.reached([]) == PRECISE.reached([nan, 3.0]) == inf
    assert PRECISE.reached([7.0] * 8) == 0.0
    assert PRECISE.reached([-1.0, 1.0]) == inf


def _carried_out(values: np.ndarray, precision: Sweeping) -> int:
    count, wanted = 0, FEWEST
    while wanted > count:
        count = wanted
        wanted = precision.wanted(values[:count].tolist())
    return count


def test_stopping_early_costs_little_of_the_precision() -> None:
    """Of unit normals about 20 to a relative error of 0.01 one needs 25; what is got is as good as was asked for."""
    rng = np.random.Generator(np.random.PCG64(seed_of("precision/stopping")))
    precision = Sweeping(precision=0.01, quantity="real_contact_area_std", most_replicates=1000)
    counts, means = [], []
    for _ in range(400):
        values = rng.normal(20.0, 1.0, 1000)
        counts.append(_carried_out(values, precision))
        means.append(values[: counts[-1]].mean())
    assert np.mean(counts) == pytest.approx(25.0, rel=0.2)
    error = float(np.std(means) / 20.0)
    # The std of 400 means is known to 3.5 %; stopping on a lucky scatter may cost some 15 % more than was asked for.
    assert 0.7 * 0.01 <= error <= 1.2 * 0.01
    # Eight of each, which is what there is without a precision, are far from it.
    assert 1.0 / sqrt(8.0) / 20.0 > 0.01 * 1.7


# The rounds of a sweep with a precision: the same runs whatever happens between them.
TABLE = """\
[sweep]
precision = {precision}
most_replicates = {most}
[sweep.grid]
interface.mean_junction_count = [10, 40]
"""
Figures = dict[str, dict[str, float]]


def _sweep(folder: Path, precision: float = 0.02, most: int = 200) -> Sweep:
    return sweep_of(folder, TABLE.format(precision=precision, most=most), "sliding.distance=500 um")


def _figures(point: Point) -> dict[str, float]:
    return {"real_contact_area_std": std_of(point, "real_contact_area")}


def _rounds(sweep: Sweep, run: Callable[[Point], dict[str, float]] = _figures, shuffle: int = 0) -> Figures:
    further = AdaptiveReplicates(sweep)
    ended: Figures = {}
    while points := list(further(ended)):
        Random(shuffle).shuffle(points)  # noqa: S311  (any order will do)
        ended |= {point.run_id: run(point) for point in points}
    return ended


def test_every_point_gets_to_its_precision(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path)
    ended = _rounds(sweep)
    assert AdaptiveReplicates(sweep).unmet(ended) == []
    assert len(ended) > 16
    for case in sweep.cases:
        points = points_of([case], 200)
        values = [ended[point.run_id]["real_contact_area_std"] for point in points if point.run_id in ended]
        mean = sum(values) / len(values)
        error = sqrt(sum((value - mean) ** 2 for value in values) / (len(values) * (len(values) - 1)))
        assert error / mean <= 0.02
        assert [point.run_id in ended for point in points] == [n < len(values) for n in range(200)]


def test_neither_order_nor_restarts_change_what_is_run(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path)
    straight = _rounds(sweep)
    assert _rounds(sweep, shuffle=7) == straight
    ended: Figures = {}
    # A restart after every third run.
    while points := AdaptiveReplicates(sweep)(ended):
        ended |= {point.run_id: _figures(point) for point in points[:3]}
    assert ended == straight
    again = AdaptiveReplicates(sweep)
    assert again(ended) == ()
    assert {point.run_id for point in again.points} == set(straight)
    assert [point.replicate for point in again.points].count(0) == len(sweep.cases)


def test_a_point_that_never_gets_there_ends_at_the_most_and_is_told(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path, precision=0.001, most=20)
    ended = _rounds(sweep)
    assert len(ended) == 40
    unmet = AdaptiveReplicates(sweep).unmet(ended)
    assert [point.values for point in unmet] == [case.values for case in sweep.cases]
    assert all(point.replicates == 20 and 0.001 < point.reached < 0.2 for point in unmet)


def test_failed_runs_count_and_have_no_figure(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path, precision=0.5, most=20)

    def half(point: Point) -> dict[str, float]:
        return _figures(point) if point.replicate % 2 else {}

    assert len(_rounds(sweep, half)) == 16
    assert len(_rounds(sweep, lambda _: {})) == 40
