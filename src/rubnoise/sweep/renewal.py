"""When the index of a sweep is written anew: now and then while it goes on, and at its end."""

import time
from collections.abc import Sequence
from typing import Final

from rubnoise.scenario.points import Point
from rubnoise.scenario.sweep import Sweep
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.further import Further
from rubnoise.sweep.indexing import renew_index
from rubnoise.sweep.known import Known
from rubnoise.sweep.stock import Stock

EVERY: Final = 5.0
"""Seconds between two indices, at least."""

SHARE: Final = 0.02
"""The most of a sweep's time that goes into its index, but for the last one."""


class Renewal:
    """The index of a whole sweep, whoever makes its runs; shards write it at their end alone."""

    def __init__(self, folder: SweepFolder, sweep: Sweep, further: Further, command: str, *, alone: bool) -> None:
        """Stand before the first index."""
        self._folder = folder
        self._sweep = sweep
        self._command = command
        self._alone = alone
        self._further = further
        self._due = time.monotonic() + EVERY

    def if_due(self) -> None:
        """Write the index where the last one is old enough."""
        if self._alone and time.monotonic() >= self._due:
            began = time.monotonic()
            self.now()
            self._due = time.monotonic() + max(EVERY, (time.monotonic() - began) / SHARE)

    def now(self) -> tuple[Sequence[Point], Known]:
        """Write the index, and return its runs and what is known of them; another shard that writes it ends first."""
        with self._folder.alone_at("index"):
            points = self._points()
            return points, renew_index(self._folder, self._sweep, points, self._command)

    def _points(self) -> Sequence[Point]:
        if self._sweep.precision is not None:
            self._further(Stock.of(self._folder, self._sweep.precision).ended)
        return self._further.points
