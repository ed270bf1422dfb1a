"""The status of the runs of a sweep (done, failed or begun): read from its journals, found as files, and recorded.

A run gets its line in the journal after its file is on disk. After a kill, results without a line are found.
"""

import json
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import HashedReader
from rubnoise.scenario.points import Point
from rubnoise.scenario.sweep_table import Precision
from rubnoise.storage import disk
from rubnoise.storage.reader import open_run
from rubnoise.storage.run_structure import INTERVENTION
from rubnoise.storage.sync_many import FileState, clear_unsynced, is_of_truncated, sync_many
from rubnoise.streams import STREAM_VERSION
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.journal import SYNC_EVERY, JournalEntry, RunRow, SweepJournal

Figures = Mapping[str, float]


@dataclass(slots=True)
class RunStatus:
    """Runs that are done, with the figure that a precision needs; runs that failed; runs that were begun."""

    quantity: str | None
    done: dict[str, Figures] = field(default_factory=dict)
    failed: dict[str, Figures] = field(default_factory=dict)
    begun: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, folder: SweepFolder, precision: Precision | None) -> Self:
        """Return the status from the journals; a run that is done counts if its file is still the one written then.

        Another file in its place must be examined first. Runs that failed before do not count either, since they are
        tried again.
        """
        status = cls(None if precision is None else precision.quantity)
        for entry in folder.entries():
            if entry.state == "begun":
                status.begun.add(entry.run_id)
            if entry.row is not None and folder.holds(entry):
                status.add(entry.row)
        return status

    def add(self, row: RunRow) -> None:
        """Add a run that is done."""
        known = self.quantity is not None and self.quantity in row.figures
        self.done[row.run_id] = {str(self.quantity): row.figures[str(self.quantity)]} if known else {}
        self.begun.discard(row.run_id)

    def fail(self, run_id: str) -> None:
        """Add a run that failed, also one that was counted as done before."""
        self.done.pop(run_id, None)
        self.failed[run_id] = {}

    @property
    def ended(self) -> dict[str, Figures]:
        """Runs that are done or failed."""
        return self.failed | self.done


PLANNED: Final = "planned"
DONE: Final = "done"


@dataclass(slots=True)
class RecordedRuns:
    """States, files, reasons and figures of the runs of a plan, in its order.

    ``arrays``: whether the journals have arrays, which are not kept here.
    """

    places: Mapping[str, int]
    states: list[str]
    files: list[str]
    reasons: list[str]
    figures: dict[str, NDArray[np.float64]]
    arrays: bool = False

    @classmethod
    def of(
        cls, folder: SweepFolder, points: Sequence[Point], counts: Callable[[JournalEntry], bool] | None = None
    ) -> Self:
        """Read the journals; for one run, an entry "done" counts more than an entry "failed".

        An entry "done" ``counts`` if its file is the one that was written then, unless the caller decides otherwise.
        """
        count = len(points)
        known = cls({p.run_id: n for n, p in enumerate(points)}, [PLANNED] * count, [""] * count, [""] * count, {})
        for entry in folder.entries():
            if entry.row is not None and not (counts or folder.holds)(entry):
                continue
            if entry.state != "begun" and (place := known.places.get(entry.run_id)) is not None:
                known._take(place, entry)
        return known

    def _take(self, place: int, entry: JournalEntry) -> None:
        if entry.row is None and self.states[place] == DONE:
            return
        self.states[place], self.reasons[place] = entry.state, entry.reason
        if entry.row is not None:
            self.files[place] = entry.row.file
            self.arrays = self.arrays or bool(entry.row.arrays or entry.row.of_point)
            for name, value in entry.row.figures.items():
                if name not in self.figures:
                    self.figures[name] = np.full(len(self.states), np.nan)
                self.figures[name][place] = value

    def count(self, state: str) -> int:
        """Return how many runs are in a state."""
        return self.states.count(state)


def found_run(point: Point, *, root: Path, begun: bool = False) -> RunRow | None:
    """Return the row of a run whose finished result exists at its path, or None.

    It belongs to the point if scenario, seed and stream version are equal; title and engine do not count. The whole
    file is read and compared with its hashes, since a power cut may have come before it was flushed. If the run was
    ``begun`` here, a truncated file, and a part that cannot be recovered, are removed.
    """
    folder = SweepFolder(root)
    path = folder.run(point.run_id)
    row, state = _found(point, folder, begun=begun) if path.exists() else (None, None)
    if begun:
        clear_unsynced(path, state)
    return row


