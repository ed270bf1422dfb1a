"""A result file looked over in a child process, which may take little memory and time, and open nothing at all.

The child is a copy of this process, so that nothing is loaded again: it costs milliseconds. The descriptor of the file
is all that it needs; as it can open no other, no link, external storage or plug-in of HDF5 leads it anywhere.
"""

import faulthandler
import gc
import json
import os
import resource
import select
import signal
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final, NoReturn

from rubnoise.storage import disk
from rubnoise.storage.rows import REMEDY

MEMORY_BYTES: Final = 256 * 1024**2
"""Address space for a look, on top of what the program has; a compressed run of 10^9 ticks needs a tenth of it."""

CPU_SECONDS: Final = 10
WALL_SECONDS: Final = 60.0
ANSWER_BYTES: Final = 64 * 1024**2

FROM_OUTSIDE: Final = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP)
"""Signals that no library sends to itself: a lack of memory, or somebody's hand."""

Look = Callable[[int], bytes]


def vetted(descriptor: int, look: Look, *, patience: float = WALL_SECONDS) -> bytes:
    """Return what ``look`` makes of an open file in a child process.

    The answer is a JSON object; where the child crashes or takes too much, one that says so under ``refused``, and
    under ``unseen`` that this need not be the file's fault.
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
    """Fork; the child calls nothing that could wait for a lock of another thread (h5py sees to its own)."""
    with warnings.catch_warnings():
        # Since Python 3.12 threads of numerical libraries, which stop for a fork, count as a danger.
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


def _answer(descriptor: int, look: Look, sending: int) -> NoReturn:
    """Be the child: look, write the answer down the pipe and leave at once, whatever happens."""
    code = 1
    try:
        _let_go_but(descriptor, sending)
        _be_quiet()
        _be_small()
        disk.append_all(sending, memoryview(look(descriptor)))
        code = 0
    finally:
        os._exit(code)


def _let_go_but(*kept: int) -> None:
    """Close every descriptor but these and the standard ones: locks of a parent that is killed must go with it."""
    for entry in list(Path("/dev/fd").iterdir()):
        if (descriptor := int(entry.name)) > 2 and descriptor not in kept:
            with suppress(OSError):  # the list itself was read by one that is closed already
                os.close(descriptor)


def _be_quiet() -> None:
    """Keep crashes and finalizers of the child to itself, and leave the keys pressed to the parent."""
    gc.disable()
    faulthandler.disable()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)


def _be_small() -> None:
    """Give up the right to more memory, time, descriptors and bytes on disk than a look at a sound file takes."""
    _limit(resource.RLIMIT_CPU, CPU_SECONDS, spare=1)  # at the hard limit it would be killed without a reason
    _limit(resource.RLIMIT_FSIZE, 0)
    _limit(resource.RLIMIT_CORE, 0)
    with suppress(OSError):  # only Linux tells how much there is, and only there does the limit hold
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        _limit(resource.RLIMIT_AS, pages * resource.getpagesize() + MEMORY_BYTES)
    _limit(resource.RLIMIT_NOFILE, 0)


def _limit(what: int, most: int, *, spare: int = 0) -> None:
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
        return _refusal("reading its structure takes more time or memory than that of any run", unseen=True)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) in FROM_OUTSIDE:
        return _refusal("the process that read its structure was killed; try again", unseen=True)
    return answer if status == 0 else _refusal(f"damaged: HDF5 {_end(status)} on its structure; {REMEDY}")


def _received(receiving: int, deadline: float) -> bytes | None:
    """Return everything that comes down the pipe; None where that is too much or takes too long."""
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
    number = os.WTERMSIG(status)
    return "loops" if number == signal.SIGXCPU else f"crashes ({signal.Signals(number).name})"


def _refusal(reason: str, *, unseen: bool = False) -> bytes:
    return json.dumps({"refused": reason, "unseen": unseen}).encode()
