"""Files for HDF5 to write into: memory, or a disk that never seems to fail.

HDF5 ends the process instead of raising if a disk is full. So it hears of no error; we raise the first one afterwards.
"""

import io
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rubnoise.storage import disk

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer, WriteableBuffer

PAGE: Final = 4096
_NOTHING: Final = bytes(PAGE)


class _Positioned(io.RawIOBase):
    """Seek and tell over a known size; subclasses add the rest of a file object."""

    def __init__(self, size: int) -> None:
        self._position = 0
        self._size = size

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._position

    def truncate(self, size: int | None = None, /) -> int:
        self._size = self._position if size is None else size
        return self._size

    def seek(self, offset: int, whence: int = os.SEEK_SET, /) -> int:
        base = 0 if whence == os.SEEK_SET else self._position if whence == os.SEEK_CUR else self._size
        self._position = base + offset
        return self._position

    def _advance(self, count: int) -> int:
        self._position += count
        self._size = max(self._size, self._position)
        return count


class PagedFile(_Positioned):
    """A file whose changes stay in memory: pages never touched are read from the descriptor beneath.

    Without a descriptor the file is new. Memory holds the pages written, so columns that are allocated but not
    filled cost nothing.
    """

    def __init__(self, descriptor: int | None = None) -> None:
        super().__init__(0 if descriptor is None else os.fstat(descriptor).st_size)
        self._beneath = descriptor
        self._pages: dict[int, bytearray] = {}

    def readinto(self, buffer: "WriteableBuffer", /) -> int:
        """Fill the buffer from the pages in memory, and elsewhere from the file beneath."""
        target = memoryview(buffer).cast("B")
        for page, start, piece in _pieces(self._position, target):
            held = self._pages.get(page)
            content = self._beneath_at(page) if held is None else held
            piece[:] = content[start : start + len(piece)]
        self._position += len(target)
        return len(target)

    def write(self, data: "ReadableBuffer", /) -> int:
        """Change pages in memory."""
        source = memoryview(data).cast("B")
        for page, start, piece in _pieces(self._position, source):
            content = self._pages.get(page)
            if content is None:
                content = self._pages[page] = bytearray(self._beneath_at(page))
            content[start : start + len(piece)] = piece
        return self._advance(len(source))

    def _beneath_at(self, page: int) -> bytes:
        if self._beneath is None:
            return _NOTHING
        return disk.read(self._beneath, PAGE, page * PAGE).ljust(PAGE, b"\0")


class Unfailing(_Positioned):
    """A file on disk that hides errors from HDF5: the first error is kept, to be raised later."""

    def __init__(self, descriptor: int) -> None:
        super().__init__(os.fstat(descriptor).st_size)
        self._descriptor = descriptor
        self._failure: OSError | None = None

    def readinto(self, buffer: "WriteableBuffer", /) -> int:
        """Fill the buffer from the disk, with zeros beyond its end and if the disk fails."""
        target = memoryview(buffer).cast("B")
        found = 0
        if self._failure is None:
            try:
                found = disk.read_into(self._descriptor, target, self._position)
            except OSError as failure:
                self._failure = failure
        target[found:] = bytes(len(target) - found)
        self._position += len(target)
        return len(target)

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write to the disk, or drop the bytes after an error."""
        source = memoryview(data).cast("B")
        if self._failure is None:
            try:
                disk.write_all(self._descriptor, source, self._position)
            except OSError as failure:
                self._failure = failure
        return self._advance(len(source))

    def raise_first_error(self) -> None:
        """Raise the first error, or give the file its final size."""
        if self._failure is not None:
            raise self._failure
        disk.resize(self._descriptor, self._size)


@contextmanager
def unfailing(path: Path) -> Iterator[Unfailing]:
    """Yield an existing empty file, to be written through HDF5; raises OSError afterwards if the disk failed."""
    descriptor = disk.reopen(path)
    try:
        file = Unfailing(descriptor)
        try:
            yield file
        finally:
            file.raise_first_error()
    finally:
        disk.close(descriptor)


def _pieces(position: int, data: memoryview) -> Iterable[tuple[int, int, memoryview]]:
    """Cut a buffer at page borders; yield page number, start inside the page, bytes."""
    page, start = divmod(position, PAGE)
    if start + len(data) <= PAGE:
        return ((page, start, data),)  # as nearly always
    borders = [0, *range(PAGE - start, len(data), PAGE), len(data)]
    return (
        (page + number, 0 if number else start, data[begin:end])
        for number, (begin, end) in enumerate(pairwise(borders))
    )
