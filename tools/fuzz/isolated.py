"""A command carried out in a process of its own, with limits: how it ended, what it said, how long, what it opened."""

import ctypes
import faulthandler
import os
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import chdir, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, NoReturn
from unittest.mock import patch

SECONDS = 120.0
MEMORY_BYTES = 1 << 30
"""Beside what the program has loaded."""

FAILURES = {
    "Traceback": "Traceback",
    "internal error": "internal error, which should not be",  # HDF5 has internal errors, too, and words for them
    "Segmentation fault": "Segmentation fault",
}
"""What the program never says, by what is behind it."""

OPENED = 0x20
EVENT_BYTES = 16
"""Of inotify, by which the kernel of Linux reports what any process opens."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How a command ended: exit code, or the negative number of a signal; what it printed; whether time ran out."""

    code: int
    out: str
    err: str
    seconds: float
    hung: bool

    def fault(self, *codes: int) -> str:
        """Return what is wrong with the ending, where the exit code should be one of these; else nothing."""
        if self.hung:
            return "hangs"
        if self.code < 0:
            return f"crashes ({signal.Signals(-self.code).name})"
        said = next((name for name, words in FAILURES.items() if words in self.err), None)
        return said or ("" if self.code in codes else f"exit code {self.code}")


def called(words: Sequence[str], folder: Path, *, seconds: float = SECONDS, memory: int = MEMORY_BYTES) -> Outcome:
    """Call the command line in a copy of this process, which keeps what is loaded here."""
    return isolated(lambda: command(words, folder), seconds=seconds, memory=memory)


def isolated(task: Callable[[], int], *, seconds: float = SECONDS, memory: int = MEMORY_BYTES) -> Outcome:
    """Carry out a task in a copy of this process; it returns an exit code."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        began = time.monotonic()
        child = os.fork()
        if child == 0:
            _be_child(task, out, err, memory)
        status = _status(child, began + seconds)
        return Outcome(
            code=-signal.SIGKILL if status is None else os.waitstatus_to_exitcode(status),
            out=_text(out),
            err=_text(err),
            seconds=time.monotonic() - began,
            hung=status is None,
        )


@contextmanager
def watched(path: Path) -> Iterator[list[int]]:
    """Yield a list that holds, afterwards, one entry for each time that the file was opened."""
    opened: list[int] = []
    library = ctypes.CDLL(None, use_errno=True)
    descriptor = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    if descriptor < 0 or library.inotify_add_watch(descriptor, os.fsencode(path), OPENED) < 0:
        raise OSError(ctypes.get_errno(), f"{path}: cannot be watched")
    try:
        yield opened
        with suppress(BlockingIOError):
            opened += os.read(descriptor, 1 << 16)[::EVENT_BYTES]
    finally:
        os.close(descriptor)


def command(words: Sequence[str], folder: Path) -> int:
    """Call the command line in this process, in a folder, and return its exit code."""
    from rubnoise.cli.app import main

    with chdir(folder), patch.object(sys, "argv", ["rubnoise", *words]):
        try:
            main()
        except SystemExit as left:
            return left.code if isinstance(left.code, int) else int(left.code is not None)
    return 0


def _be_child(task: Callable[[], int], out: BinaryIO, err: BinaryIO, memory: int) -> NoReturn:
    code = 99
    try:
        os.setpgid(0, 0)
        faulthandler.disable()
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        with os.fdopen(1, "w", closefd=False) as sys.stdout, os.fdopen(2, "w", closefd=False) as sys.stderr:
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            limit = pages * resource.getpagesize() + memory
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            code = task()
    finally:
        os._exit(code)


def _status(child: int, deadline: float) -> int | None:
    """Wait for a child and return its status; past the deadline end it, and its own children, and return None."""
    pause = 0.001
    while time.monotonic() < deadline:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return status
        time.sleep(pause)
        pause = min(1.5 * pause, 0.02)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def _text(file: BinaryIO) -> str:
    file.seek(0)
    return file.read(1 << 20).decode("utf-8", "replace")
