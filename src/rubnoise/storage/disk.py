"""Bytes of a file on the disk: locked, read and written until all is done.

A system may read or write less than requested: POSIX allows it, and network disks do it.
"""

import errno
import fcntl
import os

LARGEST = 1 << 30
"""Bytes in one call at most: some systems take no more."""


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
