"""A stretch of a result for a picture, read in chunks and thinned to the points that a picture can show."""

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import ceil, floor
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, chunk_of_steps
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.reader import Reader, Rows, chunks, column_chunks
from rubnoise.scenario.reading import stored

MOST_POINTS: Final = 3000
"""Points of a curve that a picture of this size can show apart; of more only the extremes are drawn."""

MOST_READ: Final = 4_194_304
"""Rows that are read at once if a picture needs them together; more of them change the picture little."""

SLACK: Final = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """A result, the physics of its run, and the sliding distances in um between which it is shown.

    ``chosen``: whether the user chose this stretch; otherwise it is the default.
    """

    file: Reader
    model: Model
    title: str
    start: float
    stop: float
    chosen: bool

    @classmethod
    def of(cls, file: Reader, start: float | None = None, stop: float | None = None) -> Self:
        """Return a stretch of an open result, all of it by default; raises Refused if it has fewer than two ticks."""
        model = stored(file.provenance["scenario_resolved"]).model()
        whole = cls(
            file=file,
            model=model,
            title=str(file.attributes["title"]),
            start=0.0 if start is None else start,
            stop=model.distance if stop is None else min(stop, model.distance),
            chosen=not (start is None and stop is None),
        )
        whole.check()
        return whole

    @property
    def has_theory(self) -> bool:
        """Whether theory knows the statistics of the contact: not of a slider that may leave it."""
        return self.model.free is None

    def check(self) -> None:
        """Raise Refused if there is nothing to show between the two distances."""
        if not 0.0 <= self.start < self.stop:
            ends = f"{self.start:g} to {self.stop:g} um"
            raise Refused(f"nothing lies in {ends}; the run goes from 0 to {self.model.distance:g} um")
        first, last = self.rows("trace")
        if last - first < 2:
            ticks = f"a tick every {self.model.tick:g} um"
            raise Refused(f"{self.start:g} to {self.stop:g} um is too short to draw; the run has {ticks}")

    def first_born(self, distance: float) -> int:
        """Return the first row of /junctions that is born at a distance or later; a few single rows are read."""
        rows = range(self.file.rows("junctions"))
        return bisect_left(
            rows, distance, key=lambda row: float(self.file.column("junctions", "birth_distance", row, row + 1)[0])
        )

    def narrowed(self, width: float) -> Self:
        """Return the stretch itself if the user chose it, else its beginning of a width in um."""
        if self.chosen or self.stop - self.start <= width:
            return self
        return replace(self, stop=self.start + width)

    def whole(self) -> Self:
        """Return the whole run."""
        return replace(self, start=0.0, stop=self.model.distance)

    def rows(self, group: str) -> tuple[int, int]:
        """Return the rows of /trace or /slider in the stretch, as the first and the one after the last.

        Those of /trace are a tick apart. Those of a one-way /slider are, too; a two-way slider passes the two distances
        when it first reaches them.
        """
        if group == "slider" and self.model.is_two_way:
            return self._passages()
        first = ceil(self.start / self.model.tick - SLACK)
        last = floor(self.stop / self.model.tick + SLACK) + 1
        return first, min(last, self.file.rows(group))

    def _passages(self) -> tuple[int, int]:
        """Return the rows of a two-way /slider from its first at the start to the last before it passes the stop.

        It may run back, so that its distances are in no order.
        """
        rows, first = self.file.rows("slider"), 0 if self.start == 0.0 else None
        if first == 0 and self.stop >= self.model.distance:
            return 0, rows
        for chunk in chunks(self.file, "slider"):
            if first is None and (reached := np.flatnonzero(chunk["distance"] >= self.start)).size:
                first = chunk.first + int(reached[0])
            if (passed := np.flatnonzero(chunk["distance"] > self.stop)).size:
                last = chunk.first + int(passed[0])
                return last if first is None else first, last
        return rows if first is None else first, rows


def thinned(rows: Rows, group: str, name: str, first: int, last: int) -> tuple[Doubles, Doubles]:
    """Return row numbers and a column's values; of many rows only the extremes of each few."""
    step = ceil((last - first) / MOST_POINTS)
    if step <= 2:
        return np.arange(first, last, dtype=np.float64), rows.column(group, name, first, last).astype(np.float64)
    # The lowest and the highest of twice as many rows make as many points.
    step *= 2
    places = np.repeat(np.arange(first, last, step) + 0.5 * (step - 1), 2)
    chunks = column_chunks(rows, group, name, first, last, size=chunk_of_steps(step))
    return places, np.stack(lowest_and_highest(chunks, step), axis=-1).ravel()


def lowest_and_highest(chunks: Iterable[NDArray[Any]], step: int) -> tuple[Doubles, Doubles]:
    """Return the lowest and the highest values of each ``step`` rows; chunks hold a whole number of steps."""
    low, high = [], []
    for chunk in chunks:
        starts = np.arange(0, chunk.size, step)
        low.append(np.minimum.reduceat(chunk, starts))
        high.append(np.maximum.reduceat(chunk, starts))
    return np.concatenate(low).astype(np.float64), np.concatenate(high).astype(np.float64)
