"""Show on a terminal how far a run, a sweep or a look through a file is, and stop after a signal."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache, wraps
from types import FrameType
from typing import TYPE_CHECKING, Final, ParamSpec

from rubnoise.errors import RunStopped

if TYPE_CHECKING:
    from rubnoise.runs.sweep import SweepProgress
    from rubnoise.simulation.state import Watch
    from rubnoise.storage.reader import RunFile


Bar = Callable[[float, float | None, str], None]
"""Shows how much is done of a whole, and words; without a whole it only moves."""


@contextmanager
def bar(*, shown: bool) -> Iterator[Bar]:
    """Yield a bar on standard error, which goes at the end; one that shows nothing unless ``shown``."""
    if not shown:
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (BarColumn(bar_width=12), TaskProgressColumn(), TextColumn("{task.description}"), TimeRemainingColumn())
    # The stream beneath the one that escapes what is printed: the bar itself moves the cursor.
    console = Console(file=getattr(sys.stderr, "beneath", sys.stderr))
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=None)

        def show(done: float, whole: float | None, words: str) -> None:
            progress.update(task, completed=done, total=whole, description=escape(words))

        yield show


@contextmanager
def _stopping() -> Iterator[Callable[[], None]]:
    """Yield a function that raises RunStopped after a signal; signals are caught from its first call on."""
    with ExitStack() as stack:
        between: list[Callable[[], None]] = []

        def check() -> None:
            if not between:
                between.append(stack.enter_context(stoppable()))
            between[0]()

        yield check


@contextmanager
def watching(distance: float, *, shown: bool) -> Iterator["Watch"]:
    """Yield what watches a run of a length in um; from its first call on, signals stop the run at its next call."""
    with _stopping() as check, bar(shown=shown) as show:
        show(0.0, None, "counting the births")

        def watch(reached: float, junctions: int, live: int) -> None:
            check()
            words = f"{reached / 1000.0:.6g} of {distance / 1000.0:.6g} mm, {junctions:,} junctions, {live:,} alive"
            show(reached, distance, words)

        yield watch


@contextmanager
def watching_sweep(*, shown: bool) -> Iterator[Callable[["SweepProgress"], None]]:
    """Yield what watches a sweep; from its first call on, signals stop the sweep at its next call."""
    with _stopping() as check, bar(shown=shown) as show:

        def watch(progress: "SweepProgress") -> None:
            check()
            ended = progress.done + progress.failed
            failed = f", {progress.failed:,} failed" if progress.failed else ""
            show(ended, progress.runs, f"{ended:,} of {progress.runs:,} runs{failed}")

        yield watch


@contextmanager
def watching_reads(run: "RunFile", *, shown: bool) -> Iterator[None]:
    """Show which column of a file is being read."""
    with bar(shown=shown) as show:
        run.watch = lambda column, row, rows: show(row, rows, column)
        try:
            yield
        finally:
            run.watch = None


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
    print("Compiling the kernels of this kind of motion; this happens once and takes up to a minute.", file=sys.stderr)


SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)

Given = ParamSpec("Given")


def interrupted_at_once(command: Callable[Given, None]) -> Callable[Given, None]:
    """Let SIGINT end the process directly as long as a command has made no file.

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
def stoppable() -> Iterator[Callable[[], None]]:
    """Yield a function to call between pieces of work: it raises RunStopped after SIGINT or SIGTERM.

    It raises nowhere else, since an exception gets lost in a library that is being loaded. A second signal ends the
    process at once.
    """
    numbers: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        for each in SIGNALS:
            signal.signal(each, signal.SIG_DFL)
        numbers.append(number)

    def between() -> None:
        if numbers:
            raise RunStopped(numbers[0])

    before = {each: signal.signal(each, note) for each in SIGNALS}
    try:
        yield between
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
