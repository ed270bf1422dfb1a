"""Every point is run once, in this process and in others, also if workers die."""

import os
import re
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from math import sqrt
from pathlib import Path
from typing import Any, Self

import numpy as np
import pytest

from rubnoise.errors import Refused, RunStopped
from rubnoise.runs.executors import Failed, Here, Workers, WorkLost, local, opened, outcomes, versions
from rubnoise.scenario.sweep import Point, expand
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sampling import standard_errors
from tests.unit import errands
from tests.unit.scenarios import std_of, sweep_of


# Every point is run once, also if workers die, in this process and in others.
def _points(folder: Path, replicates: int) -> tuple[Point, ...]:
    return expand(sweep_of(folder, f"[sweep]\nreplicates = {replicates}\n"))


@pytest.fixture
def points(tmp_path: Path) -> tuple[Point, ...]:
    return _points(tmp_path, 8)


def _outcomes(
    points: tuple[Point, ...],
    work: Callable[[Point], Any],
    workers: Workers | None = None,
    watch: Callable[[], None] = lambda: None,
) -> dict[int, Any]:
    """Return all results by the numbers of replicates; no point may come twice."""
    found = [(point.replicate, result) for point, result in outcomes(deque(points), work, workers or local(1), watch)]
    assert sorted(replicate for replicate, _ in found) == list(range(len(points)))
    return dict(found)


@pytest.mark.slow
def test_two_workers_that_are_killed_cost_no_run(tmp_path: Path) -> None:
    points = _points(tmp_path, 40)
    found = _outcomes(points, partial(errands.die_once, folder=tmp_path), local(2))
    assert set(found.values()) == {point.run_id for point in points}
    assert sum((tmp_path / point.run_id).exists() for point in points) == 2


@pytest.mark.slow
def test_a_run_that_always_kills_its_worker_fails_alone(tmp_path: Path) -> None:
    points = _points(tmp_path, 40)
    found = _outcomes(points, partial(errands.die, folder=tmp_path), local(2))
    died = found.pop(3)
    assert died.startswith("3 workers died of it: ")
    assert "SIGSEGV" in died
    assert (tmp_path / "tries").read_text(encoding="utf-8") == "xxx"
    assert not any(isinstance(result, Failed) for result in found.values())


def test_a_problem_is_told_of_its_point_and_keeps_no_other_from_being_tried(points: tuple[Point, ...]) -> None:
    for replicate, result in _outcomes(points, errands.fail_some).items():
        assert isinstance(result, Failed) == bool(replicate % 2)
        assert result == (f"replicate {replicate} is odd" if replicate % 2 else points[replicate].run_id)


@pytest.mark.slow
def test_workers_are_told_to_use_one_thread(points: tuple[Point, ...]) -> None:
    assert _outcomes(points[:1], errands.threads, local(2))[0] == {
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "NUMBA_NUM_THREADS": "1",
    }


def test_an_executor_of_the_caller_makes_them_too(points: tuple[Point, ...]) -> None:
    with ThreadPoolExecutor(3) as threads, opened(threads, 3) as workers:
        assert _outcomes(points, errands.fail_some, workers)[0] == points[0].run_id
    for result in _outcomes(points, errands.fail_some, workers).values():
        assert result == "3 workers died of it: cannot schedule new futures after shutdown"
    with pytest.raises(Refused, match="executor=: int is no executor; an executor has submit"), opened(3, None):
        pass


class Fragile:
    """An executor that loses everything it has at some calls, as one does when a worker dies."""

    def __init__(self, *loses_at: int, refuses: bool = False) -> None:
        self.loses_at, self.refuses = set(loses_at), refuses
        self.calls = self.opened = 0

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Future[Any]":
        self.calls += 1
        done: Future[Any] = Future()
        if self.calls in self.loses_at and self.refuses:
            raise BrokenProcessPool("a worker has gone")
        if self.calls in self.loses_at:
            done.set_exception(BrokenProcessPool("a worker has gone"))
        else:
            done.set_result(function(*arguments))
        return done

    def __enter__(self) -> Self:
        self.opened += 1
        return self

    def __exit__(self, *_: object) -> None:
        pass


