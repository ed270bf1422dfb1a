"""Make a sweep: the runs whose files are not there, round by round, and the index of all.

A run that another process is making is left to it. Who makes runs is an executor (see `executors`).
"""

import os
import re
import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import cache, partial
from math import inf, nan
from pathlib import Path
from shlex import join
from typing import Any, Final

from rubnoise.errors import OutputRefused, Refused, RunFileRefused, RunStopped
from rubnoise.regular_file import INDEX
from rubnoise.runs import executors
from rubnoise.runs.executors import Failed
from rubnoise.runs.folder import RUNS, Figures, file_of, found, index_of, known_runs, made, read
from rubnoise.scenario.sweep import Case, Point, Sweep, name_of, points_of, run_id
from rubnoise.storage.forecast import check_sweep_space
from rubnoise.storage.index import index_bytes
from rubnoise.storage.layout import this_command
from rubnoise.storage.output import OutputInUse, whole_file

Ended = Mapping[str, Mapping[str, float]]  # figures of the runs that have ended, by run id; a failed run has none


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
        self._settings, self._replicates = sweep.precision, sweep.replicates
        self._known = [(case, [*points_of([case], sweep.replicates)]) for case in sweep.cases]

    def __call__(self, ended: Ended) -> tuple[Point, ...]:
        """Return the needed runs that have not ended; none if every point has its precision or its last replicate."""
        batches = [self._batch(case, known, ended)[0] for case, known in self._known]
        return tuple(point for batch in batches for point in batch if point.run_id not in ended)

    @property
    def points(self) -> tuple[Point, ...]:
        """Every run that was needed so far, those of a point one after another."""
        return tuple(point for _, known in self._known for point in known)

    def unmet(self, ended: Ended) -> list[Unmet]:
        """Return the points whose needed runs have all ended without reaching their precision."""
        found, settings = [], self._settings
        for case, known in self._known:
            batch, values = self._batch(case, known, ended)
            if settings and values and (reached := settings.reached(values)) > (settings.precision or inf):
                found.append(Unmet(values=case.values, replicates=len(batch), reached=reached))
        return found

    def _batch(self, case: Case, known: list[Point], ended: Ended) -> tuple[list[Point], list[float]]:
        """Return all runs of a point up to the end of the first batch that has not ended, or of the last.

        If there is a precision and they have all ended, with the values that it is judged by.
        """
        batch, values, wanted = list[Point](), list[float](), self._replicates
        while len(batch) < wanted:
            if len(known) < wanted:
                known += points_of([case], wanted, len(known))
            batch, values = known[:wanted], []
            if self._settings and all(point.run_id in ended for point in batch):
                values = [ended[point.run_id].get(self._settings.quantity, nan) for point in batch]
                wanted = self._settings.wanted(values)
        return batch, values


# What belongs to a folder.
_SHARD: Final = re.compile(r"([1-9][0-9]{0,5})/([1-9][0-9]{0,5})")
_RUN: Final = re.compile(r"[0-9a-f]{16}(?:\.h5|\.npz)")


