"""Make a sweep: the runs whose files are not there, round by round, and the index of all.

A run that another process is making is left to it. Who makes runs is an executor (see `executors`).
"""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, closing, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from rubnoise.errors import OutputRefused, RubnoiseError, RunStopped
from rubnoise.runs.attempts import Attempts, Outcome
from rubnoise.runs.executors import Workers
from rubnoise.runs.folder import INDEX, RUNS, Shard, check_strangers
from rubnoise.runs.index import FAILED, index_of, known_runs, state_of
from rubnoise.runs.point_file import RunFigures, file_of, found, made
from rubnoise.runs.stopping_rule import AdaptiveReplicates, Unmet
from rubnoise.scenario.points import Point, points_of
from rubnoise.scenario.sweep import Sweep
from rubnoise.storage.index import index_bytes
from rubnoise.storage.output import OutputInUse, reason_of, whole_file
from rubnoise.storage.reader import InUse

EVERY: Final = 5.0
"""Least seconds between two indices."""

SHARE: Final = 0.02
"""Largest share of a sweep's time for its index, the last one not counted."""

PATIENCE: Final = 60.0
BETWEEN: Final = 0.2
"""Seconds to wait for another process that writes the index, and between two tries."""


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Means:
    """How the runs of a sweep are made.

    ``workers`` gives those for a number of runs if it is known, ``affordable`` raises if the missing runs need more
    space than there is, ``watch`` is called with the progress several times a second, and may raise RunStopped.
    ``command`` is the command line in the results; ``force`` leaves the runs of other scenarios where they are.
    """

    workers: Callable[[int | None], AbstractContextManager[Workers]]
    affordable: Callable[[Sequence[Point]], None]
    watch: Callable[[SweepProgress], None]
    command: Sequence[str]
    shown_command: str
    force: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepOutcome:
    """The outcome of a sweep: its runs, what became of each, and the points that did not reach their precision."""

    points: Sequence[Point]
    states: Sequence[str]
    reasons: Mapping[str, str]
    imprecise: Sequence[Unmet]

    @property
    def failures(self) -> list[tuple[Point, str]]:
        """The runs that failed, with the reasons."""
        pairs = zip(self.points, self.states, strict=True)
        return [(point, self.reasons[point.run_id]) for point, state in pairs if state == FAILED]


def carry_out(sweep: Sweep, root: Path, means: Means, shard: Shard | None = None) -> SweepOutcome:
    """Make the missing runs of a sweep in its folder, write its index, and return what became of all runs.

    A run that failed is tried again. A shard makes only its own runs. Raises OutputRefused for a folder with runs of
    other scenarios, SweepStopped after a signal, WorkLost if a cluster is gone.
    """
    conductor = _Conductor(sweep, root, means, shard)
    try:
        conductor.carry_out()
    except RunStopped as stopped:
        conductor.end()
        raise SweepStopped(stopped.exit_code - 128) from stopped
    return conductor.end()


