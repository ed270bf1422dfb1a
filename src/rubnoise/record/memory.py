"""A run kept in memory, column by column."""

from dataclasses import dataclass, field
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.record.sink import Columns, Extent

_LINE = 64
"""Bytes at whose multiples columns begin, as the processor fetches them."""


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class MemoryRecord:
    """The columns of a run as arrays: ``record["trace"]["real_contact_area"]``, named as in a result file.

    ``pulse`` is the shape of the lives in it. It takes rows as a Sink does, and gives them back as Rows.
    """

    extent: Extent
    groups: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict)
    pulse: Pulse = LENS
    _room: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict, repr=False)

    def __getitem__(self, group: str) -> dict[str, NDArray[Any]]:
        """Return the columns of one group."""
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
        """Keep rows of a group (see Sink)."""
        rows = self.extent.rows(group)
        if rows is None:
            self._grow(group, columns, first_row + next(iter(columns.values())).size)
        elif group not in self.groups:
            self.groups[group] = _room_for(columns, rows)
        kept = self.groups[group]
        for name, values in columns.items():
            kept[name][first_row : first_row + values.size] = values

    def protect(self) -> None:
        """Make all columns read-only, since the run has ended and its arrays are given to callers without a copy."""
        for columns in self.groups.values():
            for values in columns.values():
                values.flags.writeable = False

    def _grow(self, group: str, columns: Columns, rows: int) -> None:
        """Enlarge a group to a number of rows; allocate memory for twice as many, so that rows are seldom copied."""
        room = self._room.get(group)
        if room is None or rows > next(iter(room.values())).size:
            room = self._room[group] = _room_for(columns, 2 * rows)
            for name, values in self.groups.get(group, {}).items():
                room[name][: values.size] = values
        self.groups[group] = {name: values[:rows] for name, values in room.items()}


def _room_for(columns: Columns, rows: int) -> dict[str, NDArray[Any]]:
    """Return columns of ``rows`` rows in one piece of memory, which the system allocates faster than many pieces."""
    sizes = {name: rows * values.itemsize for name, values in columns.items()}
    places = np.cumsum([0, *(ceil(size / _LINE) * _LINE for size in sizes.values())])
    memory = np.empty(int(places[-1]), dtype=np.uint8)
    return {
        name: memory[place : place + size].view(columns[name].dtype)
        for (name, size), place in zip(sizes.items(), places[:-1].tolist(), strict=True)
    }
