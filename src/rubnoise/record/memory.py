"""A run kept in memory, column by column."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.record.sink import Columns, Extent


@dataclass(frozen=True, slots=True)
class MemoryRecord:
    """The columns of a run as arrays: ``record["trace"]["real_contact_area"]``, named as in a result file.

    ``pulse`` is the shape of the lives in it.
    """

    extent: Extent
    groups: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict)
    pulse: Pulse = LENS

    def __getitem__(self, group: str) -> dict[str, NDArray[Any]]:
        """Return the columns of one group."""
        return self.groups[group]

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep rows of a group (see Sink)."""
        kept = self.groups.setdefault(group, {})
        rows = {"junctions": self.extent.junctions, "blocks": self.extent.blocks}.get(group, self.extent.ticks)
        for name, values in columns.items():
            column = kept.get(name)
            if column is None:
                column = kept[name] = np.empty(rows, dtype=values.dtype)
            column[first_row : first_row + values.size] = values
