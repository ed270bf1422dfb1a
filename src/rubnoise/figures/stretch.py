"""A stretch of a result that a picture shows, read in panels and thinned to what a picture can hold."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, floor
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.stored_model import stored_model
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.reader import Reader

MOST_POINTS: Final = 3000
"""Points of a curve that a picture of this size can show apart; of more only the extremes are drawn."""

PANEL_ROWS: Final = 65_536
MOST_READ: Final = 4_194_304
"""Rows that are read at once where a picture needs them together; what they tell changes little with more of them."""

SLACK: Final = 1e-9
Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """A result, the physics of its run, and the sliding distances in um between which it is shown.

    ``chosen`` tells whether somebody asked for this stretch, rather than for the picture alone.
    """

    file: Reader
    model: Model
    title: str
    start: float
    stop: float
    chosen: bool

    @classmethod
    def of(cls, file: Reader, start: float | None = None, stop: float | None = None) -> Self:
        """Return a stretch of an open result, all of it by default; raises Refused where it holds no two ticks."""
        model = stored_model(file)
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

    def check(self) -> None:
        """Raise Refused where there is nothing to be seen between the two distances."""
        if not 0.0 <= self.start < self.stop:
            ends = f"{self.start:g} to {self.stop:g} um"
            raise Refused(f"nothing lies in {ends}; the run goes from 0 to {self.model.distance:g} um")
        first, last = self.rows("trace")
        if last - first < 2:
            ticks = f"a tick every {self.model.tick:g} um"
            raise Refused(f"{self.start:g} to {self.stop:g} um is too short to draw; the run has {ticks}")

    def narrowed(self, width: float) -> Self:
        """Return the stretch itself where somebody chose it, else its beginning of a width in um."""
        if self.chosen or self.stop - self.start <= width:
            return self
        return self._between(self.start, self.start + width)

    def whole(self) -> Self:
        """Return the whole run."""
        return self._between(0.0, self.model.distance)

    def _between(self, start: float, stop: float) -> Self:
        kept = {name: getattr(self, name) for name in ("file", "model", "title", "chosen")}
        return type(self)(**kept, start=start, stop=stop)

    def rows(self, group: str) -> tuple[int, int]:
        """Return the rows of /trace or /slider from the first to behind the last in the stretch.

        Those of /trace are a tick apart; those of /slider as far apart as it takes to drive a tick.
        """
        first = ceil(self.start / self.model.tick - SLACK)
        last = floor(self.stop / self.model.tick + SLACK) + 1
        return first, min(last, self.file.rows(group))

    def panels(self, group: str, name: str, rows: int = PANEL_ROWS) -> Iterator[NDArray[Any]]:
        """Yield a column of the stretch as arrays of so many rows, the last one shorter."""
        first, last = self.rows(group)
        for begin in range(first, last, rows):
            yield self.file.column(group, name, begin, min(begin + rows, last))

    def record(self, group: str, name: str) -> Doubles:
        """Return a column of the stretch as doubles, or its beginning where there is more than a picture needs."""
        first, last = self.rows(group)
        return self.file.column(group, name, first, min(last, first + MOST_READ)).astype(np.float64)

    def curve(self, group: str, name: str) -> tuple[Doubles, Doubles]:
        """Return sliding distances in um and values of a column, of many rows only the extremes of each few.

        However long the stretch, a panel is held at a time.
        """
        first, last = self.rows(group)
        step = ceil((last - first) / MOST_POINTS)
        if step <= 2:
            places = self.model.tick * np.arange(first, last, dtype=np.float64)
            return places, self.file.column(group, name, first, last).astype(np.float64)
        # The lowest and the highest of twice as many rows make as many points.
        return self._extremes(group, name, 2 * step)

    def _extremes(self, group: str, name: str, step: int) -> tuple[Doubles, Doubles]:
        first, last = self.rows(group)
        values = []
        for panel in self.panels(group, name, step * max(1, PANEL_ROWS // step)):
            starts = np.arange(0, panel.size, step)
            values.append(np.stack([np.minimum.reduceat(panel, starts), np.maximum.reduceat(panel, starts)], axis=-1))
        places = np.repeat(np.arange(first, last, step) + 0.5 * (step - 1), 2)
        return self.model.tick * places, np.concatenate(values).ravel().astype(np.float64)
