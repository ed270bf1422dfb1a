"""Stop a command after a signal: between two pieces of its work once it has begun, at once before."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from types import FrameType
from typing import Final, ParamSpec

from rubnoise.errors import RunStopped

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
