"""Copies of this process that carry out commands, with limits, and can be killed: nothing has to be loaded again."""

import faulthandler
import os
import resource
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Sequence
from contextlib import chdir, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn
from unittest.mock import patch

SECONDS = 120.0
"""A copy that lives longer hangs."""

MEMORY_BYTES = 1 << 30
"""Beside what the program has loaded."""

FAILED = 99
"""Exit code of a task that raised something."""

FAILURES = {
    "Traceback": "Traceback",
    "internal error": "internal error, which should not be",  # HDF5 has internal errors, too, and words for them
    "Segmentation fault": "Segmentation fault",
}
"""What the program never says, by what is behind it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """How a copy ended: exit code, or minus a signal; what it printed; seconds since it began; whether time ran out."""

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


class Child:
    """A copy of this process that carries out a task, which returns an exit code."""

    def __init__(self, task: Callable[[], int], *, memory: int = MEMORY_BYTES) -> None:
        """Start it; it may take so many bytes of memory beside what is loaded."""
        self.out, self.err = tempfile.TemporaryFile(), tempfile.TemporaryFile()  # noqa: SIM115  (closed when read)
        self.began = time.monotonic()
        self.number = os.fork()
        if self.number == 0:
            self._carry_out(task, memory)

    def end(self, seconds: float = SECONDS) -> Ending:
        """Wait for its end; so many seconds after its begin end it, and its own children."""
        hung = False
        while not (found := os.waitpid(self.number, os.WNOHANG))[0]:
            if hung := time.monotonic() > self.began + seconds:
                with suppress(ProcessLookupError):
                    os.killpg(self.number, signal.SIGKILL)
                found = os.waitpid(self.number, 0)
                break
            time.sleep(0.001)
        texts = []
        for file in (self.out, self.err):
            with file:
                file.seek(0)
                texts.append(file.read(1 << 20).decode("utf-8", "replace"))
        code, taken = os.waitstatus_to_exitcode(found[1]), time.monotonic() - self.began
        return Ending(code=code, out=texts[0], err=texts[1], seconds=taken, hung=hung)

    def _carry_out(self, task: Callable[[], int], memory: int) -> NoReturn:
        code = FAILED
        try:
            os.setpgid(0, 0)
            faulthandler.disable()
            os.dup2(self.out.fileno(), 1)
            os.dup2(self.err.fileno(), 2)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            limit = pages * resource.getpagesize() + memory
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            # Where Python's streams were replaced, as pytest does, they would not hear of it.
            with os.fdopen(1, "w", closefd=False) as sys.stdout, os.fdopen(2, "w", closefd=False) as sys.stderr:
                code = task()
        except BaseException as problem:  # noqa: BLE001  (every problem is printed)
            os.write(2, f"{type(problem).__name__}: {problem}\n".encode())
        finally:
            os._exit(code)


def called(words: Sequence[str], folder: Path) -> Ending:
    """Call the command line in a copy of this process, which keeps what is loaded here."""
    return Child(lambda: command(words, folder)).end()


def command(words: Sequence[str], folder: Path) -> int:
    """Call the command line in this process, in a folder, and return its exit code."""
    from rubnoise.cli.app import main

    with chdir(folder), patch.object(sys, "argv", ["rubnoise", *words]), warnings.catch_warnings():
        warnings.simplefilter("default")  # as it is for a user
        try:
            main()
        except SystemExit as left:
            return left.code if isinstance(left.code, int) else int(left.code is not None)
    return 0
