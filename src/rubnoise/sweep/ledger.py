"""What became of runs, written down: of a run with a file once the disk has that, those of a second together."""

import time
from collections.abc import Iterable
from contextlib import suppress
from typing import Final

from rubnoise.scenario.points import Point
from rubnoise.storage import disk
from rubnoise.storage.together import settle
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.journal import SYNC_EVERY, Entry, Journal
from rubnoise.sweep.rows import Row
from rubnoise.sweep.stock import Stock


class Ledger:
    """The journal of a sweep and the stock of what has ended, kept in step.

    A kill between a run's end and its line in the journal costs nothing: its file is found, and compared with its
    hashes. A power cut may leave files that are torn; those of runs that had been begun here are cleared away.
    """

    def __init__(self, folder: SweepFolder, journal: Journal, stock: Stock) -> None:
        """Go on with what is there."""
        self.stock: Final = stock
        self._folder = folder
        self._journal = journal
        self._waiting: list[Row] = []
        self._settled_at = time.monotonic()

    def begin(self, points: Iterable[Point]) -> None:
        """Write down, on the disk, that runs are to be made whose files the disk will have only later."""
        names = [point.run_id for point in points]
        fresh = [name for name in names if name not in self.stock.begun and not self._folder.run(name).exists()]
        self.stock.begun.update(fresh)
        self._journal.add(*(Entry(run_id=name, state="begun") for name in fresh))
        self._journal.sync()

    def done(self, row: Row, *, settled: bool) -> None:
        """Take in a run that is done; unless it is ``settled``, its line waits until the disk has its file."""
        self.stock.add(row)
        if settled:
            self._journal.add(self._entry(row))
        else:
            self._waiting.append(row)

    def failed(self, run_id: str, reason: str) -> None:
        """Take in a run that could not be made."""
        self.stock.fail(run_id)
        self._journal.add(Entry(run_id=run_id, state="failed", reason=reason))

    def settle_if_due(self) -> bool:
        """Settle what waits, when the last time is long enough ago; return whether runs turned out to have failed."""
        return time.monotonic() - self._settled_at >= SYNC_EVERY and self.settle()

    def settle(self) -> bool:
        """See the files onto the disk that wait for it, then write down their runs; return whether any failed by it.

        A file with which that went wrong goes: read again it might look whole, and never be on the disk.
        """
        rows = {self._folder.root / row.file: row for row in self._waiting}
        wrong = settle(rows)
        self._journal.add(*(self._entry(row) for path, row in rows.items() if path not in wrong))
        self._waiting.clear()
        for path, problem in wrong.items():
            with suppress(OSError):
                disk.remove(path)
            self.failed(rows[path].run_id, f"{path}: writing failed: {problem.strerror or problem}")
        self._settled_at = time.monotonic()
        return bool(wrong)

    def _entry(self, row: Row) -> Entry:
        stamp = self._folder.stamp(row.run_id) if row.file else None
        return Entry(run_id=row.run_id, state="done", row=row, stamp=stamp)
