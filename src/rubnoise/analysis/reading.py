"""The columns of a file read from front to back in chunks, so that a longer run needs no more memory."""

from collections.abc import Iterator, Mapping, Sequence
from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.theory.lags import longest_life

CHUNK_ROWS: Final = 65_536


class Chunk(Mapping[str, NDArray[Any]]):
    """Rows ``first`` ... ``end`` - 1 of a group by the names of its columns, each read when it is asked for."""

    def __init__(self, rows: Rows, group: str, first: int, end: int) -> None:
        """Read nothing yet: to unpack a column takes time."""
        self.first, self.end = first, end
        self._rows, self._group = rows, group
        self._read: dict[str, NDArray[Any]] = {}

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the rows of one column; raises KeyError if the group does not have it."""
        if name not in self:
            raise KeyError(name)
        if name not in self._read:
            self._read[name] = self._rows.column(self._group, name, self.first, self.end)
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        """Yield the names of the columns."""
        return iter(self._rows.columns[self._group])

    def __len__(self) -> int:
        """Return the number of columns."""
        return len(self._rows.columns[self._group])

    def __contains__(self, name: object) -> bool:
        """Whether the group has a column; it is not read for that."""
        return name in self._rows.columns[self._group]


def chunks(rows: Rows, group: str, size: int = CHUNK_ROWS) -> Iterator[Chunk]:
    """Yield all columns of a group from its first row to its last, so many rows at a time; of no rows one chunk."""
    total = rows.rows(group)
    for first in range(0, max(total, 1), size):
        yield Chunk(rows, group, first, min(first + size, total))


class Ahead:
    """Rows that are read a whole chunk at a time, for those who go through them in small steps."""

    def __init__(self, rows: Rows) -> None:
        """Read from rows, which are as before."""
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


def checked_chunks(rows: Rows, group: str, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the named columns of a group from its first row to its last, a chunk at a time; those that it has.

    Raises RunFileRefused for a number that is not finite and a diameter that is not positive.
    """
    if not rows.rows(group):
        return
    for chunk in chunks(rows, group, CHECKED_ROWS):
        found = {name: chunk[name] for name in names if name in chunk}
        for name, values in found.items():
            _check(group, name, chunk.first, values)
        yield found


def _check(group: str, name: str, first: int, values: NDArray[Any]) -> None:
    right = np.isfinite(values) if name != "diameter" else np.isfinite(values) & (values > 0.0)
    if not right.all():
        row = int(np.argmin(right))
        raise RunFileRefused(f"/{group} is damaged: row {first + row} has the {name} {values[row]:g}")


def first_stationary_tick(model: Model) -> int:
    """Return the first tick from which the contact is stationary: after a longest life where the start was empty."""
    return 0 if model.start == "stationary" else ceil(longest_life(model) / model.tick)
