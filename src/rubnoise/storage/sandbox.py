"""The sandbox: HDF5 reads a file in a child process with little memory and time, which can open no other file.

The child is a copy of this process, so that nothing is loaded again: it costs milliseconds. The descriptor of the file
is all that it needs; as it can open no other, no link, external storage or plug-in of HDF5 leads it anywhere.

A program with threads (such as a notebook) should not fork. A worker process of one thread, started with the first
file that such a program opens and ended with it, gets the descriptor of each file and makes the copies.

Windows cannot fork. There a new process reads each file, within the same time.
"""

import faulthandler
import gc
import json
import os
import select
import signal
import socket
import sys
import threading
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, NoReturn
from weakref import finalize

from rubnoise.storage import disk
from rubnoise.storage.rows import REMEDY

if TYPE_CHECKING:
    from subprocess import Popen

MEMORY_BYTES: Final = 256 * 1024**2
"""Address space for a look, on top of what the program has; a compressed run of 10^9 ticks needs a tenth of it."""

CPU_SECONDS: Final = 10
WALL_SECONDS: Final = 60.0
ANSWER_BYTES: Final = 64 * 1024**2

FROM_OUTSIDE: Final = frozenset({"SIGKILL", "SIGTERM", "SIGHUP"})
"""Signals that no library sends to itself: a lack of memory, or a user."""

Look = Callable[[int], bytes]


def sandboxed(descriptor: int, look: Look, *, patience: float = WALL_SECONDS) -> bytes:
    """Return what ``look`` returns for an open file in a child process.

    The answer is a JSON object; if the child crashes or takes too much, it has the reason under ``refused``, and
    ``unseen`` says that this need not be the file's fault.
    """
    receiving, sending = os.pipe()
    child = _copy_of_this_process()
    if child == 0:
        _answer(descriptor, look, sending)
    os.close(sending)
    try:
        return _outcome(child, receiving, time.monotonic() + patience)
    finally:
        os.close(receiving)


def _copy_of_this_process() -> int:
    """Fork; the child calls nothing that could wait for a lock of another thread (h5py takes care of its own)."""
    with warnings.catch_warnings():
        # Since Python 3.12 threads of numerical libraries, which stop for a fork, count as a danger.
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


def _answer(descriptor: int, look: Look, sending: int) -> NoReturn:
    """Run as the child: look, write the answer to the pipe and exit at once, whatever happens."""
    code = 1
    try:
        descriptor, sending = _beyond_streams(descriptor), _beyond_streams(sending)
        _let_go_but(descriptor, sending)
        _be_quiet()
        _be_small()
        disk.append_all(sending, memoryview(look(descriptor)))
        code = 0
    finally:
        os._exit(code)


def _beyond_streams(descriptor: int) -> int:
    """Return a copy of a descriptor whose number no standard stream has; files get these if streams are closed."""
    import fcntl

    return descriptor if descriptor > 2 else fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)


def _let_go_but(*kept: int) -> None:
    """Close every descriptor but these and the standard ones, so that locks of a killed parent end with it."""
    for entry in list(Path("/dev/fd").iterdir()):
        if (descriptor := int(entry.name)) > 2 and descriptor not in kept:
            with suppress(OSError):  # the list itself was read by one that is closed already
                os.close(descriptor)


def _be_quiet() -> None:
    """Hide crashes and finalizers of the child, and leave Ctrl-C to the parent."""
    gc.disable()
    faulthandler.disable()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)


def _be_small() -> None:
    """Limit memory, time, descriptors and bytes on disk to what reading a valid file takes."""
    import resource

    _limit(resource.RLIMIT_CPU, CPU_SECONDS, spare=1)  # at the hard limit it would be killed without a reason
    _limit(resource.RLIMIT_FSIZE, 0)
    _limit(resource.RLIMIT_CORE, 0)
    with suppress(OSError):  # only Linux says how much there is, and only there does the limit hold
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        _limit(resource.RLIMIT_AS, pages * resource.getpagesize() + MEMORY_BYTES)
    _limit(resource.RLIMIT_NOFILE, 0)


