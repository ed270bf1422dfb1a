"""Select junctions of a result file: by a condition, or because they live in a stretch of sliding.

Rows are read in chunks, to limit memory, and checked when they are read.
"""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.where import Choose
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse, area_of, half_life
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import Reader, Rows, chunks
from rubnoise.record.rows import refuse_touches
from rubnoise.scenario.reading import stored

_CHECKED_ROWS: Final = 1 << 18  # of a comparison at once: it sums up each chunk, so its last bits depend on them
RowNumbers = NDArray[np.int64]


def first_row(file: Rows, group: str, name: str, value: float) -> int:
    """Return the first row whose value in a rising column is this or more, or the number of rows if there is none."""
    return bisect_left(range(file.rows(group)), value, key=lambda row: file.column(group, name, row, row + 1)[0])


def select(file: Rows, where: Choose | None, *, sort: str | None = None, descending: bool = False) -> RowNumbers:
    """Return the row numbers that are chosen, all when None, in order of birth or of a column, or the other way.

    Rows of equal ``sort`` stay in order of birth, NaN comes last. Only the columns of the condition and of the order
    are read.
    """
    if where is None:
        rows = np.arange(file.rows("junctions"))
    else:
        chosen = (np.flatnonzero(where(chunk)) + chunk.first for chunk in chunks(file, "junctions"))
        rows = np.concatenate([np.zeros(0, dtype=np.int64), *chosen])
    keys = rows if sort is None else gather(file, rows, [sort])[sort]
    return rows[np.argsort(-keys.astype(np.float64) if descending else keys, kind="stable")]


def gather(file: Rows, rows: RowNumbers, names: Iterable[str]) -> dict[str, NDArray[Any]]:
    """Return columns of the rows, in the given order, from the stretch of the file that has them."""
    first, stop = (int(rows.min()), int(rows.max()) + 1) if rows.size else (0, 0)
    return {name: file.column("junctions", name, first, stop)[rows - first] for name in names}


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

    def area(self, distance: float) -> Doubles:
        """Return the area in um^2 of each at a distance in um at which all are alive."""
        return area_of(self.pulse, distance - self.birth, self.diameter, self.offset)

    def areas(self, distance: Doubles) -> Doubles:
        """Return the areas in um^2, one row for each junction, at sliding distances in um; 0 if it is not alive."""
        birth, death = self.birth[:, np.newaxis], self.death[:, np.newaxis]
        aside = None if self.offset is None else self.offset[:, np.newaxis]
        areas = area_of(self.pulse, distance - birth, self.diameter[:, np.newaxis], aside)
        return np.where((birth <= distance) & (distance < death), areas, 0.0)

    def chosen(self, which: NDArray[np.bool_] | slice) -> Self:
        """Return some of the rows."""
        names = ("rows", "birth", "death", "diameter", "strength", "offset")
        return replace(self, **{n: each[which] for n in names if (each := getattr(self, n)) is not None})


def neighbours(file: Reader, start: float, stop: float, *, touches: bool = False) -> Neighbours:
    """Return all rows that live anywhere between two distances in um; memory holds a chunk at a time.

    Every row is read, since the longest life is not known before, and a file may come from elsewhere. Raises
    RunFileRefused if one of the rows found is not a life, and Refused for touches of free motion, whose rows have no
    area; with ``touches`` only their begins and ends are used.
    """
    if not touches:
        refuse_touches(file.columns["junctions"])
    rows = select(file, lambda chunk: (chunk["birth_distance"] <= stop) & (chunk["death_distance"] >= start))
    names = ("birth_distance", "death_distance", "diameter", "shear_strength", "lateral_offset")
    columns = gather(file, rows, [name for name in names if name in file.columns["junctions"]])
    check_numbers("junctions", rows, columns)
    return Neighbours(
        rows=rows,
        birth=columns["birth_distance"],
        death=columns["death_distance"],
        diameter=columns["diameter"],
        strength=columns.get("shear_strength"),
        pulse=stored(file.provenance["scenario_resolved"]).model().pulse,
        offset=columns.get("lateral_offset"),
    )


def checked_chunks(rows: Rows, group: str, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the named columns that a group has from its first row to its last, a chunk at a time.

    Raises RunFileRefused for a number that is not finite and a diameter that is not positive.
    """
    for chunk in chunks(rows, group, _CHECKED_ROWS):
        found = {name: chunk[name] for name in names if name in rows.columns[group]}
        check_numbers(group, range(chunk.first, chunk.end), found)
        yield found


def check_numbers(group: str, rows: Sequence[int] | NDArray[np.int64], columns: Mapping[str, NDArray[Any]]) -> None:
    """Raise RunFileRefused, naming the first of some rows, if a number is not finite or a diameter not positive."""
    for name, values in columns.items():
        right = np.isfinite(values) if name != "diameter" else np.isfinite(values) & (values > 0.0)
        if not right.all():
            first = int(np.argmin(right))
            raise RunFileRefused(f"/{group} is damaged: row {rows[first]} has the {name} {values[first]:g}")
