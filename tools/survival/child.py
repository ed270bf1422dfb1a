"""Copies of this process in which runs are made, and killed: nothing is loaded again, so that a thousand take minutes.

A copy tells where it is by lines in a pipe. What it told before it was killed is a witness that depends on no file.
"""

import os
import select
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, NoReturn
from unittest.mock import patch

from rubnoise.simulation import draws
from rubnoise.storage import writer
from rubnoise.storage.writer import RunWriter

Tell = Callable[[str], None]
Task = Callable[[Tell], int | None]

FAILED = 9
"""Exit code of a task that raised something; it tells what."""


@contextmanager
def committing(seconds: float) -> Iterator[None]:
    """Commit after so many seconds, and after two blocks at most: small runs, too, shall have commits."""
    with patch.object(writer, "COMMIT_SECONDS", seconds), patch.object(draws, "_DRAWN_AT_ONCE", 2000):
        yield


@contextmanager
def telling(tell: Tell, *, seconds: float) -> Iterator[None]:
    """Commit after so many seconds, and report every start, commit and end of a run, with the ticks that are done."""
    enter, commit, publish = RunWriter.__enter__, RunWriter._commit, RunWriter.publish  # noqa: SLF001

    def entering(self: RunWriter) -> RunWriter:
        entered = enter(self)
        tell(f"entered {self.state.ticks if self.state else 0}")
        return entered

    def telling_commit(self: RunWriter, state: Any, **how: Any) -> None:
        commit(self, state, **how)
        tell(f"committed {state.ticks}")

    def publishing(self: RunWriter, *given: Any, **named: Any) -> None:
        tell("publishing 0")
        publish(self, *given, **named)
        tell("published 0")

    with committing(seconds), ExitStack() as patches:
        for owner, name, new in (
            (RunWriter, "__enter__", entering),
            (RunWriter, "_commit", telling_commit),
            (RunWriter, "publish", publishing),
        ):
            patches.enter_context(patch.object(owner, name, new))
        yield


@dataclass(slots=True, kw_only=True)
class Child:
    """A copy of this process that carries out a task; ``told`` are the lines that came so far.

    ``cpu``: the processor's time in s that it took, once it has ended.
    """

    number: int
    pipe: int
    told: list[str]
    began: float
    cpu: float = 0.0
    _rest: bytes = b""

    @classmethod
    def begin(cls, task: Task) -> "Child":
        """Start one."""
        receiving, sending = os.pipe()
        number = os.fork()
        if number == 0:
            os.close(receiving)
            _carry_out(task, sending)
        os.close(sending)
        os.set_blocking(receiving, False)
        return cls(number=number, pipe=receiving, told=[], began=time.monotonic())

    def wait_for(self, word: str, seconds: float) -> bool:
        """Wait until a line begins with a word; return whether one came before the time was up, or the copy ended."""
        deadline = time.monotonic() + seconds
        while not self.has_told(word):
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.pipe], [], [], left)[0] or not self._receive():
                return False
        return True

    def has_told(self, word: str) -> bool:
        """Whether a line that came begins with a word."""
        return any(line.startswith(f"{word} ") for line in self.told)

    def last(self, word: str) -> int:
        """Return the number in the last line that begins with a word; -1 for none."""
        numbers = [int(line.split()[1]) for line in self.told if line.startswith(f"{word} ")]
        return numbers[-1] if numbers else -1

    def send(self, number: int) -> None:
        """Send it a signal; one that has ended takes no notice."""
        os.kill(self.number, number)

    def end(self) -> int:
        """Wait for its end and return its exit code, or the negative number of the signal that ended it."""
        while select.select([self.pipe], [], [], 60.0)[0] and self._receive():
            pass
        _, status, usage = os.wait4(self.number, 0)
        self.cpu = usage.ru_utime + usage.ru_stime
        while self._receive():
            pass
        os.close(self.pipe)
        return os.waitstatus_to_exitcode(status)

    def _receive(self) -> bool:
        """Take what is in the pipe; return whether there was any."""
        try:
            came = os.read(self.pipe, 1 << 16)
        except BlockingIOError:
            return False
        *lines, self._rest = (self._rest + came).split(b"\n")
        self.told += [line.decode() for line in lines]
        return bool(came)


def _carry_out(task: Task, sending: int) -> NoReturn:
    code = FAILED

    def tell(line: str) -> None:
        os.write(sending, f"{line}\n".encode())

    try:
        code = task(tell) or 0
    except KeyboardInterrupt:
        code = 128 + signal.SIGINT  # it came before the command had begun
    except BaseException:  # noqa: BLE001  (whatever it is, it is told)
        tell(f"failed {' '.join(traceback.format_exc().split())[-1500:]}")
    finally:
        os._exit(code)
