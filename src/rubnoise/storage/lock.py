"""A lock file: it keeps other processes away as long as its process lives, and its last holder removes it."""

import fcntl
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Final

from rubnoise.storage import disk

PATIENCE_SECONDS: Final = 0.3
"""Longer than it takes to see whether a lock is held, and to let go of one that a killed run has left to a copy."""


class Held(Exception):  # noqa: N818  (no failure: another process is there)
    """Another process holds the lock."""


@contextmanager
def holding(path: Path, *, shared: bool = False, patience: float | None = PATIENCE_SECONDS) -> Iterator[None]:
    """Hold a lock, alone or ``shared``; its file is made, and removed by the last who holds it.

    ``patience``: how many seconds to wait for others, None for as long as it takes. Raises Held where they have it
    still, OSError where there can be no lock.
    """
    descriptor = _locked(path, fcntl.LOCK_SH if shared else fcntl.LOCK_EX, patience)
    try:
        yield
    finally:
        _let_go(descriptor, path)


def is_held(path: Path) -> bool:
    """Whether a process holds a lock alone; no file is made, and no process is kept from the lock."""
    descriptor = _found(path)
    if descriptor is None:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return False


def remove_stale(path: Path) -> None:
    """Remove the file of a lock that no process holds, as a kill leaves one."""
    descriptor = _found(path)
    if descriptor is not None:
        _let_go(descriptor, path)


def _locked(path: Path, how: int, patience: float | None) -> int:
    """Return the descriptor of the lock file, locked, and sure to be the one that the name stands for."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
        try:
            _lock(descriptor, how, patience)
            if _is_still(descriptor, path):
                return descriptor
        except BlockingIOError as problem:
            _let_go(descriptor, path)
            raise Held from problem
        except BaseException:
            _let_go(descriptor, path)
            raise
        os.close(descriptor)


def _lock(descriptor: int, how: int, patience: float | None) -> None:
    """Lock a file, also where another process lets go of it only in a moment."""
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

    It is removed while it is held alone: a process that waits with the same file open sees that the name is gone, and
    starts over. A file that cannot be removed is not locked, and does no harm.
    """
    try:
        with suppress(OSError):
            if _is_alone(descriptor) and _is_still(descriptor, path):
                disk.remove(path)
    finally:
        os.close(descriptor)


def _is_alone(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # where a file system has no locks, no other process has one either
        return True
    return True


def _found(path: Path) -> int | None:
    """Open a lock file that is there; None where there is none that may be opened."""
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
        if stat.S_ISREG(os.fstat(descriptor).st_mode):
            return descriptor
        os.close(descriptor)
    return None


def _is_still(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.lstat())
    except FileNotFoundError:
        return False
