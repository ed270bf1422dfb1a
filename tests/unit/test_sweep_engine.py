"""Every point is run once, in this process and in others, also if workers die."""

import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError, Future
from functools import partial
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused, RubnoiseError, RunStopped
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.tally import Tally
from rubnoise.scenario.points import Point
from rubnoise.scenario.sweep import expand
from rubnoise.sweep import pool as pool_module
from rubnoise.sweep.execution import (
    LONGEST,
    SECONDS,
    Attempt,
    Execution,
    Here,
    Measurement,
    MessageSize,
    Outcome,
    WorkLost,
    measured,
    run_points,
)
from rubnoise.sweep.pool import Pool, Worker, WorkerDied
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.sampling import standard_errors
from tests.unit import errands
from tests.unit.scenarios import sweep_of


# Every point is run once, also if workers die, in this process and in others.
def _points(folder: Path, replicates: int) -> tuple[Point, ...]:
    return expand(sweep_of(folder, f"[sweep]\nreplicates = {replicates}\n"))


@pytest.fixture
def points(tmp_path: Path) -> tuple[Point, ...]:
    return _points(tmp_path, 8)


@pytest.fixture(scope="module")
def pool() -> Iterator[Pool]:
    with Pool(2) as workers:
        yield workers


def _results(outcomes: Iterator[Outcome[Any]]) -> dict[str, Any]:
    """Return results by name; no point may come twice."""
    found = [(outcome.point.run_id, outcome.result) for outcome in outcomes]
    assert len(dict(found)) == len(found)
    return dict(found)


def test_every_point_is_carried_out_once_in_other_processes(pool: Pool, tmp_path: Path) -> None:
    points = _points(tmp_path, 60)
    found = _results(Execution(points, errands.name_and_process, pool).outcomes())
    assert found.keys() == {point.run_id for point in points}
    assert all(name == own for name, (own, _) in found.items())
    assert os.getpid() not in {process for _, process in found.values()}
    assert {process for _, process in found.values()} <= set(pool.processes)


@pytest.mark.parametrize("here", [True, False], ids=["here", "in a pool"])
def test_a_problem_is_told_of_its_point_and_keeps_no_other_from_being_tried(
    pool: Pool, points: tuple[Point, ...], *, here: bool
) -> None:
    outcomes = list(Execution(points, errands.fail_some, Here() if here else pool).outcomes())
    assert len(outcomes) == len(points)
    for outcome in outcomes:
        if outcome.point.replicate % 2:
            assert isinstance(outcome.problem, Refused)
            assert str(outcome.problem) == f"replicate {outcome.point.replicate} is odd"
        else:
            assert (outcome.problem, outcome.result) == (None, outcome.point.run_id)


def test_a_problem_that_cannot_travel_is_told_in_words(pool: Pool, points: tuple[Point, ...]) -> None:
    told = {
        outcome.point.replicate: outcome.problem for outcome in Execution(points, errands.be_awkward, pool).outcomes()
    }
    assert {type(problem) for problem in told.values()} == {RubnoiseError}
    assert str(told[2]) == "Awkward: replicate 2"
    [here, *_] = Execution(points, errands.be_awkward, Here()).outcomes()
    assert isinstance(here.problem, errands.Awkward)


OTHER = {"rubnoise": "0.0.1", "stream": 99, "format": 1}


class Elsewhere(Here):
    """A worker with another version, which does as it says, or an older one that does not know versions."""

    def __init__(self, *, knows: bool) -> None:
        self.knows = knows
        self.worked: list[str] = []

    def submit(self, function: Any, /, work: Any, points: Any, asked: Any) -> "Future[Any]":
        done: Future[Any] = Future()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("rubnoise.sweep.execution.versions", lambda: OTHER)
            if self.knows:
                done.set_result(function(lambda point: self.worked.append(point.run_id), points, asked))
            else:
                done.set_result(Attempt([None] * len(points), 0.1))
        return done


