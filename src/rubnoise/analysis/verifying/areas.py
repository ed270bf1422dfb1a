"""The one check that is not the engine's own: areas of the textbook, summed over the rows of a file at some ticks."""

from typing import Final

import numpy as np

from rubnoise.analysis.reading import Ahead, chunks
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.arrays import Doubles, Integers
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
    notes, ticks, ahead = Notes("areas"), chosen_ticks(rows.rows("trace")), Ahead(rows)
    area, allowed = _summed(model, rows, ticks.astype(np.float64) * model.tick)
    for n, tick in enumerate(ticks.tolist()):
        found = ahead.column("trace", "real_contact_area", tick, tick + 1)
        notes.near("/trace/real_contact_area", tick, found, area[n : n + 1], allowed[n : n + 1])
    return notes.check()


def chosen_ticks(rows: int) -> Integers:
    """Return TICKS numbers of ticks, or all there are, spread evenly from the first to the last."""
    return np.unique(np.rint(np.linspace(0, rows - 1, min(TICKS, rows))).astype(np.int64))


def _summed(model: Model, rows: Rows, distance: Doubles) -> tuple[Doubles, Doubles]:
    """Return areas at distances (um), and by how much each may be off (um^2)."""
    area, allowed, count = (np.zeros(distance.size) for _ in range(3))
    for chunk in chunks(rows, "junctions"):
        birth, diameter, death = (chunk[name] for name in ("birth_distance", "diameter", "death_distance"))
        offset = chunk.get("lateral_offset")
        # Nobody before the first of these rows lives on to a distance, and from the last on nobody is born yet.
        first = np.searchsorted(np.maximum.accumulate(death), distance, side="right")
        last = np.searchsorted(birth, distance, side="right")
        for n in np.flatnonzero(first < last).tolist():
            near = slice(int(first[n]), int(last[n]))
            alive = np.flatnonzero(death[near] > distance[n]) + near.start
            age, d, b = distance[n] - birth[alive], diameter[alive], None if offset is None else offset[alive]
            with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
                area[n] += area_of(model.pulse, age, d, b).sum()
                root = np.sqrt(np.maximum(age * (2.0 * half_life(d, b) - age), 0.0)) / d
                allowed[n] += (d * d * (FORMULA + ROUNDED / np.maximum(root, STEEPEST))).sum()
            count[n] += alive.size
    return area, allowed + count * SUM * area
