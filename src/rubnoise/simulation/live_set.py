"""The junctions that are alive, as their processes report it: who has joined, who has left and where."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from simpy import Process

from rubnoise.simulation.state import LiveRows


class LiveSet:
    """The live junctions of a run and their processes, and the rows of the block that is played.

    ``processes`` maps the row number of each live junction to its process, in order of birth; interrupting a process
    ends its junction now.
    """

    def __init__(self) -> None:
        """Hold no junction."""
        self.processes: dict[int, Process] = {}
        self._rows = LiveRows.none()
        self._joined = 0
        self._left: dict[int, float] = {}

    def begin(self, carried: LiveRows, born: LiveRows, distance: float) -> None:
        """Continue with the rows of a block that begins at a distance (um), carried ones and those still to be born."""
        departure = np.where(carried.death <= distance, carried.death, carried.departure)
        self._rows = replace(carried, departure=departure).then(born)
        self._joined = len(carried)
        self._left = {}

    def join(self, number: int, process: Process) -> None:
        """Add the next junction that is born."""
        self.processes[number] = process
        self._joined += 1

    def leave(self, number: int, death: float) -> None:
        """Remove a junction that has died at a distance (um)."""
        del self.processes[number]
        self._left[number] = death

    def rows(self) -> LiveRows:
        """Return the junctions that have joined so far, with the departures of those that have left."""
        left, deaths = np.array(list(self._left), np.int64), np.array(list(self._left.values()))
        departure = self._rows.departure.copy()
        row, known = self._found(left)
        departure[row] = deaths[known]
        return replace(self._rows, departure=departure).part(0, self._joined)

    def alive(self) -> LiveRows:
        """Return the junctions that have a process now, in order of birth."""
        return self._rows.at(self._found(np.array(list(self.processes), np.int64))[0])

    def _found(self, numbers: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Return the rows of junctions, and which have one: the clock rounds, so a life may end after its last row."""
        row = np.searchsorted(self._rows.junction, numbers)
        known = np.isin(numbers, self._rows.junction)
        return row[known], known
