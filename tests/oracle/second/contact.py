"""The ticks of a run compared with its rows in a window that moves on: distance, live count, area and force.

Like everything in this folder it knows the model, rows and theory, and of the simulation its compiler alone.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.reading import Ahead
from rubnoise.arrays import CHUNK_ROWS, Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.record.reader import Chunk, Rows, chunks
from rubnoise.runs.verification import Check
from tests.oracle.second.notes import Notes
from tests.oracle.second.sums import add_areas


# The junctions that live in a stretch of a run, while the stretch moves on.
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


# The ticks of a run compared with its rows: distance, live count, area and force, each summed anew.
FORMULA: Final = 3e-14
"""By how much two ways to an area over d^2 may differ: the kernel rounds places and not ages."""

SUM: Final = 2.0**-52
"""By how much two sums in another order may differ: 2^-53 of the whole at each addition of either."""


class Rebuilt:
    """What the junctions of a stretch sum up to at its ticks: live count, area (um^2), force (uN), and how exactly."""

    def __init__(self, model: Model, distance: Doubles) -> None:
        """Begin without junctions."""
        self._model = model
        self._distance = distance
        self._change = np.zeros(distance.size + 1, dtype=np.int64)
        self._largest, self._strongest = 0.0, 0.0
        self.area, self.force = np.zeros(distance.size), np.zeros(distance.size)

    def add(self, junctions: Junctions) -> None:
        """Take in some junctions: one counts while birth <= s < death."""
        first, last = (np.searchsorted(self._distance, place) for place in (junctions.birth, junctions.death))
        ticks = self._change.size
        self._change += np.bincount(first, minlength=ticks) - np.bincount(last, minlength=ticks)
        shapes: tuple[Doubles, ...] = (junctions.birth, junctions.diameter, junctions.strength)
        if self._model.pulse.offset != "none":
            shapes = (*shapes, junctions.offset)
        add_areas(self._model.pulse, self._distance, (first, last), shapes, self.area, self.force)
        square = junctions.diameter * junctions.diameter
        self._largest = max(self._largest, float(square.max(initial=0.0)))
        self._strongest = max(self._strongest, float((square * junctions.strength).max(initial=0.0)))

    @property
    def count(self) -> NDArray[np.int64]:
        """How many live at each tick."""
        return np.cumsum(self._change)[:-1]

    @property
    def area_rounding(self) -> Doubles:
        """By how much the area at each tick may be off, in um^2."""
        return self._rounding(self._largest, self.area)

    @property
    def force_rounding(self) -> Doubles:
        """By how much the force at each tick may be off, in uN."""
        return self._rounding(self._strongest, self.force)

    def _rounding(self, largest: float, total: Doubles) -> Doubles:
        """Return N (3e-14 of the largest one + 2^-52 of the sum): every term is off by a little, and every addition."""
        return self.count * (FORMULA * largest + SUM * total)


def contact_checks(model: Model, rows: Rows) -> list[Check]:
    """Return whether every tick lies where it should and shows what the rows of /junctions sum up to."""
    ticks, counts, areas, forces = (Notes(name) for name in ("ticks", "counts", "areas", "forces"))
    window = Window(rows)
    for chunk in chunks(rows, "trace"):
        distance = np.arange(chunk.first, chunk.end, dtype=np.float64) * model.tick
        rebuilt = Rebuilt(model, distance)
        for junctions in window.until(float(distance[-1]) if distance.size else 0.0):
            rebuilt.add(junctions)
        ticks.equal("/trace/distance", chunk.first, chunk["distance"], distance)
        counts.equal("/trace/junction_count", chunk.first, chunk["junction_count"], rebuilt.count)
        areas.near(
            "/trace/real_contact_area", chunk.first, chunk["real_contact_area"], rebuilt.area, rebuilt.area_rounding
        )
        if "friction_force" in chunk:
            _check_force(forces, model, chunk, rebuilt)
    return [ticks, counts, areas, forces][: 4 if model.strengths is not None else 3]


def _check_force(notes: Notes, model: Model, chunk: Chunk, rebuilt: Rebuilt) -> None:
    """Compare with psi A_r bit for bit where strengths are equal, else with the sum over junctions."""
    place: tuple[str, int, NDArray[Any]] = ("/trace/friction_force", chunk.first, chunk["friction_force"])
    if isinstance(model.strengths, Fixed):
        notes.equal(*place, model.strengths.mean * chunk["real_contact_area"])
    else:
        notes.near(*place, rebuilt.force, rebuilt.force_rounding)
