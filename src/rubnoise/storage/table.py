"""A group of a result as a table that other formats are written from, chunk by chunk."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.storage.layout import stored_columns, stored_groups
from rubnoise.storage.reader import RunFile
from rubnoise.storage.schema import CONVENTIONS, Column, Group, Scalar

TABLES: Final = ("junctions", "trace", "slider", "landmarks")
"""The groups that are exported; the life curve is the same in every run of one pulse."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """One group of an open run file: its columns in order, the first one being that on which the others depend."""

    file: RunFile
    group: Group
    columns: tuple[Column, ...]
    rows: int

    @classmethod
    def of(cls, file: RunFile, name: str) -> Self:
        """Return a group that the file has."""
        group = next(group for group in stored_groups(file.features) if group.name == name)
        return cls(file=file, group=group, columns=stored_columns(group, file.features), rows=file.rows(name))

    def chunks(self, rows: int) -> Iterator[tuple[int, list[NDArray[Any]]]]:
        """Yield the first row and the columns of each stretch of at most so many rows."""
        for first in range(0, self.rows, rows):
            stop = min(first + rows, self.rows)
            yield first, [self.file.column(self.group.name, column.name, first, stop) for column in self.columns]

    @property
    def bytes(self) -> int:
        """Size of the columns in the run file, uncompressed."""
        return self.rows * sum(np.dtype(column.dtype).itemsize for column in self.columns)


def origin(file: RunFile) -> dict[str, Scalar]:
    """Return what is kept beside the rows wherever they go: where they come from, and what runs them again."""
    attributes, provenance = file.attributes, file.provenance
    return {
        "Conventions": CONVENTIONS,
        "title": attributes["title"],
        "source": attributes["source"],
        "history": f"{provenance['finished']} {provenance['command']}",
        "junction_area_formula": attributes["junction_area_formula"],
        "scenario_toml": provenance["scenario_toml"],
        "scenario_resolved": provenance["scenario_resolved"],
        "seed": provenance["seed"],
    }
