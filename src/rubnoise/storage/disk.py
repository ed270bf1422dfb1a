"""Every call that writes a result to disk or reads it: one place where tests watch, count or fail these calls.

Other modules call these as ``disk.sync(...)``, by the name of the module, so that a test can put others in their
place. Nothing here is clever: each is one call of the system, or one repeated until it is done. A system may read or
write less than it was asked for (POSIX allows it, and network disks do it).
"""

import errno
import os
import sys
from pathlib import Path
from threading import Lock
from typing import Final

from rubnoise.errors import RubnoiseError
from rubnoise.regular_file import flags

LARGEST = 1 << 30
"""Bytes in one call at most: some systems take no more."""

_OURS_ALONE: Final = flags("O_CLOEXEC", "O_NOFOLLOW")

SEEKING: Final = Lock()
"""Held where a read moves the position of a file, which its threads and its copies in other processes share."""


class NotAsWritten(RubnoiseError):  # noqa: N818  (that is what the file is)
    """A file that is, on the disk, not what was written to it; the text names what of it."""

    def __str__(self) -> str:
        """Say so."""
        return f"{super().__str__()} on disk differs from what was written"


def create(path: Path) -> int:
    """Create a file that is not there yet, for reading and writing, and return its descriptor."""
    return os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | _OURS_ALONE, 0o666)


def reopen(path: Path) -> int:
    """Open a file that is there, for reading and writing, and return its descriptor."""
    return os.open(path, os.O_RDWR | _OURS_ALONE)


def close(descriptor: int) -> None:
    """Close a file."""
    os.close(descriptor)


def read_into(descriptor: int, target: memoryview, offset: int) -> int:
    """Fill a contiguous buffer of bytes from an offset, however many calls the system needs for it.

    Return how many bytes there were: fewer than the buffer has only if the file ends before.
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
    """Return so many bytes from an offset, or all that there are if the file ends before (see `read_into`)."""
    content = bytearray(size)
    return bytes(content[: read_into(descriptor, memoryview(content), offset)])


def write_all(descriptor: int, data: memoryview, offset: int) -> None:
    """Write all of a contiguous buffer of bytes at an offset, however many calls the system needs for it."""
    while data:
        written = _some(os.pwrite(descriptor, data[:LARGEST], offset))
        data, offset = data[written:], offset + written


def append_all(descriptor: int, data: memoryview) -> None:
    """Write all of a contiguous buffer of bytes to a pipe, or at the end of a file that is open for appending."""
    while data:
        data = data[_some(os.write(descriptor, data[:LARGEST])) :]


def _some(written: int) -> int:
    """Return a count of bytes; raises OSError for none, which would be tried for ever."""
    if not written:
        raise OSError(errno.EIO, os.strerror(errno.EIO))
    return written


def resize(descriptor: int, size: int) -> None:
    """Cut or extend a file to a size."""
    os.ftruncate(descriptor, size)


def allocate(descriptor: int, size: int, start: int = 0) -> None:
    """Take the space of a file's first bytes, or of those of them from ``start`` on, if the system can."""
    if sys.platform != "darwin":
        os.posix_fallocate(descriptor, start, size - start)


def sync(descriptor: int) -> None:
    """See a file onto the disk."""
    os.fsync(descriptor)


def sync_rows(descriptor: int) -> None:
    """See the bytes of a file onto the disk, and of what is known about it only what it takes to read them."""
    getattr(os, "fdatasync", os.fsync)(descriptor)


def begin_sync(descriptor: int) -> None:
    """Have the system begin to bring a file to the disk, if it can be asked to; nothing is waited for.

    What POSIX calls advice that the bytes are not needed Linux takes as a reason to write out those that are changed.
    """
    if hasattr(os, "posix_fadvise"):
        os.posix_fadvise(descriptor, 0, 0, os.POSIX_FADV_DONTNEED)


def sync_folder(folder: Path) -> None:
    """See the names in a folder onto the disk, if a folder can be opened."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def rename(source: Path, target: Path) -> None:
    """Give a file another name, in the place of whatever bears it."""
    source.replace(target)


def link(source: Path, target: Path) -> None:
    """Give a file one more name, which nothing may bear yet."""
    os.link(source, target)


def remove(path: Path) -> None:
    """Remove a name, if it is there."""
    path.unlink(missing_ok=True)
