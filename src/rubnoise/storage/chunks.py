"""Rows of a column in compressed chunks. HDF5 finds a chunk; it is unpacked here, and refused if it is not its rows.

HDF5 itself hands out memory that belongs to others where a chunk unpacks to fewer bytes than it should have.
"""

import zlib
from typing import Any, Final

import h5py
import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Bytes
from rubnoise.errors import RunFileRefused

SHUFFLE_SKIPPED: Final = 1
DEFLATE_SKIPPED: Final = 2


def rows_of_chunks(dataset: h5py.Dataset, first: int, last: int) -> NDArray[Any]:
    """Return rows ``first`` to ``last`` of a dataset; raises RunFileRefused for damaged chunks."""
    rows = dataset.chunks[0]
    values: NDArray[Any] = np.empty(last - first, dataset.dtype)
    for begin in range(first - first % rows, last, rows):
        here = slice(max(first, begin), min(last, begin + rows))
        chunk = _unpacked(dataset, begin)
        values[here.start - first : here.stop - first] = chunk[here.start - begin : here.stop - begin]
    return values


def _unpacked(dataset: h5py.Dataset, begin: int) -> NDArray[Any]:
    """Return all rows of the chunk that begins at a row."""
    rows, width = dataset.chunks[0], dataset.dtype.itemsize
    skipped, stored = dataset.id.read_direct_chunk((begin,))
    content = np.frombuffer(stored if skipped & DEFLATE_SKIPPED else _inflated(stored, rows * width), np.uint8)
    if content.size != rows * width:
        raise RunFileRefused("damaged: a chunk has another size than its rows")
    if not skipped & SHUFFLE_SKIPPED:
        content = _in_rows(content.reshape(width, rows))
    return content.reshape(-1).view(dataset.dtype)


def _inflated(stored: bytes, size: int) -> bytes:
    """Inflate a chunk, to one byte more than the size it should have at most."""
    inflating = zlib.decompressobj()
    try:
        content = inflating.decompress(stored, size + 1)
    except zlib.error as problem:
        raise RunFileRefused(f"damaged: {problem}") from problem
    if not inflating.eof:
        raise RunFileRefused("damaged: a chunk does not end where its rows do")
    return content


def _in_rows(planes: Bytes) -> Bytes:
    """Return the bytes of each value side by side (unshuffle), plane by plane: half the time of numpy's transpose."""
    rows: Bytes = np.empty(planes.shape[::-1], dtype=np.uint8)
    for place, plane in enumerate(planes):
        rows[:, place] = plane
    return rows
