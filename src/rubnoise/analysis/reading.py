"""Rows read ahead for callers that take small steps, and rows that are checked when they are read."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import CHUNK_ROWS
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import Rows, chunks


class Ahead:
    """Rows that are read in whole chunks, for callers that go through them in small steps."""

    def __init__(self, rows: Rows) -> None:
        """Read from other rows."""
        self._rows = rows
        self._read: dict[tuple[str, str], tuple[int, NDArray[Any]]] = {}

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Names of the columns of each group."""
        return self._rows.columns

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return self._rows.rows(group)

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return rows ``start`` to ``stop`` (to the end when None) of a column."""
        end = self.rows(group) if stop is None else stop
        first = start // CHUNK_ROWS * CHUNK_ROWS
        if end > first + CHUNK_ROWS:
            return self._rows.column(group, name, start, end)
        read, values = self._read.get((group, name), (-1, np.empty(0)))
        if read != first:
            values = self._rows.column(group, name, first, first + CHUNK_ROWS)
            self._read[group, name] = first, values
        return values[start - first : end - first]


CHECKED_ROWS: Final = 1 << 18
"""Rows that a comparison reads at once: it sums up each chunk by itself, so its last bits depend on them."""


def checked_chunks(rows: Rows, group: str, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the named columns that a group has from its first row to its last, a chunk at a time.

    Raises RunFileRefused for a number that is not finite and a diameter that is not positive.
    """
    for chunk in chunks(rows, group, CHECKED_ROWS):
        found = {name: chunk[name] for name in names if name in rows.columns[group]}
        check_numbers(group, range(chunk.first, chunk.end), found)
        yield found


def check_numbers(group: str, rows: Sequence[int] | NDArray[np.int64], columns: Mapping[str, NDArray[Any]]) -> None:
    """Raise RunFileRefused, naming the first of some rows, if a number is not finite or a diameter not positive."""
    for name, values in columns.items():
        right = np.isfinite(values) if name != "diameter" else np.isfinite(values) & (values > 0.0)
        if not right.all():
            first = int(np.argmin(right))
            raise RunFileRefused(f"/{group} is damaged: row {rows[first]} has the {name} {values[first]:g}")
