"""Select junctions of a result file: by a condition, or because they live in a stretch of sliding.

Rows are read in chunks, to limit memory.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.reading import check_numbers
from rubnoise.analysis.where import Condition
from rubnoise.arrays import CHUNK_ROWS, Doubles, slices
from rubnoise.contact.pulses import Pulse, area_of, half_life
from rubnoise.record.reader import Reader, Rows, chunks
from rubnoise.record.rows import refuse_touches
from rubnoise.storage.life_curve import stored_pulse

AREAS_AT_ONCE: Final = 1 << 18
"""Areas that are held at once; their sum is taken piece by piece, so its last bits depend on it."""
NEAR: Final = 4096
"""Rows nearer to each other than this are read together with what lies between them."""

RowNumbers = NDArray[np.int64]


def select(
    file: Rows,
    where: Condition | None = None,
    *,
    sort: str | None = None,
    descending: bool = False,
    head: int | None = None,
) -> tuple[RowNumbers, int]:
    """Return the first ``head`` (all when None) row numbers that satisfy a condition, and the number of all that do.

    Rows of equal ``sort`` stay in order of birth, also when ``descending``; without ``sort`` all do. Only the columns
    of the condition and of the order are read. With ``head``, memory holds ``head`` rows and a chunk.
    """
    best = _Best(head, descending=descending)
    total = 0
    for chunk in chunks(file, "junctions"):
        rows = np.arange(chunk.end - chunk.first) if where is None else np.flatnonzero(where.chosen(chunk))
        total += rows.size
        best.add(rows + chunk.first, rows + chunk.first if sort is None else chunk[sort][rows])
    return best.rows(), total


def gather(file: Rows, rows: RowNumbers, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield columns of the rows, in the given order, a chunk at a time."""
    for part in slices(0, rows.size):
        chunk = rows[part]
        order = np.argsort(chunk, kind="stable")
        spans = list(_spans(chunk[order]))
        yield {name: _gathered(file, name, chunk, order, spans) for name in names}


class _Best:
    """The first rows in the order of some keys, from chunks in order of birth."""

    def __init__(self, head: int | None, *, descending: bool) -> None:
        self._head = head
        self._sign = -1.0 if descending else 1.0
        self._rows: list[RowNumbers] = []
        self._keys: list[NDArray[np.float64]] = []
        self._held = 0

    def add(self, rows: RowNumbers, keys: NDArray[Any]) -> None:
        """Add rows with their keys."""
        signed = self._sign * keys
        if self._head is not None and self._held == self._head:
            # Of equal keys the row that came first wins; written so that a NaN is kept, to be sorted last.
            better = ~(signed >= self._keys[0][-1]) if self._head else np.zeros(rows.size, dtype=np.bool_)
            rows, signed = rows[better], signed[better]
        self._rows.append(rows)
        self._keys.append(signed)
        self._held += rows.size
        if self._head is not None and self._held > self._head:
            self._keep_first()

    def rows(self) -> RowNumbers:
        """Return the rows in order."""
        self._keep_first()
        return self._rows[0]

    def _keep_first(self) -> None:
        rows = np.concatenate([np.zeros(0, dtype=np.int64), *self._rows])
        keys = np.concatenate([np.zeros(0), *self._keys])
        order = np.argsort(keys, kind="stable")[: self._head]
        self._rows, self._keys, self._held = [rows[order]], [keys[order]], order.size


def _spans(rows: RowNumbers) -> Iterator[tuple[int, int]]:
    """Yield the places at which ascending rows are cut into spans that are read at once."""
    cuts = [0, *(np.flatnonzero(np.diff(rows) > NEAR) + 1).tolist(), rows.size]
    for start, stop in pairwise(cuts):
        while rows[stop - 1] - rows[start] >= CHUNK_ROWS:
            middle = int(np.searchsorted(rows, rows[start] + CHUNK_ROWS))
            yield start, middle
            start = middle  # noqa: PLW2901  (the rest of this run)
        yield start, stop


