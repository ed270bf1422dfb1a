"""A sweep from what is there already to its last run: the story of `rubnoise sweep`."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace

from rubnoise.errors import RunStopped
from rubnoise.scenario.points import Point
from rubnoise.scenario.sweep import Sweep
from rubnoise.sweep.engine import Course, Outcome, Workers
from rubnoise.sweep.folder import Shard, SweepFolder
from rubnoise.sweep.further import Further, Unmet
from rubnoise.sweep.journal import Entry, Journal
from rubnoise.sweep.known import Known
from rubnoise.sweep.renewal import Renewal
from rubnoise.sweep.rows import Row
from rubnoise.sweep.stock import Stock


class SweepStopped(RunStopped):
    """A sweep that a signal asked to stop."""

    def __str__(self) -> str:
        """Say that it can be gone on with."""
        return "stopped by a signal; what is done is kept, and the same command goes on from here"


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """How far a sweep is: runs that there will be, those done, failed, and done before it was begun this time."""

    runs: int
    done: int
    failed: int
    before: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Means:
    """How the runs of a sweep are made.

    ``work`` makes one, ``workers`` are called once there is work, ``recover`` finds what a run has left that nobody
    wrote down, ``affordable`` raises where the runs to be made need more than there is, ``watch`` is told how far the
    sweep is, several times a second, and may raise RunStopped.
    """

    work: Callable[[Point], Row]
    workers: Callable[[], AbstractContextManager[Workers]]
    recover: Callable[[Point], Row | None]
    affordable: Callable[[Sequence[Point]], None]
    watch: Callable[[Standing], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """What became of a sweep: its runs, what is known of them, and the points that ended short of their precision."""

    points: Sequence[Point]
    known: Known
    imprecise: Sequence[Unmet]


def conduct(
    folder: SweepFolder, sweep: Sweep, means: Means, *, shard: Shard | None = None, command: str = ""
) -> Ending:
    """Carry out what is still to be done of a sweep in its folder, and return what is known of its runs then.

    What is done is never done again: a run that the journals know, or whose result lies in its place; a run that failed
    is tried anew. Of a shard only its own runs are made. Raises OutputRefused for a folder of something else or in use,
    SweepStopped after a signal, WorkLost where a cluster is gone.
    """
    with folder.writing(shard):
        folder.claim(sweep)
        renewal = Renewal(folder, sweep, command, alone=shard is None)
        with Journal(folder.journal(shard)) as journal:
            conductor = _Conductor(folder, _part(sweep, shard), means, journal, renewal, shard)
            try:
                conductor.carry_out()
            except RunStopped as stopped:
                renewal.now()
                raise SweepStopped(stopped.exit_code - 128) from stopped
        points, known = renewal.now()
        return Ending(points=points, known=known, imprecise=conductor.imprecise)


def _part(sweep: Sweep, shard: Shard | None) -> Sweep:
    """Return what a shard goes through of a sweep with a precision: whole points, since it decides on them."""
    if shard is None or sweep.precision is None:
        return sweep
    return replace(sweep, cases=shard.of_cases(sweep.cases))


class _Conductor:
    """Goes from round to round until no more runs are wanted."""

    def __init__(
        self,
        folder: SweepFolder,
        sweep: Sweep,
        means: Means,
        journal: Journal,
        renewal: Renewal,
        shard: Shard | None,
    ) -> None:
        self.further = Further(sweep)
        self._means = means
        self._journal = journal
        self._renewal = renewal
        self._shard = None if sweep.precision else shard
        self._stock = Stock.of(folder, sweep.precision)

    def carry_out(self) -> None:
        """Take stock, then make what is missing, as long as anything is."""
        for point in self._wanted():
            if (row := self._means.recover(point)) is not None:
                self._done(point, row)
        if not (points := self._wanted()):
            return
        self._means.affordable(points)
        before = self._standing().done
        with self._means.workers() as workers:
            while points:
                self._make(points, workers, before)
                points = self._wanted()

    @property
    def imprecise(self) -> list[Unmet]:
        """The points that have all the replicates they may have, and too few for their precision."""
        return self.further.unmet(self._stock.ended)

    def _wanted(self) -> tuple[Point, ...]:
        points = self.further(self._stock.ended)
        return points if self._shard is None else self._shard.of_points(points, self.further.points)

    def _standing(self, before: int = 0) -> Standing:
        """Count the runs of this shard as they are planned by now."""
        points = self.further.points
        own = points if self._shard is None else self._shard.of_points(points, points)
        done, failed = (sum(point.run_id in ended for point in own) for ended in (self._stock.done, self._stock.failed))
        return Standing(runs=len(own), done=done, failed=failed, before=before)

    def _make(self, points: tuple[Point, ...], workers: Workers, before: int) -> None:
        """Carry out the points of a round."""
        standing = self._standing(before)

        def look_up() -> None:
            self._means.watch(standing)

        look_up()
        course = Course(points, self._means.work, workers, recover=self._means.recover, watch=look_up)
        for outcome in course.outcomes():
            went_well = self._write_down(outcome)
            standing = replace(standing, done=standing.done + went_well, failed=standing.failed + (not went_well))
            self._renewal.if_due()
        look_up()

    def _write_down(self, outcome: Outcome[Row]) -> bool:
        if outcome.result is not None:
            self._done(outcome.point, outcome.result)
            return True
        self._journal.add(Entry(run_id=outcome.point.run_id, state="failed", reason=_reason(outcome.problem)))
        self._stock.failed[outcome.point.run_id] = {}
        return False

    def _done(self, point: Point, row: Row) -> None:
        self._journal.add(Entry(run_id=point.run_id, state="done", row=row))
        self._stock.add(row)


def _reason(problem: Exception | None) -> str:
    """Return what is told of a problem; of one that is none of ours, its kind as well."""
    if problem is None:
        return "nothing came back"
    if type(problem).__module__.startswith("rubnoise."):
        return str(problem)
    return f"{type(problem).__name__}: {problem}"
