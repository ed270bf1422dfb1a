"""Being told of lives while they happen: births, mid-lives and deaths, as the clock passes them."""

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from rubnoise.errors import Refused
from rubnoise.simulation.state import LiveRows

Told = Callable[[int, float], None]
"""Is told the row number of a junction and the distance in um at which something happens to it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Observer:
    """Functions that are told of every birth, mid-life (at birth + d) and death while it happens; None for no interest.

    Each is given the junction's number, which is its row in /junctions, and the distance in um of what happens, to the
    bit that of the row. Junctions alive at the start have been born before, and those alive at the end die later:
    nothing is told of either. Only who asks for mid-lives pays for them, with one more event a junction. Raises Refused
    for what cannot be called.
    """

    birth: Told | None = None
    mid_life: Told | None = None
    death: Told | None = None

    def __post_init__(self) -> None:
        for event in fields(self):
            told = getattr(self, event.name)
            if told is not None and not callable(told):
                raise Refused(f"Observer: {event.name}: {told!r} is no function of a junction's number and a distance")


class Telling:
    """Tells an observer everything once, wherever a run is cut into blocks."""

    def __init__(self, observer: Observer) -> None:
        """Know of nobody yet."""
        self._observer = observer
        self._rising: set[int] = set()
        self._alive: set[int] = set()
        self._begun = False

    def begin(self, carried: LiveRows, distance: float) -> None:
        """Take note of who is alive where the first block begins (um)."""
        if not self._begun:
            self._begun = True
            self._alive.update(carried.junction[carried.death > distance].tolist())
            self._rising.update(carried.junction[_middle(carried) > distance].tolist())

    def is_rising(self, junction: int) -> bool:
        """Whether a mid-life is still to be told, and somebody asks for it."""
        return self._observer.mid_life is not None and junction in self._rising

    def birth(self, junction: int, distance: float) -> None:
        """Tell of a birth."""
        self._alive.add(junction)
        self._rising.add(junction)
        if self._observer.birth is not None:
            self._observer.birth(junction, distance)

    def mid_life(self, junction: int, distance: float) -> None:
        """Tell of a mid-life, unless that has been done."""
        if junction in self._rising:
            self._rising.remove(junction)
            if self._observer.mid_life is not None:
                self._observer.mid_life(junction, distance)

    def death(self, junction: int, distance: float) -> None:
        """Tell of a death, unless that has been done."""
        if junction in self._alive:
            self._alive.remove(junction)
            self._rising.discard(junction)
            if self._observer.death is not None:
                self._observer.death(junction, distance)

    def settle(self, rows: LiveRows, distance: float) -> None:
        """Tell what happens at the very end of a block (um): rounding decides whether its clock came to it."""
        moments = [(_middle(rows), self._rising, self.mid_life), (rows.death, self._alive, self.death)]
        for places, waiting, tell in moments:
            for row in np.flatnonzero(places <= distance).tolist():
                if int(rows.junction[row]) in waiting:
                    tell(int(rows.junction[row]), float(places[row]))


def _middle(rows: LiveRows) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Where each life has its greatest area, in um; nowhere for a life that ends before."""
    middle = rows.birth + rows.diameter
    return np.where(middle < rows.death, middle, np.inf)
