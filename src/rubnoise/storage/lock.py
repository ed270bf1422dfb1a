"""A lock file, which keeps other processes away as long as its process lives; its last holder removes it.

Windows has no such locks. There nothing is locked, and commands that need a lock (see `AVAILABLE`) are refused.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import ENOLCK
from pathlib import Path
from time import monotonic, sleep
from typing import Final

from rubnoise.regular_file import flags
from rubnoise.storage import disk

try:
    import fcntl
except ImportError:
    AVAILABLE = False
else:
    AVAILABLE = True

_OWN_FILE: Final = flags("O_CLOEXEC", "O_NOFOLLOW", "O_NONBLOCK")

PATIENCE_SECONDS: Final = 0.3
"""Longer than it takes to see whether a lock is held, and to let go of one that a killed run has left to a copy."""


class Held(Exception):  # noqa: N818  (no failure: another process is there)
    """Another process holds the lock."""


@contextmanager
def holding(path: Path, *, shared: bool = False, patience: float | None = PATIENCE_SECONDS) -> Iterator[None]:
    """Hold a lock, alone or ``shared``; its file is created, and removed by its last holder.

    ``patience``: how many seconds to wait for others, None for as long as it takes. Raises Held if they still
    hold it, OSError if the lock file cannot be made.
    """
    if not AVAILABLE:
        raise OSError(ENOLCK, "this system has no locks for it")
    descriptor = _locked(path, fcntl.LOCK_SH if shared else fcntl.LOCK_EX, patience)
    try:
        yield
    finally:
        _let_go(descriptor, path)


def is_held(path: Path) -> bool:
    """Whether a process holds a lock alone; asking makes no file and blocks no other process."""
    descriptor = _found(path)
    if descriptor is None:
        return False
    try:
        return not share(descriptor)
    finally:
        os.close(descriptor)


def share(descriptor: int) -> bool:
    """Take a lock that readers share, for as long as a file is open; False if another process holds it alone."""
    return not AVAILABLE or _got(descriptor, fcntl.LOCK_SH)


def _locked(path: Path, how: int, patience: float | None) -> int:
    """Return the descriptor of the lock file, locked; it is certainly the file that has the name now."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
        try:
            _lock(descriptor, how, patience)
            if disk.is_file(path, os.fstat(descriptor)):
                return descriptor
        except BlockingIOError as problem:
            _let_go(descriptor, path)
            raise Held from problem
        except BaseException:
            _let_go(descriptor, path)
            raise
        os.close(descriptor)


def _lock(descriptor: int, how: int, patience: float | None) -> None:
    """Lock a file; try again for a moment if another process is about to release it."""
    if patience is None:
        return fcntl.flock(descriptor, how)
    deadline = monotonic() + patience
    while monotonic() < deadline:
        with suppress(BlockingIOError):
            return fcntl.flock(descriptor, how | fcntl.LOCK_NB)
        sleep(patience / 100)
    return fcntl.flock(descriptor, how | fcntl.LOCK_NB)


def _let_go(descriptor: int, path: Path) -> None:
    """Close a lock file, and remove it unless others hold it.

    It is removed while it is held alone: a process that waits with the same file open sees that the name is gone and
    starts again. A file that cannot be removed is not locked, so it does no harm.
    """
    try:
        with suppress(OSError):
            if _got(descriptor, fcntl.LOCK_EX) and disk.is_file(path, os.fstat(descriptor)):
                disk.remove(path)
    finally:
        os.close(descriptor)


def _got(descriptor: int, how: int) -> bool:
    try:
        fcntl.flock(descriptor, how | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # if a file system has no locks, no other process has one either
        return True
    return True


def _found(path: Path) -> int | None:
    """Open an existing lock file; None if there is none or it cannot be opened."""
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY | _OWN_FILE)
        if stat.S_ISREG(os.fstat(descriptor).st_mode):
            return descriptor
        os.close(descriptor)
    return None
