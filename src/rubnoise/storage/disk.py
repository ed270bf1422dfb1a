"""Every system call that reads or writes a result: the one place where tests count these calls or let them fail.

Other modules call these as ``disk.sync(...)``, by the name of the module, so that a test can put others in their
place. Each function is one system call, or one that is repeated until all bytes are done: a system may read or write
less than requested (POSIX allows it, and network disks do it).
"""

import errno
import os
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from threading import Lock
from typing import Final

from rubnoise.errors import RubnoiseError
from rubnoise.regular_file import flags

try:
    import fcntl
except ImportError:  # on Windows nothing is locked
    LOCKS = False
else:
    LOCKS = True

LARGEST = 1 << 30
"""Bytes in one call at most: some systems take no more."""

_OURS_ALONE: Final = flags("O_CLOEXEC", "O_NOFOLLOW")

SEEKING: Final = Lock()
"""Held where a read moves the position of a file, which its threads and its copies in other processes share."""


class NotAsWritten(RubnoiseError):  # noqa: N818  (that is what the file is)
    """What a file has on disk is not what was written to it; the text names the part that differs."""

    def __str__(self) -> str:
        """Say so."""
        return f"{super().__str__()} on disk differs from what was written"


def lock(descriptor: int) -> None:
    """Lock a file alone, as long as it is open; raises BlockingIOError if another process holds a lock of it."""
    fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def share(descriptor: int) -> bool:
    """Take a lock that readers share, as long as a file is open; False if another process holds it alone."""
    if LOCKS:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:  # if a file system has no locks, no other process has one either
            return True
    return True


def open_or_create(path: Path) -> int:
    """Open a file for reading and writing, made if it is not there, and return its descriptor."""
    return os.open(path, os.O_RDWR | os.O_CREAT | _OURS_ALONE, 0o666)


def create_unnamed(folder: Path) -> int:
    """Create a file for reading and writing without a name in a folder, and return its descriptor."""
    with TemporaryFile(buffering=0, dir=folder) as file:
        return os.dup(file.fileno())


def reopen(path: Path) -> int:
    """Open an existing file for reading and writing, and return its descriptor."""
    return os.open(path, os.O_RDWR | _OURS_ALONE)


def close(descriptor: int) -> None:
    """Close a file."""
    os.close(descriptor)


def read_into(descriptor: int, target: memoryview, offset: int) -> int:
    """Fill a contiguous buffer of bytes from an offset, however many calls the system needs for it.

    Return the number of bytes read, less than the size of the buffer only if the file ends before.
    """
    done = 0
    while done < len(target):
        count = _read_some(descriptor, target[done : done + LARGEST], offset + done)
        if not count:
            break
        done += count
    return done


def _read_some(descriptor: int, target: memoryview, offset: int) -> int:
    if hasattr(os, "preadv"):
        return os.preadv(descriptor, [target], offset)
    with SEEKING:
        os.lseek(descriptor, offset, os.SEEK_SET)
        part = os.read(descriptor, len(target))
    target[: len(part)] = part
    return len(part)


def read(descriptor: int, size: int, offset: int) -> bytes:
    """Return ``count`` bytes from an offset, fewer if the file ends before (see `read_into`)."""
    content = bytearray(size)
    return bytes(content[: read_into(descriptor, memoryview(content), offset)])


def write_all(descriptor: int, data: memoryview, offset: int) -> None:
    """Write all of a contiguous buffer of bytes at an offset, however many calls the system needs for it."""
    while data:
        written = _some(_write_some(descriptor, data[:LARGEST], offset))
        data, offset = data[written:], offset + written


def _write_some(descriptor: int, data: memoryview, offset: int) -> int:
    if hasattr(os, "pwrite"):
        return os.pwrite(descriptor, data, offset)
    with SEEKING:
        os.lseek(descriptor, offset, os.SEEK_SET)
        return os.write(descriptor, data)


def _some(written: int) -> int:
    """Return a count of bytes; raises OSError if it is 0, since the caller would try again for ever."""
    if not written:
        raise OSError(errno.EIO, os.strerror(errno.EIO))
    return written


def resize(descriptor: int, size: int) -> None:
    """Cut or extend a file to a size."""
    os.ftruncate(descriptor, size)


def allocate(descriptor: int, size: int) -> None:
    """Allocate disk space for a file up to a size, if the system can be asked to."""
    if size and hasattr(os, "posix_fallocate"):
        os.posix_fallocate(descriptor, 0, size)


def sync(descriptor: int) -> None:
    """Flush a file to disk (fsync)."""
    os.fsync(descriptor)


def begin_sync(descriptor: int) -> None:
    """Ask the system to begin to flush a file, if it can be asked; do not wait.

    The call is POSIX's advice that the bytes are not needed; Linux then begins to write the changed ones.
    """
    if hasattr(os, "posix_fadvise"):
        os.posix_fadvise(descriptor, 0, 0, os.POSIX_FADV_DONTNEED)


def sync_folder(folder: Path) -> None:
    """Flush the names in a folder to disk, if the system can open a folder."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def rename(source: Path, target: Path) -> None:
    """Rename a file; a file that has the new name already is replaced."""
    source.replace(target)


def link(source: Path, target: Path) -> None:
    """Give a file a second name; raises OSError if the name exists."""
    os.link(source, target)


def is_file(path: Path, file: os.stat_result) -> bool:
    """Whether a path leads to a certain file."""
    with suppress(FileNotFoundError):
        return os.path.samestat(path.lstat(), file)
    return False


def remove(path: Path) -> None:
    """Remove a name, if it exists."""
    path.unlink(missing_ok=True)
