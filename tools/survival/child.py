"""Copies of this process in which commands are carried out, with limits, and killed: nothing has to be loaded again.

A copy tells where it is by lines in a pipe. What it told before it was killed is a witness that depends on no file.
"""

import faulthandler
import os
import resource
import select
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import chdir, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, NoReturn
from unittest.mock import patch

SECONDS = 120.0
LONGEST_SECONDS = 300.0
"""A copy that lives longer hangs."""

MEMORY_BYTES = 1 << 30
"""Beside what the program has loaded."""

FAILED = 99
"""Exit code of a task that raised something; it tells what."""

FAILURES = {
    "Traceback": "Traceback",
    "internal error": "internal error, which should not be",  # HDF5 has internal errors, too, and words for them
    "Segmentation fault": "Segmentation fault",
}
"""What the program never says, by what is behind it."""

Tell = Callable[[str], None]
Task = Callable[[Tell], int | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """How a copy ended: exit code, or the negative number of a signal; what it printed; whether time ran out.

    ``seconds`` passed since its begin, ``cpu`` of them it worked.
    """

    code: int
    out: str
    err: str
    seconds: float
    cpu: float
    hung: bool

    def fault(self, *codes: int) -> str:
        """Return what is wrong with the ending, where the exit code should be one of these; else nothing."""
        if self.hung:
            return "hangs"
        if self.code < 0:
            return f"crashes ({signal.Signals(-self.code).name})"
        said = next((name for name, words in FAILURES.items() if words in self.err), None)
        return said or ("" if self.code in codes else f"exit code {self.code}")


@dataclass(slots=True, kw_only=True)
class Child:
    """A copy of this process that carries out a task; ``told`` are the lines that came so far."""

    number: int
    pipe: int
    out: BinaryIO
    err: BinaryIO
    began: float
    told: list[str] = field(default_factory=list)
    _rest: bytes = b""

    @classmethod
    def begin(cls, task: Task, *, memory: int | None = None) -> "Child":
        """Start one; it may take so many bytes of memory beside what is loaded."""
        out, err = (tempfile.TemporaryFile() for _ in range(2))  # noqa: SIM115  (closed when it is read)
        receiving, sending = os.pipe()
        began = time.monotonic()
        number = os.fork()
        if number == 0:
            os.close(receiving)
            _carry_out(task, sending, out, err, memory)
        os.close(sending)
        os.set_blocking(receiving, False)
        return cls(number=number, pipe=receiving, out=out, err=err, began=began)

    def wait_for(self, word: str, seconds: float) -> bool:
        """Wait until a line begins with a word; return whether one came before the time was up, or the copy ended."""
        deadline = time.monotonic() + seconds
        while self.last(word) < 0:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.pipe], [], [], left)[0] or not self._receive():
                return False
        return True

    def last(self, word: str) -> int:
        """Return the number in the last line that begins with a word; -1 for none."""
        numbers = [int(line.split()[1]) for line in self.told if line.startswith(f"{word} ")]
        return numbers[-1] if numbers else -1

    def send(self, number: int) -> None:
        """Send it a signal; one that has ended takes no notice."""
        os.kill(self.number, number)

    def end(self, seconds: float = LONGEST_SECONDS) -> Ending:
        """Wait for its end; so many seconds after its begin end it, and its own children."""
        hung = False
        while not (found := os.wait4(self.number, os.WNOHANG))[0]:
            self._receive()
            if hung := time.monotonic() > self.began + seconds:
                with suppress(ProcessLookupError):
                    os.killpg(self.number, signal.SIGKILL)
                found = os.wait4(self.number, 0)
                break
            time.sleep(0.001)
        ended = time.monotonic()
        while self._receive():
            pass
        os.close(self.pipe)
        _, status, usage = found
        return Ending(
            code=os.waitstatus_to_exitcode(status),
            out=_text(self.out),
            err=_text(self.err),
            seconds=ended - self.began,
            cpu=usage.ru_utime + usage.ru_stime,
            hung=hung,
        )

    def _receive(self) -> bool:
        """Take what is in the pipe; return whether there was any."""
        try:
            came = os.read(self.pipe, 1 << 16)
        except BlockingIOError:
            return False
        *lines, self._rest = (self._rest + came).split(b"\n")
        self.told += [line.decode() for line in lines]
        return bool(came)


def _carry_out(task: Task, sending: int, out: BinaryIO, err: BinaryIO, memory: int | None) -> NoReturn:
    code = FAILED

    def tell(line: str) -> None:
        os.write(sending, f"{line}\n".encode())

    try:
        os.setpgid(0, 0)
        faulthandler.disable()
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if memory is not None:
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            limit = pages * resource.getpagesize() + memory
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        # Where Python's streams were replaced, as pytest does, they would not hear of it.
        with os.fdopen(1, "w", closefd=False) as sys.stdout, os.fdopen(2, "w", closefd=False) as sys.stderr:
            code = task(tell) or 0
    except KeyboardInterrupt:
        code = 128 + signal.SIGINT  # it came before the command had begun
    except BaseException:  # noqa: BLE001  (whatever it is, it is told)
        tell(f"failed {' '.join(traceback.format_exc().split())[-1500:]}")
    finally:
        os._exit(code)


def _text(file: BinaryIO) -> str:
    with file:
        file.seek(0)
        return file.read(1 << 20).decode("utf-8", "replace")


def isolated(task: Callable[[], int], *, seconds: float = SECONDS, memory: int = MEMORY_BYTES) -> Ending:
    """Carry out a task in a copy of this process; it returns an exit code."""
    return Child.begin(lambda _: task(), memory=memory).end(seconds)


def called(words: Sequence[str], folder: Path, *, seconds: float = SECONDS, memory: int = MEMORY_BYTES) -> Ending:
    """Call the command line in a copy of this process, which keeps what is loaded here."""
    return isolated(lambda: command(words, folder), seconds=seconds, memory=memory)


def command(words: Sequence[str], folder: Path) -> int:
    """Call the command line in this process, in a folder, and return its exit code."""
    from rubnoise.cli.app import main

    with chdir(folder), patch.object(sys, "argv", ["rubnoise", *words]):
        try:
            main()
        except SystemExit as left:
            return left.code if isinstance(left.code, int) else int(left.code is not None)
    return 0
