"""The rows of a run: their codes, the protocols between code that makes, stores and reads them, and a run in memory."""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.errors import Refused
from rubnoise.model import Model


class JunctionState(IntFlag):
    """The bits of the ``state`` of a junction's row.

    >>> import rubnoise
    >>> rubnoise.JunctionState(3) == rubnoise.JunctionState.ALIVE_AT_START | rubnoise.JunctionState.ALIVE_AT_END
    True
    """

    COMPLETE = 0
    ALIVE_AT_START = 1
    ALIVE_AT_END = 2
    ENDED_EARLY = 4


class Phase(IntEnum):
    """The ``phase`` in a row of a two-way slider: how it moves over the surface."""

    SLIP = 0
    STICK = 1
    REVERSAL = 2


class LandmarkKind(IntEnum):
    """The ``kind`` of a landmark: what a two-way slider begins there. A slip begins with the breakaway from a stick."""

    STICK = 0
    SLIP = 1
    REVERSAL = 2
    FORWARD = 3


class ContactKind(IntEnum):
    """The ``kind`` of a landmark of a slider that may leave its contact."""

    CONTACT_LOST = 4
    CONTACT_MADE = 5


def refuse_touches(names: Container[str]) -> None:
    """Raise Refused if rows are touches, since their areas follow the separation and not the curve of a row."""
    if "encounter" in names:
        raise Refused("rows of free motion are touches, whose areas follow the separation; no row says its curve")


Columns = Mapping[str, NDArray[Any]]


Extent = Mapping[str, int | None]
"""The number of rows of each group of a run, known before its first event, by its name in a result file.

0: the run has none; None: the rows grow with the run, and only its end tells their number.
"""


def extent_of(model: Model, junctions: int) -> Extent:
    """Return the extent of a run of a model with so many junctions, if its motion does not decide that.

    Junctions grow under a slider that may leave its contact, /slider in a two-way run, and landmarks in either.
    """
    ticks, grows = model.tick_count + 1, model.free is not None or model.is_two_way
    return {
        "junctions": junctions if model.free is None else None,
        "trace": ticks,
        "slider": None if model.is_two_way else 0 if model.slider is None else ticks,
        "load": 0 if model.held is None else ticks,
        "landmarks": None if grows else 0,
        "balance": 1 if model.is_two_way else 0,
    }


# Who takes rows, and who gives them.
class Sink(Protocol):
    """Keeps columns of rows; groups and columns are named as in a result file."""

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep rows ``first_row``... of a group, such as "junctions" or "trace"; an `Extent` has them all.

        Rows come in order and without gaps; a row of "junctions" may come again when its junction is ended early.
        """


@dataclass(slots=True)
class Appender:
    """Appends rows of one group to a sink; ``rows`` is their number so far."""

    sink: Sink
    group: str
    rows: int

    def append(self, columns: Columns) -> None:
        """Add rows to the group."""
        self.sink.write(self.group, self.rows, columns)
        self.rows += next(iter(columns.values())).size


@dataclass(frozen=True, slots=True)
class Tee:
    """A sink that passes every row to several sinks in turn."""

    sinks: Iterable[Sink]

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Pass the rows on."""
        for sink in self.sinks:
            sink.write(group, first_row, columns)


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
