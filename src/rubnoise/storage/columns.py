"""Write one column of a file to disk: rows are gathered into large pieces, hashed, and written at their place."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.arrays import Bytes, slices
from rubnoise.errors import RubnoiseError
from rubnoise.storage import disk
from rubnoise.storage.growing import GrowingPlace
from rubnoise.storage.layout import ByteRange

PIECE_BYTES: Final = 1 << 15
"""Bytes that wait at most: to touch more memory for the first time costs more than the calls that it saves."""

READ_BYTES: Final = 1 << 20
"""Bytes that are read at a time, into the same memory, if a whole column is only hashed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """The progress of a column: its number of rows, and the xxh3_128 of all of them."""

    rows: int
    digest: bytes


class ColumnFile:
    """One column, written at its place in an open file: a place of fixed size, or one that grows.

    Rows wait in memory until a piece is full, or until ``flush``. The hash is that of the raw little-endian bytes,
    taken while rows arrive in order; a column of which a row was written twice is read once more. Without ``hashed``
    none is taken before it is needed.
    """

    def __init__(self, descriptor: int, place: ByteRange | GrowingPlace, *, hashed: bool = True) -> None:
        self._descriptor = descriptor
        self._place = place
        self._dtype = np.dtype(place.dtype)
        self._hash: xxhash.xxh3_128 | None = xxhash.xxh3_128() if hashed else None
        self._marked = (0, xxhash.xxh3_128())
        self._waiting: Bytes = np.empty(0, dtype=np.uint8)
        self._count = 0
        self.rows_written = 0

    @property
    def rows(self) -> int:
        """Number of rows of the whole column; of a growing one, the rows so far."""
        return self.rows_written if self._place.rows is None else self._place.rows

    @property
    def offset(self) -> int:
        """Offset of the column in its file; 0 if it has no rows, or if it grows."""
        return self._place.offset

    def moved(self, descriptor: int, place: ByteRange) -> "ColumnFile":
        """Return this column at the place to which all of its rows have been copied."""
        column = ColumnFile(descriptor, place)
        column._hash, column.rows_written = self._hash, self.rows_written
        return column

    def write(self, first_row: int, values: NDArray[Any]) -> None:
        """Write rows that follow those written before, or replace some of them.

        Raises TypeError for another dtype than the schema's, ValueError for rows that leave a gap or do not fit.
        """
        end = first_row + self._checked(first_row, values)
        data = np.ascontiguousarray(values).view(np.uint8)
        if first_row < self.rows_written:
            self._replace(first_row, data)
        else:
            self._append(data)
        self.rows_written = max(self.rows_written, end)

    def flush(self) -> None:
        """Write the waiting rows (without fsync)."""
        if self._count:
            self._pass_on(self._waiting[: self._count], self._bytes(self.rows_written) - self._count)
            self._count = 0

    def mark(self, rows: int) -> Mark:
        """Return the mark of the column after its first ``rows`` rows, not fewer than at the last mark."""
        self.flush()
        running = self._running() if rows == self.rows_written else self._earlier(rows)
        self._marked = (rows, running.copy())
        return Mark(rows=rows, digest=running.digest())

    def matching(self, marks: Sequence[Mark]) -> int:
        """Read the column and compare it with marks, in order of rows; return how many of the marks agree."""
        running = xxhash.xxh3_128()
        for number, (before, mark) in enumerate(pairwise([Mark(rows=0, digest=b""), *marks])):
            if not before.rows <= mark.rows <= self._place.held:
                return number
            for chunk in self._pieces(before.rows, mark.rows):
                running.update(chunk.data)
            if running.digest() != mark.digest:
                return number
            self._hash, self.rows_written = running.copy(), mark.rows
            self._marked = (mark.rows, running.copy())
        return len(marks)

    def go_on_from(self, rows: int) -> None:
        """Continue after the first ``rows`` rows, which are in the file; later rows are forgotten."""
        if rows != self.rows_written:
            self._hash, self.rows_written = None, rows
            self.mark(rows)

    def digest(self) -> str:
        """Return the xxh3_128 of the rows so far in hexadecimal."""
        self.flush()
        return self._running().hexdigest()

    def stored_digest(self) -> str:
        """Return the xxh3_128 of the whole column as it is in the file now, in hexadecimal."""
        running, left, begin = xxhash.xxh3_128(), self._bytes(self.rows), 0
        target = np.empty(min(READ_BYTES, left), dtype=np.uint8).data
        while left:
            piece = target[: min(READ_BYTES, left)]
            self._fill(piece, begin)
            running.update(piece)
            left, begin = left - len(piece), begin + len(piece)
        return running.hexdigest()

    def chunks(self, size: int, rows: int | None = None) -> Iterator[NDArray[Any]]:
        """Read the column back, or its first ``rows``, ``size`` rows at a time."""
        self.flush()
        yield from self._pieces(0, self.rows if rows is None else rows, size)

    def _append(self, data: Bytes) -> None:
        offset = self._bytes(self.rows_written)
        if data.size >= PIECE_BYTES:
            # Large enough as it is: a copy would cost more than writing the waiting bytes first.
            self.flush()
            self._pass_on(data, offset)
            return
        while data.size:
            taken = self._gather(data)
            data, offset = data[taken:], offset + taken
            if self._count == self._waiting.size:
                self._pass_on(self._waiting, offset - self._count)
                self._count = 0

    def _gather(self, data: Bytes) -> int:
        """Put bytes into the buffer, as many as fit."""
        if not self._waiting.size:
            most = PIECE_BYTES if self._place.rows is None else self._bytes(self._place.rows)
            self._waiting = np.empty(min(PIECE_BYTES, most), dtype=np.uint8)
        taken = min(data.size, self._waiting.size - self._count)
        self._waiting[self._count : self._count + taken] = data[:taken]
        self._count += taken
        return taken

    def _pass_on(self, data: Bytes, offset: int) -> None:
        if self._hash is not None:
            self._hash.update(data.data)
        self._write(data, offset)

    def _replace(self, first_row: int, data: Bytes) -> None:
        self.flush()
        self._hash = None
        self._write(data, self._bytes(first_row))

    def _write(self, data: Bytes, offset: int) -> None:
        self._place.reserve(offset + data.size)
        done = 0
        for place, size in self._place.pieces(offset, data.size):
            disk.write_all(self._descriptor, data[done : done + size].data, place)
            done += size

    def _running(self) -> "xxhash.xxh3_128":
        """Return the hash of the rows so far, read once more if some were replaced."""
        if self._hash is None:
            running = xxhash.xxh3_128()
            for chunk in self._pieces(0, self.rows_written):
                running.update(chunk.data)
            self._hash = running
        return self._hash

    def _earlier(self, rows: int) -> "xxhash.xxh3_128":
        """Return the hash of the first rows, from the last mark on unless rows before it may have been replaced."""
        first, hashed = self._marked if self._hash is not None else (0, xxhash.xxh3_128())
        running = hashed.copy()
        for chunk in self._pieces(first, rows):
            running.update(chunk.data)
        return running

    def _pieces(self, first: int, end: int, size: int | None = None) -> Iterator[NDArray[Any]]:
        size = size or PIECE_BYTES // self._dtype.itemsize
        for part in slices(first, end, size):
            chunk = np.empty(part.stop - part.start, dtype=self._dtype)
            self._fill(chunk.view(np.uint8).data, self._bytes(part.start))
            yield chunk

    def _fill(self, target: memoryview, offset: int) -> None:
        done = 0
        for place, size in self._place.pieces(offset, len(target)):
            if disk.read_into(self._descriptor, target[done : done + size], place) != size:
                raise RubnoiseError("the part file was cut short meanwhile")
            done += size

    def _bytes(self, rows: int) -> int:
        return rows * self._dtype.itemsize

    def _checked(self, first_row: int, values: NDArray[Any]) -> int:
        """Return the number of rows of values; raises for values that would land in the wrong place."""
        if values.dtype != self._dtype or values.ndim != 1:
            raise TypeError(f"rows of {values.dtype} in {values.ndim} dimensions for a column of {self._dtype}")
        fits = self._place.rows is None or first_row + values.size <= self._place.rows
        if not 0 <= first_row <= self.rows_written or not fits:
            raise ValueError(f"rows {first_row} to {first_row + values.size} of {self.rows}, after {self.rows_written}")
        return values.size
