"""What a terminal shows while a sweep is under way, and how a signal stops it."""

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from rubnoise.cli.progress import SIGNALS, clock
from rubnoise.cli.status import StatusLine
from rubnoise.errors import RunStopped

if TYPE_CHECKING:
    from rubnoise.sweep.conduct import SweepProgress


class SweepWatcher:
    """Told several times a second how far a sweep is: shows it, and raises RunStopped after a signal."""

    def __init__(self, line: StatusLine) -> None:
        """Watch a sweep that has not begun."""
        self._line = line
        self._began: float | None = None
        self.stopped_by: int | None = None

    def __call__(self, standing: "SweepProgress") -> None:
        """Take note of how far the sweep is."""
        if self.stopped_by is not None:
            raise RunStopped(self.stopped_by)
        self._began = self._began or time.monotonic()
        self._line.tell(_text(standing, time.monotonic() - self._began))

    def interrupt(self, number: int, _frame: FrameType | None) -> None:
        """Take note of a signal; obey it at once where nothing has begun, and leave at once at the second one."""
        for each in SIGNALS:
            signal.signal(each, signal.SIG_DFL)
        self.stopped_by = number
        if self._began is None:
            raise RunStopped(number)


def _text(standing: "SweepProgress", seconds: float) -> str:
    ended = standing.done + standing.failed
    text = f"{ended / max(standing.runs, 1):4.0%}  {ended:,} of {standing.runs:,} runs"
    if standing.failed:
        text += f", {standing.failed:,} failed"
    if new := ended - standing.before:
        text += f"  {clock(seconds * (standing.runs - ended) / new)} to go"
    return text


@contextmanager
def watching_sweep(*, shown: bool) -> Iterator[SweepWatcher]:
    """Watch a sweep; SIGINT and SIGTERM stop it within moments, a second one leaves at once."""
    with StatusLine(shown=shown) as line:
        watcher = SweepWatcher(line)
        before = {each: signal.signal(each, watcher.interrupt) for each in SIGNALS}
        try:
            yield watcher
        finally:
            for each, handler in before.items():
                signal.signal(each, handler)
