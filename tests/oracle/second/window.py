"""The junctions that live in a stretch of a run, while the stretch moves on."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.reading import CHUNK_ROWS, Ahead
from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows


@dataclass(frozen=True, slots=True, kw_only=True)
class Junctions:
    """Some junctions in order of birth: birth, diameter and death in um, strength in MPa (1 without a law).

    offset (um): by how much each misses the centre line, 0 where all pass through both centres.
    """

    birth: Doubles
    diameter: Doubles
    death: Doubles
    strength: Doubles
    offset: Doubles

    def where(self, keep: NDArray[np.bool_]) -> "Junctions":
        """Return the junctions to keep."""
        return Junctions(**{each.name: getattr(self, each.name)[keep] for each in fields(self)})


class Window:
    """The junctions of a run that live in a stretch of it, while the stretch moves on."""

    def __init__(self, rows: Rows) -> None:
        """Begin before the first row."""
        self._rows = Ahead(rows)
        self._next = 0
        self._carried = self._junctions(0, 0)

    def until(self, distance: float) -> Iterator[Junctions]:
        """Yield the junctions born up to a distance in um that lived beyond the distance before it, some at a time."""
        living = [self._carried]
        yield self._carried
        for born in self._born(distance):
            yield born
            living.append(born)
            living = [_together([each.where(each.death > distance) for each in living])]
        self._carried = _together([each.where(each.death > distance) for each in living])

    def _born(self, distance: float) -> Iterator[Junctions]:
        total = self._rows.rows("junctions")
        while self._next < total:
            end = min((self._next // CHUNK_ROWS + 1) * CHUNK_ROWS, total)
            birth = self._rows.column("junctions", "birth_distance", self._next, end)
            count = int(np.searchsorted(birth, distance, side="right"))
            yield self._junctions(self._next, self._next + count)
            self._next += count
            if count < birth.size:
                return

    def _junctions(self, first: int, end: int) -> Junctions:
        names = ("birth_distance", "diameter", "death_distance")
        birth, diameter, death = (self._rows.column("junctions", name, first, end) for name in names)
        there = self._rows.columns["junctions"]
        strength = (
            self._rows.column("junctions", "shear_strength", first, end)
            if "shear_strength" in there
            else np.ones(birth.size)
        )
        offset = (
            self._rows.column("junctions", "lateral_offset", first, end)
            if "lateral_offset" in there
            else np.zeros(birth.size)
        )
        return Junctions(birth=birth, diameter=diameter, death=death, strength=strength, offset=offset)


def _together(parts: Sequence[Junctions]) -> Junctions:
    return Junctions(
        **{each.name: np.concatenate([getattr(part, each.name) for part in parts]) for each in fields(Junctions)}
    )
