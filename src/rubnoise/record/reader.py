"""Protocols for readers of a run's rows, chunks of rows, and a run that is kept in memory."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.record.sink import Columns, Extent

Attributes = Mapping[str, float | int | str]


class Rows(Protocol):
    """The columns of a run, in a file or elsewhere, with the names and units of a result file."""

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Names of the columns of each group."""

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return rows ``start`` to ``stop`` (to the end when None) of a column."""


class Reader(Rows, Protocol):
    """A run with its rows and its attributes."""

    @property
    def path(self) -> Path:
        """The path of the file."""

    @property
    def attributes(self) -> Attributes:
        """Format, title, source and the formula of a junction's area."""

    @property
    def summary(self) -> Attributes:
        """Measured and exact figures by name."""

    @property
    def provenance(self) -> Attributes:
        """Scenario, software, seed, command and times."""


class Chunk(dict[str, NDArray[Any]]):
    """Rows ``first`` ... ``end`` - 1 of a group by the names of its columns, each read when it is first asked for."""

    def __init__(self, rows: Rows, group: str, first: int, end: int) -> None:
        super().__init__()
        self.first, self.end = first, end
        self._read = partial(rows.column, group, start=first, stop=end)

    def __missing__(self, name: str) -> NDArray[Any]:
        self[name] = self._read(name)
        return self[name]


def chunks(rows: Rows, group: str, size: int | None = None) -> Iterator[Chunk]:
    """Yield all columns of a group from its first row to its last, ``size`` rows (CHUNK_ROWS when None) at a time."""
    for part in slices(0, rows.rows(group), size):
        yield Chunk(rows, group, part.start, part.stop)


def column_chunks(rows: Rows, group: str, name: str, start: int = 0, stop: int | None = None) -> Iterator[NDArray[Any]]:
    """Yield rows ``start`` to ``stop`` (to the end when None) of a column, as `chunks` yields all columns."""
    for part in slices(start, rows.rows(group) if stop is None else stop):
        yield rows.column(group, name, part.start, part.stop)


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class MemoryRecord:
    """The columns of a run as arrays: ``record["trace"]["real_contact_area"]``, named as in a result file.

    It takes rows as a Sink does, and gives them back as Rows.
    """

    extent: Extent
    groups: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict)
    _room: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict, repr=False)

    def __getitem__(self, group: str) -> dict[str, NDArray[Any]]:
        return self.groups[group]

    @property
    def columns(self) -> dict[str, tuple[str, ...]]:
        """Names of the columns of each group."""
        return {name: tuple(columns) for name, columns in self.groups.items()}

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return int(next(iter(self.groups[group].values())).size)

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return rows ``start`` to ``stop`` (to the end when None) of a column."""
        return self.groups[group][name][start:stop]

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep rows of a group (see Sink); where their number is not known, there is room for twice as many."""
        rows, end = self.extent[group], first_row + next(iter(columns.values())).size
        room = self._room.get(group)
        if room is None or end > next(iter(room.values())).size:
            size, before = 2 * end if rows is None else rows, self.groups.get(group, {})
            room = self._room[group] = {name: np.empty(size, values.dtype) for name, values in columns.items()}
            for name, values in before.items():
                room[name][: values.size] = values
        for name, values in columns.items():
            room[name][first_row:end] = values
        self.groups[group] = room if rows is not None else {name: values[:end] for name, values in room.items()}

    def protect(self) -> None:
        """Make all columns read-only, since the run has ended and its arrays are given to callers without a copy."""
        for columns in self.groups.values():
            for values in columns.values():
                values.flags.writeable = False
