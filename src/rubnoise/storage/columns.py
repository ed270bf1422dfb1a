"""One column of a file on its way to disk: plain writes at its offset, hashed as they pass."""

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.storage.pages import write_all
from rubnoise.storage.structure import Place

PANEL_BYTES = 1 << 19


class ColumnFile:
    """Rows of one contiguous column, written at their offset in an open file.

    The hash is that of the raw little-endian bytes, taken while rows arrive in order; a column of which a row was
    written twice is read once more at the end.
    """

    def __init__(self, descriptor: int, place: Place) -> None:
        self._descriptor = descriptor
        self._place = place
        self._dtype = np.dtype(place.dtype)
        self._hash: xxhash.xxh3_128 | None = xxhash.xxh3_128()
        self.rows_written = 0

    @property
    def rows(self) -> int:
        """Rows of the whole column."""
        return self._place.rows

    def write(self, first_row: int, values: NDArray[Any]) -> None:
        """Write rows that follow those written before, or replace some of them.

        Raises TypeError for another dtype than the schema's, ValueError for rows that leave a gap or do not fit.
        """
        end = first_row + self._checked(first_row, values)
        data = np.ascontiguousarray(values).view(np.uint8)
        if first_row < self.rows_written:
            self._hash = None
        if self._hash is not None:
            self._hash.update(data.data)
        write_all(self._descriptor, data.data, self._place.offset + first_row * self._dtype.itemsize)
        self.rows_written = max(self.rows_written, end)

    def digest(self) -> str:
        """Return the xxh3_128 of the whole column in hexadecimal."""
        if self._hash is None:
            self._hash = xxhash.xxh3_128()
            for panel in self.panels(PANEL_BYTES // self._dtype.itemsize):
                self._hash.update(panel.data)
        return self._hash.hexdigest()

    def panels(self, size: int) -> Iterator[NDArray[Any]]:
        """Read the column back, ``size`` rows at a time."""
        for first in range(0, self.rows, size):
            count = min(size, self.rows - first) * self._dtype.itemsize
            data = os.pread(self._descriptor, count, self._place.offset + first * self._dtype.itemsize)
            yield np.frombuffer(data, dtype=self._dtype)

    def _checked(self, first_row: int, values: NDArray[Any]) -> int:
        """Return the number of rows, having refused what would land in the wrong place."""
        if values.dtype != self._dtype or values.ndim != 1:
            raise TypeError(f"rows of {values.dtype} in {values.ndim} dimensions for a column of {self._dtype}")
        if not 0 <= first_row <= self.rows_written or first_row + values.size > self.rows:
            raise ValueError(f"rows {first_row} to {first_row + values.size} of {self.rows}, after {self.rows_written}")
        return values.size