@pytest.mark.parametrize("refuses", [False, True], ids=["loses its calls", "takes none"])
def test_an_executor_that_breaks_is_opened_again(points: tuple[Point, ...], *, refuses: bool) -> None:
    executor = Fragile(2, 6, refuses=refuses)
    found = _outcomes(points, errands.name_and_process, Workers(lambda: executor, lambda: 2))
    assert not any(isinstance(result, Failed) for result in found.values())
    assert executor.opened == 3


class Client:
    """A client of a Dask scheduler with one worker, whose answers to requests are given in order."""

    def __init__(self, *answers: Any) -> None:
        self.answers = iter(answers)

    def run(self, function: Callable[[], Any], *, on_error: str) -> dict[str, Any]:
        assert on_error == "return"
        answer = next(self.answers)
        if isinstance(answer, BaseException) and not isinstance(answer, ImportError):
            raise answer
        return {"tcp://10.0.0.2:1": function(), "tcp://10.0.0.3:1": answer}

    def get_executor(self, *, pure: bool) -> None:
        raise AssertionError


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (re.sub("numba [^,]*", "numba 0.1", versions()), "this worker has rubnoise .*, numba 0.1, "),
        (ModuleNotFoundError("No module named 'rubnoise'"), "this worker has no version that it says, and this"),
    ],
)
def test_a_worker_of_a_cluster_with_other_libraries_gets_no_work(answer: Any, said: str) -> None:
    with pytest.raises(Refused, match=rf"tcp://10\.0\.0\.3:1: {said}"), opened(Client(answer), None):
        pass
    assert re.sub("[ .0-9]", "", versions()) == "rubnoise,numpy,scipy,numba,stream,format"


@pytest.mark.slow
def test_who_watches_may_stop_it_and_no_process_stays(tmp_path: Path) -> None:
    processes: list[int] = []

    def stop_once_begun() -> None:
        if processes:
            raise RunStopped(2)

    points = _points(tmp_path, 500)
    with pytest.raises(RunStopped):  # noqa: PT012  (leaving is what is tested)
        for _, result in outcomes(deque(points), errands.name_and_process, local(2), stop_once_begun):
            processes.append(result[1])  # the watch looks at it meanwhile
    for process in processes:
        for _ in range(500):
            if not Path(f"/proc/{process}").exists():
                break
            time.sleep(0.01)
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


class Deserted(Here):
    """A scheduler that is gone."""

    def submit(self, *_: Any) -> "Future[Any]":
        lost: Future[Any] = Future()
        lost.set_exception(CancelledError())
        return lost


def test_work_that_nobody_has_any_more_ends_the_sweep(points: tuple[Point, ...]) -> None:
    with pytest.raises(WorkLost, match="the same command resumes the sweep"):
        _outcomes(points, errands.fail_some, Workers(Deserted, lambda: 1))


# Points run in memory are the runs that their scenarios say.
TABLE = "[sweep]\nreplicates = 2\n[sweep.grid]\ninterface.mean_junction_count = [10, 40]\n"


def test_replicates_are_independent_runs_of_one_theory(tmp_path: Path) -> None:
    table = TABLE.replace("replicates = 2", "replicates = 8")
    for count in (10, 40):
        points = [point for point in expand(sweep_of(tmp_path, table, "sliding.distance=3 mm"))
                  if point.values["interface.mean_junction_count"] == count]  # fmt: skip
        model = points[0].scenario.model()
        found = np.array([std_of(point, "real_contact_area") for point in points])
        error = standard_errors(model)["std"] / sqrt(len(points))
        assert abs(found.mean() - area_cumulants(model).std) <= 4.0 * error
        assert found.std(ddof=1) == pytest.approx(standard_errors(model)["std"], rel=1.2)
        assert np.unique(found).size == len(points)