@pytest.mark.parametrize("knows", [True, False])
def test_a_worker_of_another_version_ends_the_sweep_and_makes_nothing(
    points: tuple[Point, ...], *, knows: bool
) -> None:
    workers = Elsewhere(knows=knows)
    said = "rubnoise 0.0.1, stream 99, format 1" if knows else "no version that it says"
    with pytest.raises(WorkLost, match=f"a worker has {said}, and this process rubnoise .*, stream 1, format 1"):
        list(Execution(points, errands.fail_some, workers).outcomes())
    assert workers.worked == []


def test_a_point_whose_worker_is_killed_is_tried_once_more(
    pool: Pool, points: tuple[Point, ...], tmp_path: Path
) -> None:
    before = pool.processes
    outcomes = list(Execution(points, partial(errands.die_once, folder=tmp_path), pool).outcomes())
    assert {outcome.point.run_id: outcome.result for outcome in outcomes} == {p.run_id: p.run_id for p in points}
    assert len(outcomes) == len(points)
    assert len(set(before) & set(pool.processes)) == 1


def test_a_point_that_kills_its_worker_twice_has_failed_and_the_others_have_not(
    pool: Pool, points: tuple[Point, ...], tmp_path: Path
) -> None:
    outcomes = {o.point.replicate: o for o in Execution(points, partial(errands.die, folder=tmp_path), pool).outcomes()}
    died = outcomes.pop(3)
    assert isinstance(died.problem, WorkerDied)
    assert str(died.problem) == "its process was killed by SIGSEGV"
    assert (tmp_path / "tries").read_text(encoding="utf-8") == "xx"
    assert [outcome.problem for outcome in outcomes.values()] == [None] * 7


def test_what_was_done_before_the_worker_died_is_not_done_again(pool: Pool, tmp_path: Path) -> None:
    points = _points(tmp_path, 40)
    done = tmp_path / "done"
    done.mkdir()

    def recover(point: Point) -> str | None:
        return f"found {point.run_id}" if (done / point.run_id).exists() else None

    found = _results(
        Execution(points, partial(errands.leave_a_result_and_die, folder=done), pool, recover=recover).outcomes()
    )
    assert found.keys() == {point.run_id for point in points}
    assert found[points[3].run_id] == f"found {points[3].run_id}"
    assert {mark.read_text(encoding="utf-8") for mark in done.iterdir()} == {"x"}


def test_a_process_that_just_ends_is_told_by_its_exit_code(pool: Pool, points: tuple[Point, ...]) -> None:
    [outcome] = Execution(points[:1], errands.leave, pool).outcomes()
    assert str(outcome.problem) == "its process ended with exit code 7"
    assert str(WorkerDied(-250)) == "its process was killed by signal 250"


@pytest.mark.parametrize("answers", [0, 1], ids=["before it has answered", "before its answer is read"])
def test_a_worker_ends_without_a_word_where_its_parent_is_gone(answers: int, capfd: pytest.CaptureFixture[str]) -> None:
    worker = Worker.begin()
    worker.line.send((len, ("four",)))
    if answers:
        assert worker.line.poll(60.0)
    worker.line.close()
    assert worker.process.wait(60.0) == 0
    assert capfd.readouterr().err == ""


def test_a_function_that_cannot_be_sent_fails_each_point(pool: Pool, points: tuple[Point, ...]) -> None:
    outcomes = list(Execution(points[:2], lambda point: point, pool).outcomes())
    assert all("pickle" in str(outcome.problem).lower() for outcome in outcomes)
    assert len(outcomes) == 2


