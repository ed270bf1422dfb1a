"""A run kept in memory, with the same face as one in a file."""

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from rubnoise.api.column import Column
from rubnoise.api.columns import Columns
from rubnoise.api.contents import Contents
from rubnoise.contact.pulses import Pulse
from rubnoise.record.memory import MemoryRecord
from rubnoise.storage import schema


class Record(MemoryRecord, Contents):
    """A run kept in memory: ``record.trace["real_contact_area"]``, ``record.junction(17)``, ``record.to_xarray()``.

    ``record["trace"]["real_contact_area"]`` is the numpy array itself; groups and columns are named as in a file.
    """

    __slots__ = ()

    def _groups(self) -> Mapping[str, Columns]:
        return {group.name: self._columns(group) for group in schema.GROUPS if group.name in self.groups}

    @property
    def _pulse(self) -> Pulse:
        return self.pulse

    def _columns(self, group: schema.Group) -> Columns:
        arrays = self.groups[group.name]
        kept = [about for about in group.columns if about.name in arrays]
        return Columns(group, {about.name: _column(about, arrays[about.name]) for about in kept})

    def __repr__(self) -> str:
        return "\n".join(["a run in memory", *map(repr, self._groups().values())])


def _column(about: schema.Column, values: NDArray[Any]) -> Column:
    def read(start: int, stop: int) -> NDArray[Any]:
        return values[start:stop]

    return Column(about, values.size, read)
