"""Rows of a stored column, read without HDF5 from the places that read_structure found."""

import zlib
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Bytes
from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk

REMEDY: Final = "copy it again, or run its scenario again"
SHUFFLE_SKIPPED: Final = 1
DEFLATE_SKIPPED: Final = 2


@dataclass(slots=True, kw_only=True)
class StoredColumn:
    """The place of a column's rows: in one piece at ``offset``, or in ``chunks`` of ``chunk_rows`` rows.

    Chunks are shuffled and deflated; each has its offset, its size in bytes and the filters that it skipped. The chunk
    read last is kept in memory.
    """

    dtype: np.dtype[Any]
    rows: int
    offset: int = 0
    chunk_rows: int = 0
    chunks: tuple[tuple[int, int, int], ...] = ()
    _last: tuple[int, NDArray[Any]] | None = field(default=None, repr=False)

    def read(self, descriptor: int, start: int, stop: int) -> NDArray[Any]:
        """Return rows ``start`` to ``stop``; raises RunFileRefused if the file does not have them (any more)."""
        values: NDArray[Any] = np.empty(stop - start, dtype=self.dtype)
        if not self.chunks:
            _fill(values.view(np.uint8), descriptor, self.offset + start * self.dtype.itemsize)
            return values
        row = start
        while row < stop:
            index, first = divmod(row, self.chunk_rows)
            count = min(self.chunk_rows - first, stop - row)
            values[row - start : row - start + count] = self._chunk(descriptor, index)[first : first + count]
            row += count
        return values

    def _chunk(self, descriptor: int, index: int) -> NDArray[Any]:
        last = self._last
        if last is None or last[0] != index:
            last = self._last = (index, self._unpacked(descriptor, *self.chunks[index]))
        return last[1]

    def _unpacked(self, descriptor: int, offset: int, count: int, skipped: int) -> NDArray[Any]:
        stored: Bytes = np.empty(count, dtype=np.uint8)
        _fill(stored, descriptor, offset)
        size = self.chunk_rows * self.dtype.itemsize
        content = stored if skipped & DEFLATE_SKIPPED else _inflated(stored, size)
        if content.size != size:
            raise RunFileRefused(f"damaged: a chunk has another size than its rows; {REMEDY}")
        if not skipped & SHUFFLE_SKIPPED:
            content = _in_rows(content.reshape(self.dtype.itemsize, self.chunk_rows))
        return content.reshape(-1).view(self.dtype)


def _in_rows(planes: Bytes) -> Bytes:
    """Return the bytes of each value side by side (unshuffle), plane by plane: half the time of numpy's transpose."""
    rows: Bytes = np.empty(planes.shape[::-1], dtype=np.uint8)
    for place, plane in enumerate(planes):
        rows[:, place] = plane
    return rows


def _inflated(stored: Bytes, size: int) -> Bytes:
    """Inflate a chunk, to one byte more than the size it should have at most."""
    inflating = zlib.decompressobj()
    try:
        content = inflating.decompress(stored.data, size + 1)
    except zlib.error as problem:
        raise RunFileRefused(f"damaged: {problem}; {REMEDY}") from problem
    if not inflating.eof:
        raise RunFileRefused(f"damaged: a chunk does not end where its rows do; {REMEDY}")
    return np.frombuffer(content, dtype=np.uint8)


def _fill(target: Bytes, descriptor: int, offset: int) -> None:
    """Fill an array with bytes of a file; raises RunFileRefused if it ends before."""
    if disk.read_into(descriptor, target.data, offset) < target.size:
        raise RunFileRefused(f"cut short; {REMEDY}")
