"""Make a sweep: the runs whose files are not there, round by round, and the index of all.

A run that another process is making is left to it. Who makes runs is an executor (see `executors`).
"""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import partial
from math import inf, nan
from pathlib import Path
from shlex import join
from typing import Any, Final

from rubnoise.errors import OutputRefused, Refused, RubnoiseError, RunFileRefused, RunStopped
from rubnoise.regular_file import INDEX
from rubnoise.runs import executors
from rubnoise.runs.executors import Attempts, Outcome
from rubnoise.runs.folder import RUNS, Figures, Shard, check_folder, check_room, check_strangers, file_of, found, made
from rubnoise.runs.index import index_of, known_runs
from rubnoise.scenario.document import Sweeping
from rubnoise.scenario.sweep import Case, Point, Sweep, points_of
from rubnoise.storage.index import index_bytes
from rubnoise.storage.layout import this_command
from rubnoise.storage.output import OutputInUse, whole_file
from rubnoise.storage.reader import InUse

Ended = Mapping[str, Mapping[str, float]]
"""Figures of the runs that have ended, by run id; a failed run has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Unmet:
    """A point that has its largest number of replicates and not its precision."""

    values: Mapping[str, Any]
    replicates: int
    reached: float


class AdaptiveReplicates:
    """The rounds in which a sweep reaches its precision.

    Each point goes from batch to batch of its own replicates, always beginning with the first: its next runs depend
    only on their figures, however often the sweep was interrupted.
    """

    def __init__(self, sweep: Sweep) -> None:
        self.settings: Final = sweep.precision
        self._replicates = sweep.replicates
        self._known = [(case, list(points_of([case], sweep.replicates))) for case in sweep.cases]

    def __call__(self, ended: Ended) -> tuple[Point, ...]:
        """Return the needed runs that have not ended; none if every point has its precision or its last replicate."""
        batches = (self._batch(case, known, ended) for case, known in self._known)
        return tuple(point for batch in batches for point in batch if point.run_id not in ended)

    @property
    def points(self) -> tuple[Point, ...]:
        """Every run that was needed so far, those of a point one after another."""
        return tuple(point for _, known in self._known for point in known)

    def unmet(self, ended: Ended) -> list[Unmet]:
        """Return the points whose needed runs have all ended without reaching their precision."""
        found = []
        for case, known in self._known:
            batch = self._batch(case, known, ended)
            if self.settings is None or not _complete(batch, ended):
                continue
            reached = self.settings.reached(_values(self.settings, batch, ended))
            if reached > (self.settings.precision or inf):
                found.append(Unmet(values=case.values, replicates=len(batch), reached=reached))
        return found

    def _batch(self, case: Case, known: list[Point], ended: Ended) -> list[Point]:
        """Return all runs of a point up to the end of the first batch that is not complete, or of the last."""
        batch = known[: self._replicates]
        while self.settings and _complete(batch, ended):
            wanted = self.settings.wanted(_values(self.settings, batch, ended))
            if wanted == len(batch):
                break
            known += points_of([case], wanted, len(known))
            batch = known[:wanted]
        return batch


def _complete(batch: list[Point], ended: Ended) -> bool:
    return all(point.run_id in ended for point in batch)


def _values(settings: Sweeping, batch: list[Point], ended: Ended) -> list[float]:
    return [ended[point.run_id].get(settings.quantity, nan) for point in batch]


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


def carry_out(
    sweep: Sweep,
    folder: str | os.PathLike[str],
    *,
    jobs: int | None = None,
    executor: Any = None,
    shard: str | None = None,
    force: bool = False,
    command: Sequence[str] | None = None,
    watch: Callable[[SweepProgress], None] = lambda _progress: None,
) -> list[Unmet]:
    """Make the missing runs of a sweep in its folder, write its index, and return the points without their precision.

    ``jobs``, ``executor``, ``shard`` and ``force`` are those of `rubnoise.sweep`, ``command`` is the command line in
    the results. ``watch`` is called with the progress several times a second, and may raise RunStopped. Raises Refused,
    OutputRefused, SweepStopped after a signal, WorkLost if a cluster is gone.
    """
    root, part = Path(folder).absolute(), None if shard is None else Shard.of(shard)
    if isinstance(executor, str) and jobs is not None:
        raise Refused("jobs=: the workers of a cluster are its own; leave jobs= out")
    executors.local(jobs)  # which refuses what is no number
    check_folder(root)
    making = _Making(sweep, root, part, tuple(command or this_command()), watch)
    if not force:
        making.check_strangers()
    try:
        making.make_all(jobs, executor)
    except RunStopped as stopped:
        making.end()
        raise SweepStopped(stopped.exit_code - 128) from stopped
    return making.end()


class _Making:
    """Makes runs, round by round, until no more runs are needed."""

    def __init__(
        self,
        sweep: Sweep,
        root: Path,
        shard: Shard | None,
        command: tuple[str, ...],
        watch: Callable[[SweepProgress], None],
    ) -> None:
        self.sweep, self.root, self._command, self._watch = sweep, root, command, watch
        self.found, self._before, self._replicates = known_runs(root, sweep)
        self._failed: dict[str, str] = {}
        self._held: set[str] = set()
        self._runs = self._beside = self._already = 0
        self.adaptive = AdaptiveReplicates(shard.of_sweep(sweep) if shard is not None and sweep.precision else sweep)
        names = [point.run_id for point in self.adaptive.points]
        self._others = set(names) - shard.names(names) if shard is not None and not sweep.precision else set()
        self._due = time.monotonic() + EVERY if shard is None else inf  # a shard writes the index only at its end

    def check_strangers(self) -> None:
        """Raise OutputRefused for a folder with runs of other scenarios."""
        planned = points_of(self.sweep.cases, max(self.sweep.replicates, self._replicates))
        check_strangers(self.root, self.sweep, {point.run_id for point in planned})

    def make_all(self, jobs: int | None, executor: Any) -> None:
        """Take up the runs that are there, then make the missing ones until none is left."""
        if not (missing := self._missing()):
            return
        check_room(self.sweep, self.root, (jobs or executors.processors()) if executor is None else 0, missing)
        self._already = self._runs - len(missing)
        with executors.opened(executor, jobs, len(missing) if self.sweep.precision is None else None) as opened:
            (self.root / RUNS).mkdir(parents=True, exist_ok=True)
            work = partial(
                made,
                folder=self.root,
                keep=self.sweep.keep,
                command=self._command,
                watch=self._tell if opened.here else _unwatched,
            )
            self._tell()
            with closing(Attempts(missing, work, opened, self._tell, self._missing).outcomes()) as outcomes:
                for outcome in outcomes:
                    self._record(outcome)
                    self._refresh_if_due()
            self._tell()

    def _missing(self) -> list[Point]:
        """Return the wanted runs that are neither made now nor there; none if the sweep needs no more."""
        left, missing = self._others | self._held, list[Point]()
        while not missing and (points := [p for p in self.adaptive(self._ended()) if p.run_id not in left]):
            missing = [point for point in points if not self._take_up(point)]
        own = [point for point in self.adaptive.points if point.run_id not in self._others]
        self._runs, self._beside = len(own), len(self.found) - sum(point.run_id in self.found for point in own)
        return missing

    def _tell(self, *_: object) -> None:
        done = len(self.found) - self._beside
        self._watch(SweepProgress(runs=self._runs, done=done, failed=len(self._failed), before=self._already))

    def _ended(self) -> dict[str, Figures]:
        """Return the figures of every run that has ended; a failed run has none."""
        failed: dict[str, Figures] = {run_id: {} for run_id in self._failed}
        return failed | self.found

    def _take_up(self, point: Point) -> bool:
        """Take the figures of a run from its file, if it is there; whether it is known now."""
        path = file_of(self.root, point.run_id, self.sweep.keep)
        if point.run_id not in self.found:
            with suppress(OutputRefused, RunFileRefused):  # which is said of the run when it is to be made
                if (there := found(point, path)) is not None:
                    self.found[point.run_id] = there
        return point.run_id in self.found

    def _record(self, outcome: Outcome[Figures]) -> None:
        run_id, problem = outcome.point.run_id, outcome.problem
        self._before.pop(run_id, None)
        if outcome.result is not None:
            self.found[run_id] = outcome.result
        elif isinstance(problem, OutputInUse | InUse):
            self._held.add(run_id)
        else:
            kind = "" if isinstance(problem, RubnoiseError) else f"{type(problem).__name__}: "
            self._failed[run_id] = f"{kind}{problem}"

    def _refresh_if_due(self) -> None:
        """Write the index if the last one is old enough."""
        if (began := time.monotonic()) < self._due:
            return
        with suppress(OutputInUse):
            self._write_index(self.adaptive.points)
        self._due = time.monotonic() + max(EVERY, (time.monotonic() - began) / SHARE)

    def end(self) -> list[Unmet]:
        """Write the index of everything that is there, also of what others have made."""
        (self.root / RUNS).mkdir(parents=True, exist_ok=True)
        last = time.monotonic() + PATIENCE
        while True:
            try:
                self._write_index()
                return self.adaptive.unmet(self._ended())
            except OutputInUse:
                if time.monotonic() >= last:
                    raise
                time.sleep(BETWEEN)

    def _write_index(self, points: Sequence[Point] = ()) -> None:
        """Write the index over an older one, by default with all runs that are there now."""
        with whole_file(self.root / INDEX, force=True) as part:
            points = points or self._all_points()
            index = index_of(self.sweep, points, self.found, self._before | self._failed, join(self._command))
            part.write_bytes(index_bytes(index))

    def _all_points(self) -> Sequence[Point]:
        """Look for the runs of others, and return all runs that the sweep needs as far as is known."""
        known, before, _ = known_runs(self.root, self.sweep)
        self.found, self._before = known | self.found, before | self._before
        whole = AdaptiveReplicates(self.sweep)
        looked_for: set[str] = set()
        while more := [point for point in whole(self._ended()) if point.run_id not in looked_for]:
            looked_for |= {point.run_id for point in more if not self._take_up(point)}
        return whole.points


def _unwatched(*_: object) -> None:
    """Watch nothing: a worker is stopped by who started it."""
