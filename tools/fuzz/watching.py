"""Whether any process opened a file meanwhile, as the kernel reports (inotify, on Linux)."""

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

OPENED = 0x20
EVENT_BYTES = 16


@contextmanager
def watched(path: Path) -> Iterator[list[int]]:
    """Yield a list that holds, afterwards, one entry for each time that the file was opened."""
    opened: list[int] = []
    library = ctypes.CDLL(None, use_errno=True)
    descriptor = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    if descriptor < 0 or library.inotify_add_watch(descriptor, os.fsencode(path), OPENED) < 0:
        raise OSError(ctypes.get_errno(), f"{path}: cannot be watched")
    try:
        yield opened
        with suppress(BlockingIOError):
            opened += os.read(descriptor, 1 << 16)[::EVENT_BYTES]
    finally:
        os.close(descriptor)
