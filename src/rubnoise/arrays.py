"""Arrays: their types by name, and the slices in which long ones are read."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Integers = NDArray[np.int64]
Bytes = NDArray[np.uint8]

CHUNK_ROWS: Final = 65_536
"""Rows that are read or written at once, so that a longer run needs no more memory: half a megabyte of a column."""


def slices(start: int, stop: int, size: int | None = None) -> Iterator[slice]:
    """Yield slices of ``size`` rows (CHUNK_ROWS when None) from ``start`` to ``stop``, the last one shorter."""
    size = size or CHUNK_ROWS
    for first in range(start, stop, size):
        yield slice(first, min(first + size, stop))