def _found(point: Point, folder: SweepFolder, *, begun: bool) -> tuple[RunRow | None, FileState]:
    try:
        with open_run(folder.run(point.run_id)) as file:
            state, summary = _state(point, file, begun=begun), file.summary
    except RunFileRefused as refusal:
        return None, "truncated" if is_of_truncated(refusal) else "other"
    if state != "intact":
        return None, state
    figures = {name: float(value) for name, value in summary.items() if isinstance(value, int | float)}
    return RunRow(run_id=point.run_id, file=folder.relative(point.run_id), figures=figures), state


def _state(point: Point, file: HashedReader, *, begun: bool) -> FileState:
    origin = file.provenance
    if origin["stream_version"] != STREAM_VERSION or not _is_same(str(origin["scenario_resolved"]), point):
        return "other"
    if INTERVENTION in origin:  # with lives ended from outside it is no sample of the scenario
        return "other"
    # HDF5 has checksums for data shorter than a page, and columns have hashes; a longer text has neither.
    lost = begun and origin["scenario_toml"] != point.scenario.text
    return "truncated" if lost or not origin["finished"] or not file.summary or file.damaged() else "intact"


def _is_same(resolved: str, point: Point) -> bool:
    try:
        return _told(json.loads(resolved)) == _told(point.scenario.resolved())
    except (ValueError, TypeError, KeyError):
        return False


def _told(resolved: dict[str, Any]) -> dict[str, Any]:
    """Return the part of a scenario that determines the bits of its run."""
    run = {key: value for key, value in resolved["run"].items() if key != "engine"}
    return {key: value for key, value in resolved.items() if key != "title"} | {"run": run}


class StatusLog:
    """The journal of a sweep and the status of its runs, kept in step.

    A kill between a run's end and its line in the journal costs nothing: the file is found and compared with its
    hashes. A power cut may leave truncated files; those of runs that were begun here are removed.
    """

    def __init__(self, folder: SweepFolder, journal: SweepJournal, status: RunStatus) -> None:
        """Continue with the status in the folder."""
        self.status: Final = status
        self._folder = folder
        self._journal = journal
        self._waiting: list[RunRow] = []
        self._synced_at = time.monotonic()

    def begin(self, points: Iterable[Point]) -> None:
        """Record, with fsync, the runs to be made whose files are flushed later."""
        names = [point.run_id for point in points]
        fresh = [name for name in names if name not in self.status.begun and not self._folder.run(name).exists()]
        self.status.begun.update(fresh)
        self._journal.add(*(JournalEntry(run_id=name, state="begun") for name in fresh))
        self._journal.sync()

    def done(self, row: RunRow, *, synced: bool) -> None:
        """Add a run that is done; unless it is ``synced``, its line waits until its file is flushed."""
        self.status.add(row)
        if synced:
            self._journal.add(self._entry(row))
        else:
            self._waiting.append(row)

    def failed(self, run_id: str, reason: str) -> None:
        """Add a run that could not be made."""
        self.status.fail(run_id)
        self._journal.add(JournalEntry(run_id=run_id, state="failed", reason=reason))

    def sync_if_due(self) -> bool:
        """Sync the waiting runs if the last sync is long enough ago; return whether any failed."""
        return time.monotonic() - self._synced_at >= SYNC_EVERY and self.sync()

    def sync(self) -> bool:
        """Flush the waiting files to disk, then record their runs; return whether any failed.

        A file that could not be flushed is removed: it could look complete when read again, and never be on disk.
        """
        rows = {self._folder.root / row.file: row for row in self._waiting}
        wrong = sync_many(rows)
        self._journal.add(*(self._entry(row) for path, row in rows.items() if path not in wrong))
        self._waiting.clear()
        for path, problem in wrong.items():
            with suppress(OSError):
                disk.remove(path)
            self.failed(rows[path].run_id, f"{path}: writing failed: {problem.strerror or problem}")
        self._synced_at = time.monotonic()
        return bool(wrong)

    def _entry(self, row: RunRow) -> JournalEntry:
        stamp = self._folder.stamp(row.run_id) if row.file else None
        return JournalEntry(run_id=row.run_id, state="done", row=row, stamp=stamp)
