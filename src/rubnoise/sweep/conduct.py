"""Carry out a sweep, from the runs that exist already to the last one: the course of `rubnoise sweep`."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Protocol

from rubnoise.errors import RunStopped
from rubnoise.scenario.points import Point
from rubnoise.scenario.sweep import Sweep
from rubnoise.sweep.execution import Execution, Outcome, Workers
from rubnoise.sweep.folder import Shard, SweepFolder
from rubnoise.sweep.index import IndexRefresh
from rubnoise.sweep.journal import RunRow, SweepJournal
from rubnoise.sweep.run_status import RecordedRuns, RunStatus, StatusLog
from rubnoise.sweep.stopping_rule import AdaptiveReplicates, Unmet


class SweepStopped(RunStopped):
    """A sweep was stopped by a signal."""

    def __str__(self) -> str:
        """Return the message that the sweep can be resumed."""
        return "stopped by a signal; finished runs are kept, and the same command resumes the sweep"


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepProgress:
    """The progress of a sweep: how many runs it has, how many are done or failed, and how many were done before."""

    runs: int
    done: int
    failed: int
    before: int


class FindUnrecorded(Protocol):
    """Finds the result of a run that no journal lists."""

    def __call__(self, point: Point, *, begun: bool) -> RunRow | None:
        """Return its row, or None; ``begun``: a truncated file was made by this sweep, and may be removed."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepMeans:
    """The functions that make the runs of a sweep.

    ``work`` makes one run, ``workers`` starts workers once there is work, ``recover`` finds the result of a run that no
    journal lists, if runs leave results, ``affordable`` raises if the missing runs need more space than there is,
    ``watch`` is called with the progress several times a second, and may raise RunStopped. Unless ``synced``, the
    sweep flushes the files of ``work`` to disk.
    """

    work: Callable[[Point], RunRow]
    workers: Callable[[], AbstractContextManager[Workers]]
    recover: FindUnrecorded | None
    affordable: Callable[[Sequence[Point]], None]
    watch: Callable[[SweepProgress], None]
    synced: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepOutcome:
    """The outcome of a sweep: its runs, their status, and the points that did not reach their precision."""

    points: Sequence[Point]
    known: RecordedRuns
    imprecise: Sequence[Unmet]


def conduct(
    folder: SweepFolder, sweep: Sweep, means: SweepMeans, *, shard: Shard | None = None, command: str = ""
) -> SweepOutcome:
    """Make the missing runs of a sweep in its folder, and return the status of all runs.

    A run is not made again if a journal lists it as done or its result exists; a run that failed is tried again. A
    shard makes only its own runs. Raises OutputRefused for a folder of something else or in use, SweepStopped
    after a signal, WorkLost if a cluster is gone.
    """
    with folder.writing(shard):
        sweep = folder.claim(sweep)
        adaptive = AdaptiveReplicates(sweep)
        refresh = IndexRefresh(folder, sweep, adaptive, command, alone=shard is None)
        with SweepJournal(folder.journal(shard)) as journal:
            log = StatusLog(folder, journal, RunStatus.of(folder, sweep.precision))
            conductor = _Conductor(_part(adaptive, sweep, shard), means, log, refresh, shard)
            try:
                conductor.carry_out()
            except RunStopped as stopped:
                refresh.now()
                raise SweepStopped(stopped.exit_code - 128) from stopped
        points, known = refresh.now()
        return SweepOutcome(points=points, known=known, imprecise=conductor.imprecise)


def _part(adaptive: AdaptiveReplicates, sweep: Sweep, shard: Shard | None) -> AdaptiveReplicates:
    """Return the part of a shard in a sweep with a precision: whole points, since the shard decides on them."""
    if shard is None or sweep.precision is None:
        return adaptive
    return AdaptiveReplicates(replace(sweep, cases=shard.of_cases(sweep.cases)))


class _Conductor:
    """Makes runs, round by round, until no more runs are needed."""

    def __init__(
        self,
        adaptive: AdaptiveReplicates,
        means: SweepMeans,
        log: StatusLog,
        refresh: IndexRefresh,
        shard: Shard | None,
    ) -> None:
        self.adaptive = adaptive
        self._means = means
        self._log = log
        self._refresh = refresh
        self._shard = None if adaptive.precision else shard
        self._before = 0
        self._now = SweepProgress(runs=0, done=0, failed=0, before=0)

    def carry_out(self) -> None:
        """Record the runs that exist, then make the missing ones until none is left."""
        self._record_found()
        if not (points := self._wanted()):
            return
        self._means.affordable(points)
        self._before = self._progress().done
        with self._means.workers() as workers:
            while points:
                self._make(points, workers)
                points = self._wanted()

    def _record_found(self) -> None:
        """Record results that exist and that no journal lists."""
        self._now = self._progress()
        try:
            for point in self._wanted():
                if (row := self._recover(point)) is not None:
                    self._log.done(row, synced=not row.file)
                    self._update()
        finally:
            self._log.sync()

    @property
    def imprecise(self) -> list[Unmet]:
        """The points that have their largest number of replicates and not their precision."""
        return self.adaptive.unmet(self._log.status.ended)

    def _wanted(self) -> tuple[Point, ...]:
        points = self.adaptive(self._log.status.ended)
        return points if self._shard is None else self._shard.of_points(points, self.adaptive.points)

    def _progress(self) -> SweepProgress:
        """Count the runs of this shard as planned so far."""
        points = self.adaptive.points
        own = points if self._shard is None else self._shard.of_points(points, points)
        status = self._log.status
        done, failed = (sum(point.run_id in ended for point in own) for ended in (status.done, status.failed))
        return SweepProgress(runs=len(own), done=done, failed=failed, before=self._before)

    def _make(self, points: tuple[Point, ...], workers: Workers) -> None:
        """Make the runs of a round."""
        self._now = self._progress()
        self._means.watch(self._now)
        if not self._means.synced:
            self._log.begin(points)
        execution = Execution(points, self._means.work, workers, recover=self._recover, watch=self._update)
        try:
            for outcome in execution.outcomes():
                self._record(outcome)
                self._refresh.if_due()
        finally:
            self._log.sync()
        self._now = self._progress()
        self._means.watch(self._now)

    def _recover(self, point: Point) -> RunRow | None:
        if self._means.recover is None:
            return None
        return self._means.recover(point, begun=point.run_id in self._log.status.begun)

    def _update(self) -> None:
        if self._log.sync_if_due():
            self._now = self._progress()
        self._means.watch(self._now)

    def _record(self, outcome: Outcome[RunRow]) -> None:
        if outcome.result is not None:
            self._log.done(outcome.result, synced=self._means.synced)
            self._now = replace(self._now, done=self._now.done + 1)
        else:
            self._log.failed(outcome.point.run_id, _reason(outcome.problem))
            self._now = replace(self._now, failed=self._now.failed + 1)


def _reason(problem: Exception | None) -> str:
    """Return the message of a problem, with its kind if it is not an error of rubnoise."""
    if problem is None:
        return "nothing came back"
    if type(problem).__module__.startswith("rubnoise."):
        return str(problem)
    return f"{type(problem).__name__}: {problem}"
