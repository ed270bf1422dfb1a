"""Where the rows of a run go: one small protocol between those who make them and those who keep them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from numpy.typing import NDArray

Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """How many rows each group of a run has, known exactly before its first event."""

    junctions: int
    ticks: int
    blocks: int


class Sink(Protocol):
    """Keeps columns of rows; groups and columns are named as in a result file."""

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep rows ``first_row``... of a group: "junctions", "trace", "slider" or "blocks".

        Rows come in order and without gaps; a row of "junctions" may come once more when its junction is ended early.
        """
        ...


@dataclass(frozen=True, slots=True)
class Tee:
    """A sink that hands every row to several sinks in turn."""

    sinks: Iterable[Sink]

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Hand the rows on."""
        for sink in self.sinks:
            sink.write(group, first_row, columns)