def _gathered(
    file: Rows, name: str, rows: RowNumbers, order: RowNumbers, spans: Sequence[tuple[int, int]]
) -> NDArray[Any]:
    values: NDArray[Any] = np.empty(rows.size, dtype=file.column("junctions", name, 0, 0).dtype)
    for start, stop in spans:
        places = order[start:stop]
        first, last = int(rows[places[0]]), int(rows[places[-1]]) + 1
        values[places] = file.column("junctions", name, first, last)[rows[places] - first]
    return values


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighbours:
    """Some rows of /junctions in order of birth: row numbers, um, MPa (None without strengths), the shape of all.

    offset (um): lateral offsets; None if all pass through both centres.
    """

    rows: NDArray[np.int64]
    birth: Doubles
    death: Doubles
    diameter: Doubles
    strength: Doubles | None
    pulse: Pulse
    offset: Doubles | None = None

    @property
    def half_life(self) -> Doubles:
        """Sliding distance of each from birth to mid-life, in um."""
        return half_life(self.diameter, self.offset)

    def alive(self, distance: float, *, just_before: bool = False) -> Self:
        """Return the rows alive at a distance in um, birth <= s < death, or ``just_before`` it, birth < s <= death."""
        if just_before:
            return self.chosen((self.birth < distance) & (distance <= self.death))
        return self.chosen((self.birth <= distance) & (distance < self.death))

    def only(self, number: int) -> Self:
        """Return the junction with a row number."""
        return self.chosen(self.rows == number)

    def area(self, distance: float) -> Doubles:
        """Return the area in um^2 of each at a distance in um at which all are alive."""
        return area_of(self.pulse, distance - self.birth, self.diameter, self.offset)

    def areas(self, distance: Doubles) -> Doubles:
        """Return the areas in um^2, one row for each junction, at sliding distances in um; 0 if it is not alive."""
        birth, death = self.birth[:, np.newaxis], self.death[:, np.newaxis]
        aside = None if self.offset is None else self.offset[:, np.newaxis]
        areas = area_of(self.pulse, distance - birth, self.diameter[:, np.newaxis], aside)
        return np.where((birth <= distance) & (distance < death), areas, 0.0)

    def total_area(self, distance: Doubles) -> Doubles:
        """Return the sum of their areas in um^2 at sliding distances in um; memory holds some junctions at a time."""
        total = np.zeros(distance.size)
        for part in slices(0, self.rows.size, max(1, AREAS_AT_ONCE // max(1, distance.size))):
            total += self.chosen(part).areas(distance).sum(axis=0)
        return total

    def chosen(self, which: NDArray[np.bool_] | slice) -> Self:
        """Return some of the rows."""
        return type(self)(
            rows=self.rows[which],
            birth=self.birth[which],
            death=self.death[which],
            diameter=self.diameter[which],
            strength=None if self.strength is None else self.strength[which],
            pulse=self.pulse,
            offset=None if self.offset is None else self.offset[which],
        )


def neighbours(file: Reader, number: int, start: float, stop: float, *, touches: bool = False) -> Neighbours:
    """Return all rows except ``number`` that live anywhere between two distances in um; memory holds a chunk at a time.

    Every row is read, since the longest life is not known before, and a file may come from elsewhere. Raises
    RunFileRefused if one of the rows found is not a life, and Refused for touches of free motion, whose rows have no
    area; with ``touches`` only their begins and ends are used.
    """
    if not touches:
        refuse_touches(file.columns["junctions"])
    found = [np.zeros(0, dtype=np.int64)]
    for chunk in chunks(file, "junctions"):
        alive = (chunk["birth_distance"] <= stop) & (chunk["death_distance"] >= start)
        found.append(np.flatnonzero(alive) + chunk.first)
    rows = np.concatenate(found)
    return _neighbours_in(file, rows[rows != number])


def _neighbours_in(file: Reader, rows: NDArray[np.int64]) -> Neighbours:
    names = ["birth_distance", "death_distance", "diameter"]
    names += [name for name in ("shear_strength", "lateral_offset") if name in file.columns["junctions"]]
    chunks = list(gather(file, rows, names))
    columns = {name: np.concatenate([np.zeros(0), *(chunk[name] for chunk in chunks)]) for name in names}
    check_numbers("junctions", rows, columns)
    return Neighbours(
        rows=rows,
        birth=columns["birth_distance"],
        death=columns["death_distance"],
        diameter=columns["diameter"],
        strength=columns.get("shear_strength"),
        pulse=stored_pulse(file.provenance["scenario_resolved"]),
        offset=columns.get("lateral_offset"),
    )