class _Conductor:
    """Makes runs, round by round, until no more runs are needed."""

    def __init__(self, sweep: Sweep, root: Path, means: Means, shard: Shard | None) -> None:
        self.sweep, self.root, self._means, self._shard = sweep, root, means, shard
        self.found, before, replicates = known_runs(root, sweep)
        self._before = before
        self._failed: dict[str, str] = {}
        self._held: set[str] = set()
        self._already = 0
        self._unsynced: list[Path] = []
        own = shard.of_sweep(sweep) if shard is not None and sweep.precision else sweep
        self.adaptive = AdaptiveReplicates(own)
        self._due = time.monotonic() + EVERY
        if not means.force:
            planned = points_of(sweep.cases, max(sweep.replicates, replicates))
            check_strangers(root, sweep, {point.run_id for point in planned})

    def carry_out(self) -> None:
        """Take up the runs that are there, then make the missing ones until none is left."""
        if not (missing := self._missing()):
            return
        self._means.affordable(missing)
        self._already = len(self._own(self.adaptive.points)) - len(missing)
        with self._means.workers(len(missing) if self.sweep.precision is None else None) as workers:
            (self.root / RUNS).mkdir(parents=True, exist_ok=True)
            while missing:
                self._make(missing, workers)
                missing = self._missing()

    def _missing(self) -> list[Point]:
        """Return the wanted runs whose files are not there; none if the sweep needs no more."""
        while points := self._wanted():
            if missing := [point for point in points if not self._take_up(point)]:
                return missing
        return []

    def _wanted(self) -> list[Point]:
        """Return the runs of this shard that have not ended, and that no other process is making."""
        points = self.adaptive(self._figures())
        mine = {point.run_id for point in self._own(self.adaptive.points)}
        return [point for point in points if point.run_id in mine - self._held]

    def _own(self, points: Sequence[Point]) -> Sequence[Point]:
        if self._shard is None or self.sweep.precision:
            return points
        mine = self._shard.names(point.run_id for point in points)
        return [point for point in points if point.run_id in mine]

    def _figures(self) -> dict[str, dict[str, float]]:
        """Return the figure that a precision needs of every run that has ended; a failed run has none."""
        name = "" if self.sweep.precision is None else self.sweep.precision.quantity
        ended: dict[str, dict[str, float]] = {run_id: {} for run_id in self._failed}
        for run_id, figures in self.found.items():
            value = figures.get(name)
            ended[run_id] = {} if value is None else {name: value}
        return ended

    def _take_up(self, point: Point) -> bool:
        """Take the figures of a run from its file, if it is there; whether it is known now."""
        if point.run_id in self.found:
            return True
        with suppress(OutputRefused, InUse):  # which is said of the run when it is to be made
            there = found(point, file_of(self.root, point.run_id, self.sweep.keep))
            if there is not None:
                self.found[point.run_id] = there
                self._unsynced.append(file_of(self.root, point.run_id, self.sweep.keep))
        return point.run_id in self.found

    def _make(self, points: Sequence[Point], workers: Workers) -> None:
        """Make the runs of a round."""
        own = self._own(self.adaptive.points)
        failed = sum(point.run_id in self._failed for point in own)
        others = len(self.found) - (len(own) - len(points) - failed)

        def watch() -> None:
            done = len(self.found) - others
            self._means.watch(SweepProgress(runs=len(own), done=done, failed=len(self._failed), before=self._already))

        work = partial(
            made,
            folder=self.root,
            keep=self.sweep.keep,
            command=tuple(self._means.command),
            durable=workers.elsewhere,
            watch=(lambda _distance, _junctions, _live: watch()) if workers.here else _unwatched,
        )
        watch()
        with closing(Attempts(points, work, workers, watch).outcomes()) as outcomes:
            for outcome in outcomes:
                self._record(outcome)
                self._refresh_if_due()
        watch()

    def _record(self, outcome: Outcome[RunFigures]) -> None:
        run_id = outcome.point.run_id
        self._before.pop(run_id, None)
        if outcome.result is not None:
            self.found[run_id] = outcome.result
            self._unsynced.append(file_of(self.root, run_id, self.sweep.keep))
        elif isinstance(outcome.problem, OutputInUse | InUse):
            self._held.add(run_id)
        else:
            self._failed[run_id] = _reason(outcome.problem)

    def _refresh_if_due(self) -> None:
        """Write the index if the last one is old enough; a shard writes it only at its end."""
        if self._shard is not None or time.monotonic() < self._due:
            return
        began = time.monotonic()
        with suppress(OutputInUse):
            self._write_index(self.adaptive.points)
        self._due = time.monotonic() + max(EVERY, (time.monotonic() - began) / SHARE)

    def end(self) -> SweepOutcome:
        """Write the index of everything that is there, also of what others have made, and return the outcome."""
        (self.root / RUNS).mkdir(parents=True, exist_ok=True)
        last = time.monotonic() + PATIENCE
        while True:
            try:
                points = self._write_index()
                break
            except OutputInUse:
                if time.monotonic() >= last:
                    raise
                time.sleep(BETWEEN)
        failed = self._before | self._failed
        return SweepOutcome(
            points=points,
            states=[state_of(point.run_id, self.found, failed) for point in points],
            reasons=failed,
            imprecise=self.adaptive.unmet(self._figures()),
        )

    def _write_index(self, points: Sequence[Point] = ()) -> Sequence[Point]:
        """Write the index over an older one, by default with all runs that are there now, and return its runs."""
        with whole_file(self.root / INDEX, force=True) as part:
            points = points or self._all_points()
            self._sync()
            index = index_of(self.sweep, points, self.found, self._before | self._failed, self._means.shown_command)
            part.write_bytes(index_bytes(index))
        return points

    def _all_points(self) -> Sequence[Point]:
        """Look for the runs of others, and return all runs that the sweep needs as far as is known."""
        known, before, _ = known_runs(self.root, self.sweep)
        self.found, self._before = known | self.found, before | self._before
        whole = AdaptiveReplicates(self.sweep)
        looked_for: set[str] = set()
        while more := [point for point in whole(self._figures()) if point.run_id not in looked_for]:
            looked_for |= {point.run_id for point in more if not self._take_up(point)}
        return whole.points

    def _sync(self) -> None:
        """Flush the files of new runs to disk before an index calls them done, then their folder.

        A file that cannot be flushed is removed: it could look complete when read again, and never be on disk.
        """
        for path in self._unsynced:
            try:
                _flush(path)
            except OSError as problem:
                path.unlink(missing_ok=True)
                self.found.pop(path.stem, None)
                self._failed[path.stem] = f"{path}: writing failed: {reason_of(problem)}"
        if self._unsynced and hasattr(os, "O_DIRECTORY"):
            _flush(self.root / RUNS)
        self._unsynced.clear()


def _flush(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _unwatched(_distance: float, _junctions: int, _live: int) -> None:
    """Watch nothing: a worker is stopped by who started it."""


def _reason(problem: Exception | None) -> str:
    """Return the message of a problem, with its kind if it is not an error of rubnoise."""
    if problem is None or isinstance(problem, RubnoiseError):
        return str(problem or "nothing came back")
    return f"{type(problem).__name__}: {problem}"