def check_folder(root: Path) -> None:
    """Raise OutputRefused if a path is no folder for a sweep: it cannot be written, or holds other files."""
    # A path that may not be looked at counts as missing here: it is the folder above that is closed.
    above = next(place for place in (root, *root.absolute().parents) if os.path.lexists(place))
    if not above.is_dir():
        raise OutputRefused(f"{above}: is no folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise OutputRefused(f"{above}: the folder is not writable")
    if above != root:
        return
    if not os.access(root, os.R_OK):
        raise OutputRefused(f"{root}: the folder is not readable")
    if not (root / RUNS).is_dir() and any(not entry.name.startswith(".") for entry in root.iterdir()):
        raise OutputRefused(f"{root}: is not a sweep folder, and not empty; name another folder")


def check_strangers(root: Path, sweep: Sweep, known: Collection[str]) -> None:
    """Raise OutputRefused if a folder holds the run of a scenario that the sweep lacks; ``known`` are its runs.

    Further replicates of its points are no strangers, damaged files are of no sweep.
    """
    cases, seed = {run_id(case.scenario): case for case in sweep.cases}, sweep.cases[0].scenario.run.seed
    there = sorted((root / RUNS).iterdir()) if (root / RUNS).is_dir() else []
    others = [path for path in there if _RUN.fullmatch(path.name) and path.stem not in known]
    more = cache(lambda name: {point.run_id for point in points_of([cases[name]], len(others) + len(known))})
    for path in others:
        with suppress(RunFileRefused):
            scenario, _ = read(path)
            name = "" if scenario is None else name_of(scenario.resolved(), seed)
            if name not in cases or path.stem not in more(name):
                holds = f"holds the runs of another scenario, such as {RUNS}/{path.name}"
                raise OutputRefused(f"{root}: {holds}; force=True leaves them beside the runs of this one")


def in_shard(shard: str, whole: Iterable[str]) -> set[str]:
    """Return the names in one of several parts of a whole, such as "2/8", whatever their order; raises Refused."""
    found = _SHARD.fullmatch(shard)
    if found is None or int(found[1]) > int(found[2]):
        raise Refused(f'shard=: "{shard[:20]}" is no part of a whole; right form: shard="2/8", from 1/8 to 8/8')
    return set(sorted(whole)[int(found[1]) - 1 :: int(found[2])])


# What is made.
EVERY: Final = 5.0  # least seconds between two indices
SHARE: Final = 0.02  # largest share of a sweep's time for its index, the last one not counted
PATIENCE: Final = 60.0  # seconds to wait for another process that writes the index
BETWEEN: Final = 0.2  # seconds between two tries


class SweepStopped(RunStopped):
    """A sweep was stopped by a signal."""

    def __str__(self) -> str:
        """Return the message that the sweep can be resumed."""
        return "stopped by a signal; finished runs are kept, and the same command resumes the sweep"


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepProgress:
    """The progress of a sweep: how many runs it has, and how many are done or failed."""

    runs: int
    done: int
    failed: int


Watching = Callable[[SweepProgress], None]


def carry_out(
    sweep: Sweep,
    folder: str | os.PathLike[str],
    *,
    jobs: int | None = None,
    executor: Any = None,
    shard: str | None = None,
    force: bool = False,
    command: Sequence[str] | None = None,
    watch: Watching = lambda _progress: None,
) -> list[Unmet]:
    """Make the missing runs of a sweep in its folder, write its index, and return the points without their precision.

    ``jobs``, ``executor``, ``shard`` and ``force`` are those of `rubnoise.sweep`, ``command`` is the command line in
    the results. ``watch`` is called with the progress several times a second, and may raise RunStopped. Raises Refused,
    OutputRefused, SweepStopped after a signal, WorkLost if a cluster is gone.
    """
    root = Path(folder).absolute()
    if isinstance(executor, str) and jobs is not None:
        raise Refused("jobs=: the workers of a cluster are its own; leave jobs= out")
    executors.local(jobs)  # which refuses what is no number
    check_folder(root)
    making = _Making(sweep, root, shard, command or this_command(), watch)
    if not force:
        planned = points_of(sweep.cases, max(sweep.replicates, making.replicates))
        check_strangers(root, sweep, {point.run_id for point in planned})
    try:
        making.make_all(jobs, executor)
    except RunStopped as stopped:
        making.end()
        raise SweepStopped(stopped.exit_code - 128) from stopped
    return making.end()


class _Making:
    """Makes runs, round by round, until no more runs are needed.

    ``_mine`` tells the runs of a shard, ``_before`` has those that an earlier index calls failed, ``_left`` those that
    other processes make.
    """

    def __init__(self, sweep: Sweep, root: Path, shard: str | None, command: Sequence[str], watch: Watching) -> None:
        self._sweep, self._root, self._command, self._watch = sweep, root, command, watch
        self._found, self._before, self.replicates = known_runs(root, sweep)
        self._failed, self._left = dict[str, str](), set[str]()
        self._runs = self._done = 0
        self._adaptive, self._mine = AdaptiveReplicates(sweep), _part_of(sweep, shard)
        self._due = time.monotonic() + EVERY if shard is None else inf  # a shard writes the index only at its end

    def make_all(self, jobs: int | None, executor: Any) -> None:
        """Take up the runs that are there, then make the missing ones until none is left."""
        if not (missing := self._missing()):
            return
        processes = (jobs or executors.processors()) if executor is None else 0
        scenarios = [point.scenario for point in missing]
        check_sweep_space(scenarios, self._root, jobs=processes, keep=self._sweep.keep)
        with executors.opened(executor, jobs, None if self._sweep.precision else len(missing)) as workers:
            (self._root / RUNS).mkdir(parents=True, exist_ok=True)
            work = partial(made, folder=self._root, keep=self._sweep.keep, command=self._command)
            if not workers.lanes():  # else a worker is stopped by who started it
                work = partial(work, watch=self._tell)
            self._tell()
            points, left = deque(missing), len(missing)
            with closing(executors.outcomes(points, work, workers, self._tell)) as outcomes:
                for point, result in outcomes:
                    self._record(point.run_id, result)
                    left -= 1
                    if not left:
                        points.extend(self._missing())
                        left = len(points)
            self._tell()

    def _missing(self, *, of_all: bool = False) -> list[Point]:
        """Take up the wanted runs that are there, of this shard or of all; return those that are not there."""
        missing, looked_for = list[Point](), set(self._left)
        while more := [point for point in self._adaptive(self._ended()) if point.run_id not in looked_for]:
            looked_for |= {point.run_id for point in more}
            missing += [point for point in more if (of_all or self._mine(point)) and not self._take_up(point)]
        own = [point.run_id for point in self._adaptive.points if self._mine(point) and point.run_id not in self._left]
        self._runs, self._done = len(own), sum(name in self._found for name in own)
        return missing

    def _tell(self, *_: object) -> None:
        failed = len(self._failed)
        self._watch(SweepProgress(runs=self._runs, done=self._done, failed=failed))

    def _ended(self) -> dict[str, Figures]:
        """Return the figures of every run that has ended; a failed run has none."""
        failed: dict[str, Figures] = {name: {} for name in self._failed}
        return failed | self._found

    def _take_up(self, point: Point) -> bool:
        """Take the figures of a run from its file, if it is there; whether it is known now."""
        path = file_of(self._root, point.run_id, self._sweep.keep)
        if point.run_id not in self._found:
            with suppress(OutputRefused, RunFileRefused):  # which is said of the run when it is to be made
                if (there := found(point, path)) is not None:
                    self._found[point.run_id] = there
        return point.run_id in self._found

    def _record(self, name: str, result: Figures | Failed | None) -> None:
        """Note the end of a run, and write the index if the last one is old enough."""
        self._before.pop(name, None)
        if result is None:
            self._left.add(name)
        elif isinstance(result, Failed):
            self._failed[name] = result
        else:
            self._found[name] = result
            self._done += 1
        if (began := time.monotonic()) >= self._due:
            with suppress(OutputInUse), whole_file(self._root / INDEX, force=True) as part:
                self._write_index(part)
            self._due = time.monotonic() + max(EVERY, (time.monotonic() - began) / SHARE)

    def end(self) -> list[Unmet]:
        """Write the index of everything that is there, also of what others have made."""
        (self._root / RUNS).mkdir(parents=True, exist_ok=True)
        last = time.monotonic() + PATIENCE
        while True:
            try:
                with whole_file(self._root / INDEX, force=True) as part:
                    known, before, _ = known_runs(self._root, self._sweep)
                    self._found, self._before = known | self._found, before | self._before
                    self._left.clear()
                    self._missing(of_all=True)
                    self._write_index(part)
                return [unmet for unmet in self._adaptive.unmet(self._ended()) if self._mine(unmet)]
            except OutputInUse:
                if time.monotonic() >= last:
                    raise
                time.sleep(BETWEEN)

    def _write_index(self, part: Path) -> None:
        failed, command = self._before | self._failed, join(self._command)
        part.write_bytes(index_bytes(index_of(self._sweep, self._adaptive.points, self._found, failed, command)))


def _part_of(sweep: Sweep, shard: str | None) -> Callable[[Any], bool]:
    """Return what tells whether a run is of a shard; with a precision a shard has whole points, since it decides."""
    if shard is None:
        return lambda _: True
    if sweep.precision:
        mine = in_shard(shard, [run_id(case.scenario) for case in sweep.cases])
        cases = {tuple(case.values.values()) for case in sweep.cases if run_id(case.scenario) in mine}
        return lambda point: tuple(point.values.values()) in cases
    runs = in_shard(shard, [point.run_id for point in points_of(sweep.cases, sweep.replicates)])
    return lambda point: point.run_id in runs