def _limit(what: int, most: int, *, spare: int = 0) -> None:
    import resource

    _, hard = resource.getrlimit(what)
    last = most + spare if hard == resource.RLIM_INFINITY else min(most + spare, hard)
    resource.setrlimit(what, (min(most, last), last))


def _outcome(child: int, receiving: int, deadline: float) -> bytes:
    answer: bytes | None = None
    try:
        answer = _received(receiving, deadline)
    finally:
        if answer is None:
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if answer is None:
        return _refusal(TOO_MUCH, unseen=True)
    if os.WIFSIGNALED(status) and signal.Signals(os.WTERMSIG(status)).name in FROM_OUTSIDE:
        return _refusal("the process that read its structure was killed; try again", unseen=True)
    return answer if status == 0 else _refusal(f"damaged: HDF5 {_end(status)} on its structure; {REMEDY}")


def _received(receiving: int, deadline: float) -> bytes | None:
    """Return everything from the pipe; None if that is too much or takes too long."""
    parts: list[bytes] = []
    size = 0
    while size <= ANSWER_BYTES:
        ready, _, _ = select.select([receiving], [], [], max(0.0, deadline - time.monotonic()))
        part = os.read(receiving, 1 << 20) if ready else None
        if not part:
            return None if part is None else b"".join(parts)
        parts.append(part)
        size += len(part)
    return None


def _end(status: int) -> str:
    if not os.WIFSIGNALED(status):
        return "fails"
    name = signal.Signals(os.WTERMSIG(status)).name
    return "loops" if name == "SIGXCPU" else f"crashes ({name})"


def _refusal(reason: str, *, unseen: bool = False) -> bytes:
    return json.dumps({"refused": reason, "unseen": unseen}).encode()


TOO_MUCH: Final = "reading its structure takes more time or memory than that of any run"

LookName = Literal["structure", "inventory", "dataset", "matlab"]
Request = tuple[LookName, *tuple[str, ...]]
"""A request to the sandbox: the name of a look, and for values their name and the first one."""


def look_at(descriptor: int, request: Request, *, patience: float = WALL_SECONDS) -> bytes:
    """Return what the sandbox finds in an open file, in the form of `sandboxed`, the way that this program allows."""
    if not hasattr(os, "fork"):
        return looked_at_by_another(descriptor, request, patience=patience)
    if threading.active_count() > 1:
        return SANDBOX_WORKER.ask(descriptor, request, patience)
    return sandboxed(descriptor, look_of(request), patience=patience)


def look_of(request: Request) -> Look:
    """Return the function that answers a request, with its modules loaded: in the sandbox none can be opened."""
    kind, *words = request
    if kind in {"dataset", "matlab"}:
        from rubnoise.storage.measured import look_at_values

        return look_at_values(kind, *words)
    from rubnoise.storage import inventory, read_structure  # which rest on HDF5

    return read_structure.read_structure if kind == "structure" else inventory.inventory


START_SECONDS: Final = 60.0
END_SECONDS: Final = 2.0
PROGRAM: Final = "from rubnoise.storage.sandbox import serve_looks; serve_looks()"
CHANNEL: Final = 0
LENGTH_BYTES: Final = 8


class SandboxWorker:
    """The worker process that reads files for this one, and the channel to it."""

    def __init__(self) -> None:
        """Start nothing before the first file."""
        self._asking = threading.Lock()
        self._channel: socket.socket | None = None
        self._owner = 0

    def ask(self, descriptor: int, request: Request = ("structure",), patience: float = WALL_SECONDS) -> bytes:
        """Return what the worker finds in an open file; raises OSError if it does not answer."""
        message = json.dumps([request, patience]).encode()
        with self._asking:
            if self._owner != os.getpid():  # after a fork the channel is that of the parent
                self._renew()
            try:
                return self._asked(descriptor, message)
            except ConnectionError:
                self._renew()  # it has ended: try once more, with a new one
                return self._asked(descriptor, message)

    def _asked(self, descriptor: int, message: bytes) -> bytes:
        channel = self._channel
        if channel is None:
            raise ConnectionError("no process looks at result files")
        socket.send_fds(channel, [len(message).to_bytes(LENGTH_BYTES, "big")], [descriptor])
        channel.sendall(message)
        return _received_from(channel, int.from_bytes(_received_from(channel, LENGTH_BYTES), "big"))

    def _renew(self) -> None:
        if self._channel is not None:
            self._channel.close()
        self._channel, process = _started()
        self._owner = os.getpid()
        finalize(self, _hang_up, self._channel, process)


