"""Show the progress of a run or a sweep on a terminal, and stop it after a signal."""

import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, ParamSpec, Self

from rubnoise.cli.layout import cut
from rubnoise.errors import RunStopped

if TYPE_CHECKING:
    from rubnoise.runs.sweep import SweepProgress
    from rubnoise.storage.reader import RunFile

SIGNALS = (signal.SIGINT, signal.SIGTERM)
_BETWEEN = 0.1
_FIRST = 1.0
"""Seconds between two looks at a terminal, and before the first if most files take less."""
_A_MOMENT = 0.01
"""Seconds."""

Given = ParamSpec("Given")


class StatusLine:
    """Shows one text on a terminal, which replaces the one before; nothing if ``shown`` is False."""

    def __init__(self, *, shown: bool, first: float = 0.0) -> None:
        """Start with an empty line; ``first``: seconds before the first text that `show_now_and_then` shows."""
        self._shown = shown
        self._width = 0
        self._shown_at = time.monotonic() + first - _BETWEEN if first else 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.clear()

    def show(self, text: str) -> None:
        """Show a text, which replaces the present one."""
        if self._shown:
            text = cut(text, sys.stderr)
            sys.stderr.write("\r" + text.ljust(self._width))
            sys.stderr.flush()
            self._width = len(text)

    def show_now_and_then(self, text: Callable[[], str]) -> None:
        """Show a text, unless there was one a moment ago."""
        now = time.monotonic()
        if self._shown and now - self._shown_at >= _BETWEEN:
            self._shown_at = now
            self.show(text())

    def clear(self) -> None:
        """Clear the line."""
        if self._width:
            self.show("")
            sys.stderr.write("\r")
            sys.stderr.flush()
            self._width = 0


class Watcher:
    """Shows the progress of a run on a terminal, and raises RunStopped after a signal.

    It is called at the start and after every range of ticks. Before the start, while births are counted, no file exists
    yet, so a signal stops the program at once.
    """

    def __init__(self, distance: float, *, shown: bool) -> None:
        """Watch a run of a length in um; ``shown``: whether to print its progress."""
        self._distance = distance
        self.line = StatusLine(shown=shown)
        self._began: float | None = None
        self._origin = 0.0
        self.stopped_by: int | None = None

    def __call__(self, distance: float, junctions: int, live: int) -> None:
        """Note the distance reached (um), the junctions born so far and the live count."""
        if self.stopped_by is not None:
            raise RunStopped(self.stopped_by)
        now = time.monotonic()
        self.line.show_now_and_then(lambda: self._text(distance, junctions, live, self._rest(distance, now)))
        if self._began is None or self._origin == 0.0 < distance:
            # Kernels may be compiled for the first range of ticks: the remaining time is shown from the second on.
            self._began, self._origin = now, distance

    def interrupt(self, number: int) -> None:
        """Note a signal, and stop at once if the run has not begun."""
        self.stopped_by = number
        if self._began is None:
            raise RunStopped(number)

    def counting(self) -> None:
        """Show that births are being counted, which takes a while for millions of them."""
        self.line.show("counting the births")

    def _text(self, distance: float, junctions: int, live: int, rest: str) -> str:
        share = min(distance / self._distance, 1.0)
        reached, whole = distance / 1000.0, self._distance / 1000.0
        text = f"{share:4.0%}  {reached:.6g} of {whole:.6g} mm"
        longer = f"{text}  {junctions:,} junctions, {live:,} alive{rest}"
        return longer if cut(longer, sys.stderr) == longer else text + rest

    def _rest(self, distance: float, now: float) -> str:
        if self._began is None or distance <= self._origin or self._origin == 0.0:
            return ""
        rest = (now - self._began) * max(self._distance - distance, 0.0) / (distance - self._origin)
        return f"  {clock(rest)} to go"


@contextmanager
def watching_reads(run: "RunFile", *, shown: bool) -> Iterator[None]:
    """Show on a terminal which column of a file is being read, if that takes a while."""
    if not shown:
        yield
        return
    with StatusLine(shown=True, first=_FIRST) as line:

        def watch(column: str, row: int, rows: int) -> None:
            line.show_now_and_then(lambda: f"{column}: {row:,} of {rows:,} rows")

        run.watch = watch
        try:
            yield
        finally:
            run.watch = None


