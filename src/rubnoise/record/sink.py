"""The protocol for code that takes the rows of a run."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, Self

from numpy.typing import NDArray

from rubnoise.model import Model

Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """The number of rows of each group of a run, known exactly before its first event.

    None: the rows grow with the run, and only its end tells their number. junctions: None under a slider that
    may leave its contact; slider: 0 without one, None in a two-way run; landmarks: None in either of these, else 0;
    balance: a row in a two-way run; load: 0 without one that weighs.
    """

    junctions: int | None
    ticks: int
    slider: int | None
    landmarks: int | None = 0
    load: int = 0

    @classmethod
    def of(cls, model: Model, junctions: int) -> Self:
        """Return the extent of a run of a model with so many junctions, if its motion does not decide that."""
        ticks, free = model.tick_count + 1, model.free is not None
        return cls(
            junctions=None if free else junctions,
            ticks=ticks,
            slider=model.slider_rows,
            landmarks=None if free or model.is_two_way else 0,
            load=0 if model.held is None else ticks,
        )

    def rows(self, group: str) -> int | None:
        """Return the number of rows of a group that is named as in a result file; None if it grows."""
        return {
            "junctions": self.junctions,
            "trace": self.ticks,
            "slider": self.slider,
            "load": self.load,
            "landmarks": self.landmarks,
            "balance": 0 if self.landmarks == 0 else 1,
        }[group]


class Sink(Protocol):
    """Keeps columns of rows; groups and columns are named as in a result file."""

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep rows ``first_row``... of a group, such as "junctions" or "trace"; `Extent.rows` knows them all.

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
