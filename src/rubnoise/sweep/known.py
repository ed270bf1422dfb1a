"""What the journals of a sweep know of its runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.scenario.points import Point
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.journal import Entry

PLANNED: Final = "planned"
DONE: Final = "done"
FAILED: Final = "failed"


@dataclass(slots=True)
class Known:
    """States, files, reasons and figures of the runs of a plan, one after another in its order.

    ``arrays``: whether the journals have any, which are not held here.
    """

    places: Mapping[str, int]
    states: list[str]
    files: list[str]
    reasons: list[str]
    figures: dict[str, NDArray[np.float64]]
    arrays: bool = False

    @classmethod
    def of(cls, folder: SweepFolder, points: Sequence[Point], counts: Callable[[Entry], bool] | None = None) -> Self:
        """Read the journals; of one run an entry that says done counts more than one that says failed.

        One that says done ``counts`` where its file is the one that was written then, unless asked otherwise.
        """
        count = len(points)
        known = cls({p.run_id: n for n, p in enumerate(points)}, [PLANNED] * count, [""] * count, [""] * count, {})
        for entry in folder.entries():
            if entry.row is not None and not (counts or folder.holds)(entry):
                continue
            if entry.state != "begun" and (place := known.places.get(entry.run_id)) is not None:
                known._take(place, entry)
        return known

    def _take(self, place: int, entry: Entry) -> None:
        if entry.row is None and self.states[place] == DONE:
            return
        self.states[place], self.reasons[place] = entry.state, entry.reason
        if entry.row is not None:
            self.files[place] = entry.row.file
            self.arrays = self.arrays or bool(entry.row.arrays or entry.row.of_point)
            for name, value in entry.row.figures.items():
                if name not in self.figures:
                    self.figures[name] = np.full(len(self.states), np.nan)
                self.figures[name][place] = value

    def count(self, state: str) -> int:
        """Return how many runs are in a state."""
        return self.states.count(state)