SANDBOX_WORKER: Final = SandboxWorker()


def serve_looks() -> None:
    """Run as the worker: answer until the program that asks has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(ConnectionError), socket.socket(fileno=CHANNEL) as channel:  # it may be killed while it waits
        while True:
            size, descriptors, _, _ = socket.recv_fds(channel, LENGTH_BYTES, 1)
            if not descriptors:
                return
            request, patience = json.loads(_received_from(channel, int.from_bytes(size, "big")))
            answer = sandboxed(descriptors[0], look_of(request), patience=patience)
            os.close(descriptors[0])
            channel.sendall(len(answer).to_bytes(LENGTH_BYTES, "big") + answer)


def _started() -> "tuple[socket.socket, Popen[bytes]]":
    """Start the worker with our modules' folders, and the other end of the channel as its standard input.

    It gets no other descriptor: the lock of a file that this program has open in HDF5 would outlive the program.
    """
    from subprocess import Popen  # which only a program with threads needs

    ours, its = socket.socketpair()
    ours.settimeout(START_SECONDS + WALL_SECONDS)
    folders = os.pathsep.join(filter(None, sys.path))
    with its:
        command = [sys.executable, "-P", "-c", PROGRAM]
        return ours, Popen(command, stdin=its.fileno(), env={**os.environ, "PYTHONPATH": folders})  # noqa: S603  (our own words)


def _hang_up(channel: socket.socket, process: "Popen[bytes]") -> None:
    """Close the channel, which ends the worker, and wait a moment for it."""
    from subprocess import TimeoutExpired

    channel.close()
    with suppress(TimeoutExpired):
        process.wait(END_SECONDS)


def _received_from(channel: socket.socket, count: int) -> bytes:
    parts = bytearray()
    while len(parts) < count:
        part = channel.recv(min(count - len(parts), 1 << 20))
        if not part:
            raise ConnectionError("the process that looks at result files has ended")
        parts += part
    return bytes(parts)


LOOK_ALONE: Final = "import sys; from rubnoise.storage.sandbox import look_alone; look_alone(sys.argv[1:])"


def looked_at_by_another(descriptor: int, request: Request, *, patience: float = WALL_SECONDS) -> bytes:
    """Return what a new process finds in an open file, in the form of `sandboxed`.

    For systems without fork: the process has the file as its standard input, and only its time is limited.
    """
    from subprocess import PIPE, TimeoutExpired, run

    folders = os.pathsep.join(filter(None, sys.path))
    command = [sys.executable, "-P", "-c", LOOK_ALONE, *request]
    with disk.SEEKING:
        os.lseek(descriptor, 0, os.SEEK_SET)
        try:
            done = run(  # noqa: S603  (our own words)
                command,
                stdin=descriptor,
                stdout=PIPE,
                env={**os.environ, "PYTHONPATH": folders},
                timeout=patience,
                check=False,
            )
        except TimeoutExpired:
            return _refusal(TOO_MUCH, unseen=True)
    if done.returncode or len(done.stdout) > ANSWER_BYTES:
        return _refusal(f"damaged: HDF5 fails on its structure; {REMEDY}")
    return done.stdout


def look_alone(request: Request) -> None:
    """Run as that process: read standard input, and write the answer to standard output, which HDF5 cannot use."""
    answer = os.dup(1)
    _be_quiet()
    disk.append_all(answer, memoryview(look_of(request)(0)))
