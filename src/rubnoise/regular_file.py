"""Regular files and their bytes: devices, pipes and sockets are refused, and no read waits for ever.

The path - is standard input, which is copied into a file first. A system may read or write less than requested: POSIX
allows it, and network disks do it.
"""

import errno
import fcntl
import os
import stat
import sys
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import BinaryIO, Final

STANDARD_INPUT: Final = "-"
INDEX: Final = "index.h5"  # what the folder of a sweep has its index in
MOST_INPUT_BYTES: Final = 1 << 32
PIECE_BYTES = 1 << 20
_READING = os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY


class NotRegular(OSError):  # noqa: N818  (says what the path is)
    """A path that exists and is not a regular file: a folder, pipe, device, socket or endless file."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Name the path, and what is there if it is a sweep."""
        name, reason = os.fspath(path), "is not a regular file"
        with suppress(OSError):  # a folder that may not be looked into
            if Path(name, INDEX).is_file():
                reason = "is the folder of a sweep, not a file; rubnoise info says what is in it"
        super().__init__(errno.EINVAL, reason, name)


def open_regular(path: str | os.PathLike[str]) -> int:
    """Return a descriptor of a regular file, for reading; raises NotRegular, or OSError if it cannot be opened."""
    if os.fspath(path) == STANDARD_INPUT:
        return os.open(_standard_input().name, _READING)
    try:  # Opening a device can already do something, so the path is checked first.
        regular = stat.S_ISREG(Path(path).stat().st_mode)
    except ValueError as problem:
        # The words of this error differ between versions of Python.
        reason = "embedded null byte" if "\0" in os.fspath(path) else str(problem)
        raise OSError(errno.EINVAL, reason, os.fspath(path)) from problem
    if not regular:
        raise NotRegular(path)
    return os.open(path, _READING)


def open_stream(path: str | os.PathLike[str]) -> BinaryIO:
    """Return a regular file as a stream of bytes; raises as `open_regular` does."""
    return os.fdopen(open_regular(path), "rb")


def read_at_most(path: str | os.PathLike[str], count: int) -> bytes:
    """Return the first ``count`` bytes of a regular file, fewer if it ends; raises as `open_regular` does.

    Some files of the system, such as /proc/kmsg, call themselves regular and have no end: such a read is refused, too.
    """
    with open_stream(path) as stream:
        content: bytes | None = stream.read(count)
    if content is None:
        raise NotRegular(path)
    return content


_HDF5: Final = b"\x89HDF"


def is_hdf5(path: str | os.PathLike[str]) -> bool:
    """Whether a regular file begins as HDF5 does; False for what cannot be opened, of which reading it says why."""
    with suppress(OSError):
        return read_at_most(path, len(_HDF5)) == _HDF5
    return False


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; False without permission to look, since opening it then gives the error."""
    return os.path.isdir(path)  # noqa: PTH112  (pathlib's raises)


@cache
def _standard_input() -> "tempfile._TemporaryFileWrapper[bytes]":
    """Return a file with all of standard input, which lasts as long as this process; raises OSError if it is too long.

    Readers may open it several times and read from any position.
    """
    file = tempfile.NamedTemporaryFile(prefix="rubnoise-input-")  # noqa: SIM115  (kept open: its end deletes it)
    copied = 0
    while part := sys.stdin.buffer.read(PIECE_BYTES):
        copied += file.write(part)
        if copied > MOST_INPUT_BYTES:
            raise OSError(errno.EFBIG, "is longer than 4 GiB", STANDARD_INPUT)
    file.flush()
    return file


LARGEST = 1 << 30  # bytes in one call at most: some systems take no more


def lock(descriptor: int, *, shared: bool = False) -> None:
    """Lock a file for one writer, or for readers who share it, as long as it is open.

    Raises BlockingIOError if another process holds a lock that excludes this one, OSError if the file system has none.
    """
    fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)


def read_into(descriptor: int, target: memoryview, offset: int) -> int:
    """Fill a contiguous buffer of bytes from an offset; return how many were read, fewer only if the file ends."""
    done = 0
    while done < len(target) and (count := os.preadv(descriptor, [target[done : done + LARGEST]], offset + done)):
        done += count
    return done


def write_all(descriptor: int, data: memoryview, offset: int) -> None:
    """Write all of a contiguous buffer of bytes at an offset."""
    while data:
        written = os.pwrite(descriptor, data[:LARGEST], offset)
        if not written:  # else this would go on for ever
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        data, offset = data[written:], offset + written
