"""Show on a terminal how far a run, a sweep or a look through a file is, and stop after a signal."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from types import FrameType
from typing import Final

from rubnoise.errors import RunStopped

Bar = Callable[[float, float | None, str], None]
"""Shows how much is done of a whole, and words; without a whole it only moves."""


@contextmanager
def bar(words: str = "", *, shown: bool) -> Iterator[Bar]:
    """Yield a bar with its first words on standard error, which goes at the end; it shows nothing unless ``shown``.

    Signals are caught from its first call on, and obeyed at its next call.
    """
    with ExitStack() as stack:
        show = stack.enter_context(_drawn(words)) if shown else None
        between: list[Callable[[], None]] = []

        def watched(done: float, whole: float | None, words: str) -> None:
            if not between:
                between.append(stack.enter_context(stoppable()))
            between[0]()
            if show is not None:
                show(done, whole, words)

        yield watched


@contextmanager
def _drawn(words: str) -> Iterator[Bar]:
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (BarColumn(bar_width=12), TaskProgressColumn(), TextColumn("{task.description}"), TimeRemainingColumn())
    # The stream beneath the one that escapes what is printed: the bar itself moves the cursor.
    console = Console(file=getattr(sys.stderr, "beneath", sys.stderr))
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(words, total=None)
        yield lambda done, whole, words: progress.update(task, completed=done, total=whole, description=escape(words))


def announce_compilation(*, by_workers: bool = False) -> None:
    """Print a message, once, when this process begins to compile kernels, or if workers will: no code is kept then."""
    from rubnoise.compiling import before_compiling, is_kept
    from rubnoise.simulation.kernel import add_areas

    before_compiling(_say_compiling)
    if by_workers and not is_kept(add_areas):
        _say_compiling()


@cache
def _say_compiling() -> None:
    print("Compiling the kernels of this kind of motion; this happens once and takes up to a minute.", file=sys.stderr)


SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


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
