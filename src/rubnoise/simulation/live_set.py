"""The junctions of a block that are alive, as their processes say it."""

from dataclasses import replace

import numpy as np
from simpy import Process

from rubnoise.simulation.state import LiveRows


class LiveSet:
    """The junctions of a block, and which of them are alive: what the processes say, and nothing else.

    ``processes`` holds the process of each junction that is alive, by its row number, in order of birth; interrupting
    one ends that junction where the clock stands.
    """

    def __init__(self, carried: LiveRows, born: LiveRows, begin: float) -> None:
        """Hold the rows of a block that begins at a distance (um); none has a process yet."""
        self._rows = carried.then(born)
        self._half_life = self._rows.half_life
        self.joined = len(carried)
        self.processes: dict[int, Process] = {}
        self.numbers: list[int] = self._rows.junction.tolist()
        self.departure: list[float] = self._rows.departure.tolist()
        for row in np.flatnonzero(carried.death <= begin).tolist():
            self.departure[row] = float(carried.death[row])

    def birth_and_half_life(self, row: int) -> tuple[float, float]:
        """Return a junction's birth and how far it slides to its mid-life (um)."""
        return float(self._rows.birth[row]), float(self._half_life[row])

    def rows(self) -> LiveRows:
        """Return the junctions that have joined so far, with the departures of those that have left."""
        return replace(self._rows, departure=np.array(self.departure)).part(0, self.joined)

    def alive(self) -> LiveRows:
        """Return the junctions that have a process now, in order of birth."""
        numbers = np.fromiter(self.processes, np.int64, len(self.processes))
        return self._rows.at(np.searchsorted(self._rows.junction, numbers))
