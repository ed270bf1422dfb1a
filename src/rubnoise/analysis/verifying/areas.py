"""The one check that is not the engine's own: areas of the textbook, summed over the rows of a file at some ticks."""

from typing import Final

import numpy as np

from rubnoise.analysis.reading import Window
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.arrays import Integers
from rubnoise.contact.off_centre import area_of, half_life
from rubnoise.model import Model
from rubnoise.record.reader import Rows

TICKS: Final = 1000
"""At how many ticks, spread evenly from the first to the last, areas are summed."""

FORMULA: Final = 2.0**-48
"""By how much the area of either way, over d^2, may be off but for its arc cosine: ages are right to 2^-51."""

ROUNDED: Final = 2.0**-53
"""By how much the argument r of the arc cosine may be off: its value then is by that over sqrt(1 - r^2)."""

STEEPEST: Final = 2.0**-27
"""sqrt(1 - r^2) of the largest r below 1, about: nearer to birth and death the textbook's area is 0."""

SUM: Final = 2.0**-52
"""By how much two sums in another order may differ: 2^-53 of the whole at each addition of either."""


def area_check(model: Model, rows: Rows) -> Check:
    """Return whether /trace has, at TICKS ticks, the areas (um^2) that the junctions in the file sum up to.

    By d^2 (acos r - r sqrt(1 - r^2))/2, the textbook's formula (`rubnoise.contact.overlap`, and `off_centre` beside
    it), which the engine does not use. It loses digits near birth and death; the bound grows with what it loses.
    """
    notes, window = Notes("areas"), Window(rows)
    for tick in chosen_ticks(rows.rows("trace")).tolist():
        area, allowed = _summed(model, window, tick * model.tick)
        found = rows.column("trace", "real_contact_area", tick, tick + 1)
        notes.near("/trace/real_contact_area", tick, found, np.array([area]), allowed)
    return notes.check()


def chosen_ticks(rows: int) -> Integers:
    """Return TICKS numbers of ticks, or all there are, spread evenly from the first to the last."""
    return np.unique(np.rint(np.linspace(0, rows - 1, min(TICKS, rows))).astype(np.int64))


def _summed(model: Model, window: Window, distance: float) -> tuple[float, float]:
    """Return the area at a distance (um), which lies beyond the one before, and by how much it may be off (um^2)."""
    area, allowed, count = 0.0, 0.0, 0
    centred = model.pulse.offset == "none"
    for each in window.until(distance):
        there = each.where((each.birth <= distance) & (distance < each.death))
        offset = None if centred else there.offset
        age, square = distance - there.birth, there.diameter * there.diameter
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            area += float(area_of(model.pulse, age, there.diameter, offset).sum())
            root = np.sqrt(np.maximum(age * (2.0 * half_life(there.diameter, offset) - age), 0.0)) / there.diameter
            allowed += float((square * (FORMULA + ROUNDED / np.maximum(root, STEEPEST))).sum())
        count += age.size
    return area, allowed + count * SUM * area
