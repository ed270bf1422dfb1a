"""The protocol for code that takes the rows of a run."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from numpy.typing import NDArray

from rubnoise.model import Model

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
