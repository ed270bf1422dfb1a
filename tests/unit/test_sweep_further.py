"""The rounds of a sweep with a precision: the same runs whatever happens between them."""

from collections.abc import Callable
from math import sqrt
from pathlib import Path
from random import Random

from rubnoise.record.tally import Tally
from rubnoise.scenario.points import Point, points_of
from rubnoise.scenario.sweep import Sweep, expand
from rubnoise.sweep.execution import Measure, measured
from rubnoise.sweep.stopping_rule import AdaptiveReplicates
from tests.unit.sweeps import sweep_of

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


def _std(_model: object, tally: Tally) -> float:
    return tally.moments["real_contact_area"].std


def _tally(_extent: object) -> Tally:
    return Tally()


MEASURE = Measure(sink=_tally, read=_std)


def _figures(point: Point) -> dict[str, float]:
    return {"real_contact_area_std": measured(point, MEASURE)}


def _carried_out(sweep: Sweep, run: Callable[[Point], dict[str, float]] = _figures, shuffle: int = 0) -> Figures:
    further = AdaptiveReplicates(sweep)
    ended: Figures = {}
    while points := list(further(ended)):
        Random(shuffle).shuffle(points)  # noqa: S311  (any order will do)
        ended |= {point.run_id: run(point) for point in points}
    return ended


def test_the_first_round_is_the_sweep(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path)
    assert AdaptiveReplicates(sweep)({}) == expand(sweep)
    assert len(expand(sweep)) == 16
    assert AdaptiveReplicates(sweep).points == expand(sweep)


def test_without_a_precision_there_is_one_round(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, "[sweep]\nreplicates = 3\n")
    ended: Figures = {point.run_id: {} for point in expand(sweep)}
    assert AdaptiveReplicates(sweep)({}) == expand(sweep)
    assert AdaptiveReplicates(sweep)(ended) == ()
    assert AdaptiveReplicates(sweep).unmet(ended) == []


def test_every_point_gets_to_its_precision(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path)
    ended = _carried_out(sweep)
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
    straight = _carried_out(sweep)
    assert _carried_out(sweep, shuffle=7) == straight
    ended: Figures = {}
    # A restart after every third run.
    while points := AdaptiveReplicates(sweep)(ended):
        ended |= {point.run_id: _figures(point) for point in points[:3]}
    assert ended == straight
    again = AdaptiveReplicates(sweep)
    assert again(ended) == ()
    assert {point.run_id for point in again.points} == set(straight)
    assert [point.replicate for point in again.points].count(0) == len(sweep.cases)


def test_another_point_changes_nothing_of_one(tmp_path: Path) -> None:
    more = sweep_of(
        tmp_path,
        TABLE.format(precision=0.02, most=200).replace("[10, 40]", "[10, 20, 40]"),
        "sliding.distance=500 um",
    )
    assert _carried_out(_sweep(tmp_path)).items() <= _carried_out(more).items()


def test_a_point_that_never_gets_there_ends_at_the_most_and_is_told(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path, precision=0.001, most=20)
    ended = _carried_out(sweep)
    assert len(ended) == 40
    unmet = AdaptiveReplicates(sweep).unmet(ended)
    assert [point.values for point in unmet] == [case.values for case in sweep.cases]
    assert all(point.replicates == 20 and 0.001 < point.reached < 0.2 for point in unmet)


def test_failed_runs_count_and_have_no_figure(tmp_path: Path) -> None:
    sweep = _sweep(tmp_path, precision=0.5, most=20)

    def half(point: Point) -> dict[str, float]:
        return _figures(point) if point.replicate % 2 else {}

    assert len(_carried_out(sweep, half)) == 16
    assert len(_carried_out(sweep, lambda _: {})) == 40
