"""Protocols for readers of a run's rows, and chunks of rows."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.record.sink import Extent

Attributes = Mapping[str, float | int | str]


class Rows(Protocol):
    """The columns of a run, in a file or elsewhere, with the names and units of a result file."""

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Names of the columns of each group."""
        ...

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        ...

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return rows ``start`` to ``stop`` (to the end when None) of a column."""
        ...


class Reader(Rows, Protocol):
    """A run with its rows and its attributes."""

    @property
    def path(self) -> Path:
        """The path of the file."""
        ...

    @property
    def extent(self) -> Extent:
        """The number of rows of each group."""
        ...

    @property
    def attributes(self) -> Attributes:
        """Format, title, source and the formula of a junction's area."""
        ...

    @property
    def summary(self) -> Attributes:
        """Measured and exact figures by name."""
        ...

    @property
    def provenance(self) -> Attributes:
        """Scenario, software, seed, command and times."""
        ...


class HashedReader(Reader, Protocol):
    """A run that stores hashes of its columns and attributes."""

    @property
    def seal(self) -> str:
        """The hash of the attributes; None if there is none."""
        ...

    def damaged(self) -> tuple[str, ...]:
        """Return the columns that cannot be read or differ from their stored hash."""
        ...

    def inventory(self) -> Mapping[str, Mapping[str, Any]]:
        """Return every group, column and attribute of the file, also objects of others."""
        ...


class Chunk(Mapping[str, NDArray[Any]]):
    """Rows ``first`` ... ``end`` - 1 of a group by the names of its columns, each read when it is needed."""

    def __init__(self, rows: Rows, group: str, first: int, end: int) -> None:
        """Read nothing yet, since unpacking a column takes time."""
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
        """Whether the group has a column, without reading it."""
        return name in self._rows.columns[self._group]


def chunks(rows: Rows, group: str, size: int | None = None) -> Iterator[Chunk]:
    """Yield all columns of a group from its first row to its last, ``size`` rows (CHUNK_ROWS when None) at a time."""
    for part in slices(0, rows.rows(group), size):
        yield Chunk(rows, group, part.start, part.stop)


def column_chunks(
    rows: Rows, group: str, name: str, start: int = 0, stop: int | None = None, *, size: int | None = None
) -> Iterator[NDArray[Any]]:
    """Yield rows ``start`` to ``stop`` (to the end when None) of a column, as `chunks` yields all columns."""
    for part in slices(start, rows.rows(group) if stop is None else stop, size):
        yield rows.column(group, name, part.start, part.stop)