def test_workers_are_told_to_use_one_thread(pool: Pool, points: tuple[Point, ...]) -> None:
    [outcome] = Execution(points[:1], errands.threads, pool).outcomes()
    assert outcome.result == {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def test_who_watches_may_stop_it_and_no_process_stays(
    points: tuple[Point, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool_module, "GRACE", 0.2)
    processes: list[int] = []

    def stop_once_begun() -> None:
        if any((tmp_path / point.run_id).exists() for point in points):
            raise RunStopped(2)

    with pytest.raises(RunStopped), Pool(2) as workers:  # noqa: PT012  (leaving the pool is what is tested)
        processes += workers.processes
        list(Execution(points, partial(errands.sleep, folder=tmp_path), workers, watch=stop_once_begun).outcomes())
    assert not list(tmp_path.glob("* awake"))
    for process in processes:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_a_worker_that_is_stopped_in_its_first_call_leaves_by_itself(tmp_path: Path) -> None:
    worker = Worker.begin()
    worker.line.send((errands.run_until_stopped, (tmp_path,)))
    while not (tmp_path / "begun").exists():
        assert worker.process.poll() is None
        time.sleep(0.01)
    worker.process.terminate()
    for _ in range(1500):
        if worker.process.poll() is not None:
            break
        time.sleep(0.01)
    code = worker.process.poll()
    worker.end(seconds=0.0)
    assert code == 0


class Deserted(Here):
    """A scheduler that is gone."""

    def submit(self, *_: Any) -> "Future[Any]":
        lost: Future[Any] = Future()
        lost.set_exception(CancelledError())
        return lost


def test_work_that_nobody_has_any_more_ends_the_sweep(points: tuple[Point, ...]) -> None:
    with pytest.raises(WorkLost, match="the same command resumes the sweep"):
        list(Execution(points, errands.fail_some, Deserted()).outcomes())


def test_messages_bring_a_second_of_work_and_shares_get_smaller_towards_the_end() -> None:
    pace = MessageSize()
    assert pace.size(1000, 2) == 1
    pace.took(1, 0.02)
    assert pace.size(1000, 2) == int(SECONDS / 0.02)
    assert [pace.size(left, 2) for left in (100, 20, 3, 1)] == [25, 5, 1, 1]
    for _ in range(6):
        pace.took(4, 4.0)
    assert pace.size(1000, 2) == 1
    pace = MessageSize()
    pace.took(1, 0.0)
    assert pace.size(100_000, 2) == LONGEST


def test_messages_to_this_process_hold_one_point() -> None:
    assert (Here.lanes, Here.ahead, Here.most) == (1, 0, 1)
    assert Attempt([1], 0.5) == Attempt([1], 0.5)
    assert Pool.most == sys.maxsize


# Points run in memory are the runs that their scenarios say.
TABLE = "[sweep]\nreplicates = 2\n[sweep.grid]\ninterface.mean_junction_count = [10, 40]\n"


def _area(model: Model, record: MemoryRecord) -> np.ndarray:
    return record["trace"]["real_contact_area"]


def _std(model: Model, tally: Tally) -> float:
    return tally.moments["real_contact_area"].std


TRACES = Measurement(sink=MemoryRecord, read=_area)
STDS = Measurement(sink=lambda extent: Tally(), read=_std)


def test_a_point_is_the_run_of_its_scenario(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, TABLE, "sliding.distance=500 um"))
    told = list(run_points(points, TRACES))
    assert [point for point, _ in told] == list(points)
    for point, area in told:
        alone = rubnoise.simulate(point.scenario)["trace"]["real_contact_area"]
        assert np.array_equal(area, alone)
    assert not np.array_equal(told[0][1], told[1][1])


def test_the_order_of_points_changes_no_result(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, TABLE, "sliding.distance=500 um"))
    forwards = [std for _, std in run_points(points, STDS)]
    assert [std for _, std in run_points(points[::-1], STDS)][::-1] == forwards
    assert [measured(point, STDS) for point in points] == forwards


def test_a_point_runs_only_when_its_result_is_wanted(tmp_path: Path) -> None:
    points = iter(expand(sweep_of(tmp_path, TABLE, "sliding.distance=100 um")))
    next(run_points(points, STDS))
    assert len(list(points)) == 3


def test_replicates_are_independent_runs_of_one_theory(tmp_path: Path) -> None:
    table = TABLE.replace("replicates = 2", "replicates = 8")
    for count in (10, 40):
        points = [point for point in expand(sweep_of(tmp_path, table, "sliding.distance=3 mm"))
                  if point.values["interface.mean_junction_count"] == count]  # fmt: skip
        model = points[0].scenario.model()
        found = np.array([std for _, std in run_points(points, STDS)])
        error = standard_errors(model).std / sqrt(len(points))
        assert abs(found.mean() - area_cumulants(model).std) <= 4.0 * error
        assert found.std(ddof=1) == pytest.approx(standard_errors(model).std, rel=1.2)
        assert np.unique(found).size == len(points)