def interrupted_at_once(command: Callable[Given, None]) -> Callable[Given, None]:
    """Let SIGINT end the process directly as long as a command has made no file and is not watched yet.

    Python's own way, an exception at any place, gets lost in libraries that are being loaded.
    """

    @wraps(command)
    def called(*given: Given.args, **named: Given.kwargs) -> None:
        if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            command(*given, **named)
            return
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        try:
            command(*given, **named)
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    return called


@contextmanager
def _at_first_signal(note: Callable[[int], None]) -> Iterator[None]:
    """Call a function with the number of the first SIGINT or SIGTERM; a second signal ends the process at once.

    An exception would get lost in a function that the compiler calls; in that case the call is made a moment later.
    """

    def noted(number: int, frame: FrameType | None) -> None:
        for each in SIGNALS:
            signal.signal(each, signal.SIG_DFL)
        if _is_called_by_compiler(frame):
            signal.signal(signal.SIGALRM, lambda _, later: noted(number, later))
            signal.setitimer(signal.ITIMER_REAL, _A_MOMENT)
        else:
            note(number)

    before = {each: signal.signal(each, noted) for each in SIGNALS}
    alarm = signal.getsignal(signal.SIGALRM)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, alarm)
        for each, handler in before.items():
            signal.signal(each, handler)


def _is_called_by_compiler(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_globals.get("__name__", "").startswith("llvmlite."):
            return True
        frame = frame.f_back
    return False


@contextmanager
def watching(distance: float, *, shown: bool) -> Iterator[Watcher]:
    """Watch a run; SIGINT and SIGTERM stop it after the present range of ticks, a second signal stops it at once."""
    watcher = Watcher(distance, shown=shown)
    with _at_first_signal(watcher.interrupt):
        try:
            yield watcher
        finally:
            watcher.line.clear()


@contextmanager
def stoppable() -> Iterator[Callable[[], None]]:
    """Yield a function to call between pieces of work: it raises RunStopped after SIGINT or SIGTERM.

    It raises nowhere else, since an exception gets lost in a library that is being loaded.
    """
    numbers: list[int] = []

    def between() -> None:
        if numbers:
            raise RunStopped(numbers[0])

    with _at_first_signal(numbers.append):
        yield between


def on_terminal() -> bool:
    """Whether stderr is a terminal."""
    return sys.stderr.isatty()


def announce_compilation() -> None:
    """Print a message, once, when this process begins to compile kernels without kept machine code."""
    from rubnoise.compiling import before_compiling

    before_compiling(_say_compiling)


def announce_compilation_by_workers() -> None:
    """Print a message that workers will compile the kernels, if their machine code is not kept yet."""
    from rubnoise.compiling import is_kept
    from rubnoise.simulation.kernel import add_areas

    if not is_kept(add_areas):
        _say_compiling()


@cache
def _say_compiling() -> None:
    begin = "\r" if on_terminal() else ""  # over what a terminal shows of the run
    print(
        f"{begin}Compiling the kernels of this kind of motion; this happens once and takes up to a minute.",
        file=sys.stderr,
    )


def clock(seconds: float) -> str:
    """Return a time as minutes and seconds, or hours with them."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


class SweepWatcher:
    """Shows the progress of a sweep several times a second, and raises RunStopped after a signal."""

    def __init__(self, line: StatusLine) -> None:
        """Watch a sweep that has not begun."""
        self._line = line
        self._began: float | None = None
        self.stopped_by: int | None = None

    def __call__(self, progress: "SweepProgress") -> None:
        """Note the progress of the sweep."""
        if self.stopped_by is not None:
            raise RunStopped(self.stopped_by)
        self._began = self._began or time.monotonic()
        self._line.show(_text(progress, time.monotonic() - self._began))

    def interrupt(self, number: int) -> None:
        """Note a signal; stop at once if the sweep has not begun."""
        self.stopped_by = number
        if self._began is None:
            raise RunStopped(number)


def _text(progress: "SweepProgress", seconds: float) -> str:
    ended = progress.done + progress.failed
    text = f"{ended / max(progress.runs, 1):4.0%}  {ended:,} of {progress.runs:,} runs"
    if progress.failed:
        text += f", {progress.failed:,} failed"
    if new := ended - progress.before:
        text += f"  {clock(seconds * (progress.runs - ended) / new)} to go"
    return text


@contextmanager
def watching_sweep(*, shown: bool) -> Iterator[SweepWatcher]:
    """Watch a sweep; SIGINT and SIGTERM stop it within moments, a second signal ends the process at once."""
    with StatusLine(shown=shown) as line:
        watcher = SweepWatcher(line)
        with _at_first_signal(watcher.interrupt):
            yield watcher
