"""Worker processes on this machine: each serves calls until its parent closes the connection, and may die alone."""

import gc
import json
import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from queue import SimpleQueue
from threading import Thread
from types import FrameType, TracebackType
from typing import Any, Final, NoReturn, Self

from rubnoise.errors import RubnoiseError, RunStopped


@dataclass(slots=True)
class Cancellation:
    """Whether a worker process must stop: after SIGTERM, or because its parent has ended."""

    parent: int | None = None
    busy: bool = False
    stopped_by: int | None = None

    def follow_signals(self) -> None:
        """Stop at SIGTERM, and leave SIGINT to the parent, since the keyboard sends it to all processes there."""
        self.parent = os.getppid()
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, self._stop)

    def check(self, _distance: float, _junctions: int, _live: int) -> None:
        """Raise RunStopped if the current run was cancelled (a Watch of `simulate`)."""
        if self.stopped_by is not None:
            raise RunStopped(self.stopped_by)
        if self.parent is not None and os.getppid() != self.parent:
            raise RunStopped(signal.SIGTERM)

    def _stop(self, number: int, _frame: FrameType | None) -> None:
        """Exit at once between two runs; during a run only note the signal, since HDF5 must not be interrupted."""
        self.stopped_by = number
        if not self.busy:
            sys.exit(128 + number)


CANCELLATION = Cancellation()
"""The cancellation of this process; never set if runs are made in the calling process."""


def serve(descriptor: int) -> NoReturn:
    """Make the calls that come over a connection, in order, answer each, and end when there are no more.

    An answer is a pair: whether the call succeeded, and its value or the exception. Objects that exist after the first
    call are not searched for garbage later, since they stay.
    """
    CANCELLATION.follow_signals()
    warnings.filterwarnings("ignore", "compiled code cannot be kept")  # which each worker would say
    with Connection(descriptor) as line:
        go_on = _answer(line)
        gc.freeze()
        gc.enable()
        while go_on:
            go_on = _answer(line)
    os._exit(0)  # nothing is open any more, and taking all modules apart would take a third of a second


def _answer(line: "Connection[Any, Any]") -> bool:
    """Answer one call; return whether there was one and no signal to stop."""
    try:
        function, arguments = line.recv()
    except (EOFError, ConnectionResetError):  # the second if the parent was killed before it had read all answers
        return False
    CANCELLATION.busy = True
    _send(line, _called(function, arguments))
    CANCELLATION.busy = False
    return CANCELLATION.stopped_by is None


def _called(function: Any, arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    try:
        return True, function(*arguments)
    except Exception as problem:  # noqa: BLE001  (the parent gets any of them)
        return False, problem


def _send(line: "Connection[Any, Any]", answer: tuple[bool, Any]) -> None:
    """Send an answer; an exception that cannot be pickled is sent as its text."""
    try:
        line.send(answer)
    except BrokenPipeError:
        return
    except Exception as problem:  # noqa: BLE001  (pickling calls code of any kind)
        line.send((False, RubnoiseError(f"{problem}: {answer[1]!r}")))


GRACE: Final = 10.0
"""Seconds that a worker has to end its run in order."""

THREADS: Final = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMBA", "VECLIB_MAXIMUM")}
"""One thread for each worker, since there are as many workers as processors."""

_BEGIN: Final = (
    "import gc, json, sys; gc.disable(); sys.path[:] = json.loads(sys.argv[2]); "
    "from rubnoise.sweep.pool import serve; serve(int(sys.argv[1]))"
)
"""Garbage collection is off while a thousand modules are loaded."""

Call = tuple[Callable[..., Any], tuple[Any, ...]]


class WorkerDied(RubnoiseError):  # noqa: N818  (says what happened)
    """A worker process ended during a call."""

    def __init__(self, code: int) -> None:
        """Keep the exit code; a negative one is the number of a signal."""
        super().__init__(code)
        self.code = code

    def __str__(self) -> str:
        """Return a text with the reason of the end."""
        if self.code >= 0:
            return f"its process ended with exit code {self.code}"
        try:
            name = signal.Signals(-self.code).name
        except ValueError:
            name = f"signal {-self.code}"
        return f"its process was killed by {name}"


@dataclass(frozen=True, slots=True)
class Worker:
    """A process and the connection to it.

    It is a fresh interpreter and not a process of the multiprocessing module, which would import the main program
    again; that may be a program of the user which cannot be imported.
    """

    process: "subprocess.Popen[bytes]"
    line: "Connection[Any, Any]"

    @classmethod
    def begin(cls) -> Self:
        """Start a process in its own process group, which signals of the keyboard do not reach."""
        ours, theirs = Pipe()
        with theirs:
            process = subprocess.Popen(  # noqa: S603  (this interpreter, and arguments made here)
                [sys.executable, "-c", _BEGIN, str(theirs.fileno()), json.dumps(sys.path)],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                env=os.environ | THREADS,
                process_group=0,
            )
        return cls(process, ours)

    def call(self, call: Call) -> Any:
        """Call a function in the worker and return its value; raises its exception, or WorkerDied."""
        try:
            self.line.send(call)
            well, value = self.line.recv()
        except (EOFError, OSError) as problem:
            raise WorkerDied(self.process.wait()) from problem
        if not well:
            raise value
        return value

    def end(self, *, seconds: float) -> None:
        """Close the connection, wait some ``seconds`` for the process to end, then kill it."""
        self.line.close()
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Pool:
    """Worker processes, from now until the context ends; one that dies is replaced."""

    ahead = 1
    most = sys.maxsize

    def __init__(self, jobs: int) -> None:
        """Start the workers, which load their modules while the caller prepares the work."""
        self._calls: SimpleQueue[tuple[Future[Any], Call] | None] = SimpleQueue()
        self._stopped = False
        self._workers = [Worker.begin() for _ in range(jobs)]
        self._threads = [Thread(target=self._serve, args=(lane,), daemon=True) for lane in range(jobs)]
        for thread in self._threads:
            thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            self._stop()
        for _ in self._threads:
            self._calls.put(None)
        for thread in self._threads:
            thread.join()

    @property
    def lanes(self) -> int:
        """The number of workers."""
        return len(self._workers)

    @property
    def processes(self) -> list[int]:
        """Return the process ids of the workers."""
        return [worker.process.pid for worker in self._workers]

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Future[Any]":
        """Call a function of a module in the first free worker."""
        future: Future[Any] = Future()
        self._calls.put((future, (function, arguments)))
        return future

    def _serve(self, lane: int) -> None:
        """Pass calls to one worker until there are no more; runs in its own thread."""
        while (given := self._calls.get()) is not None:
            future, call = given
            if self._stopped or not future.set_running_or_notify_cancel():
                continue
            self._answer(lane, future, call)
        self._workers[lane].end(seconds=GRACE)

    def _answer(self, lane: int, future: "Future[Any]", call: Call) -> None:
        try:
            future.set_result(self._workers[lane].call(call))
        except Exception as problem:  # noqa: BLE001  (it is passed to the caller)
            if isinstance(problem, WorkerDied) and not self._stopped:
                self._workers[lane] = Worker.begin()
            future.set_exception(problem)

    def _stop(self) -> None:
        """Ask every worker to stop its run at the next tick range; kill those that do not."""
        self._stopped = True
        for worker in self._workers:
            worker.process.terminate()
        last = time.monotonic() + GRACE
        for worker in self._workers:
            try:
                worker.process.wait(max(0.0, last - time.monotonic()))
            except subprocess.TimeoutExpired:
                worker.process.kill()
