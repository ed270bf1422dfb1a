"""What a terminal shows while a run is under way, and how a signal stops it."""

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from rubnoise.errors import RunStopped

SIGNALS = (signal.SIGINT, signal.SIGTERM)
_BETWEEN = 0.1


class Watcher:
    """Told after every panel how far a run is: shows it on a terminal, and raises RunStopped after a signal."""

    def __init__(self, distance: float, *, shown: bool) -> None:
        """Watch a run of a length in um; shown: whether to say anything."""
        self._distance = distance
        self._shown = shown
        self._began = self._last = time.monotonic()
        self._width = 0
        self.stopped_by: int | None = None

    def __call__(self, distance: float, junctions: int, live: int) -> None:
        """Take note of the distance reached (um), the junctions born so far and the live count."""
        if self.stopped_by is not None:
            raise RunStopped(self.stopped_by)
        now = time.monotonic()
        if self._shown and now - self._last >= _BETWEEN:
            self._last = now
            self._show(distance, junctions, live, now - self._began)

    def _show(self, distance: float, junctions: int, live: int, elapsed: float) -> None:
        share = min(distance / self._distance, 1.0)
        rest = elapsed * (1.0 - share) / share if share > 0.0 else 0.0
        text = (
            f"{share:4.0%}  {distance / 1000.0:.6g} mm  {junctions:,} junctions, {live:,} alive  {_clock(rest)} to go"
        )
        self._write(text)

    def _write(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

    def clear(self) -> None:
        """Leave the terminal's line empty."""
        if self._width:
            self._write("")
            sys.stderr.write("\r")
            sys.stderr.flush()


@contextmanager
def watching(distance: float, *, shown: bool) -> Iterator[Watcher]:
    """Watch a run; SIGINT and SIGTERM stop it at its next panel, a second one leaves at once."""
    watcher = Watcher(distance, shown=shown)

    def stop(number: int, _frame: FrameType | None) -> None:
        watcher.stopped_by = number
        for each in SIGNALS:
            signal.signal(each, signal.SIG_DFL)

    before = {each: signal.signal(each, stop) for each in SIGNALS}
    try:
        yield watcher
    finally:
        watcher.clear()
        for each, handler in before.items():
            signal.signal(each, handler)


def on_terminal() -> bool:
    """Whether somebody watches stderr."""
    return sys.stderr.isatty()


def announce_compilation() -> None:
    """Say once that the kernels are being compiled, where no compiled ones are kept yet."""
    from rubnoise.simulation import kernels

    kept = Path(kernels.deposit_areas.stats.cache_path)
    if not any(kept.glob("kernels.deposit_areas-*.nbi")):
        print("Compiling the kernels; this happens once and takes some seconds.", file=sys.stderr)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
