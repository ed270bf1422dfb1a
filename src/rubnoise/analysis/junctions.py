"""Junctions of a result file: those that meet a condition or live in a stretch, and one of them, whole."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from math import ceil, isnan, sqrt
from typing import Any, Final, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.where import Choose
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import LENS, Pulse, area_of, half_life
from rubnoise.errors import RunFileRefused
from rubnoise.record.rows import JunctionState, Reader, Rows, chunks, refuse_touches
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


# One life.
STEPS: Final = 100  # points of a curve to a diameter of sliding, so that a whole life has 201 with mid-life among them


@dataclass(frozen=True, slots=True, kw_only=True)
class JunctionRow:
    """What a run says of one junction; um and um^2, times in s and strength in MPa if the run has them."""

    number: int
    birth_distance: float
    death_distance: float
    life_distance: float
    diameter: float
    max_area: float
    state: JunctionState
    shear_strength: float | None = None
    birth_time: float | None = None
    death_time: float | None = None
    lateral_offset: float | None = None
    pulse: Pulse = field(default=LENS, repr=False)

    def area_at_age(self, age: ArrayLike) -> Doubles:
        """Return the area in um^2 at sliding distances in um after birth, 0 to the life distance."""
        return area_of(self.pulse, age, self.diameter, self.lateral_offset)


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """The contact where the area of a junction is largest within its life and the record.

    ``beside`` are the others alive there, or just before it if the life was ended there. real_contact_area and
    friction_force are sums over all of them and the junction, of which the shares are its own; they are not those of
    the nearest tick. Forces are None without a strength.
    """

    distance: float
    time: float | None
    area: float
    real_contact_area: float
    area_share: float
    force: float | None
    friction_force: float | None
    force_share: float | None
    beside: Neighbours


@dataclass(frozen=True, kw_only=True)
class Life(JunctionRow):
    """One junction and those that it shared the contact with; um, um^2, s, MPa, uN.

    ``others`` are the rows that overlap its life anywhere; times are None without a sliding speed and if the slider
    never passed. The record is from 0 to ``record_end``; outside of it the other live junctions are unknown.
    ``slides_evenly``: whether distance is a multiple of time.
    """

    rows: int
    slides_evenly: bool
    record_end: float
    others: Neighbours

    @property
    def half_life(self) -> float:
        """Sliding distance in um from birth to mid-life: d, off the centre line sqrt(d^2 - b^2)."""
        d, b = self.diameter, self.lateral_offset
        return d if b is None else sqrt((d - b) * (d + b))

    @property
    def mid_life_distance(self) -> float | None:
        """Distance in um of the largest area, birth + d (paper Eq. 5); None if the life was ended before."""
        return self.birth_distance + self.half_life if self.life_distance >= self.half_life else None

    @cached_property
    def peak(self) -> Peak:
        """The contact at mid-life, or nearest to it if the life was ended before, or it lies outside of the record."""
        birth, life = self.birth_distance, self.life_distance
        age = min(max(min(self.half_life, life), -birth), self.record_end - birth)
        distance = self.death_distance if age == life else birth + age
        beside = self.others.alive(distance, just_before=age == life)
        area, areas = float(self.area_at_age(age)), beside.area(distance)
        total, time, force, friction = area + float(areas.sum()), self.time(distance), None, None
        if self.shear_strength is not None and beside.strength is not None:
            force = self.shear_strength * area
            friction = force + float((beside.strength * areas).sum())
        return Peak(
            distance=distance,
            time=None if time is None else float(time),
            area=area,
            real_contact_area=total,
            # A junction that is born where the record ends has no area yet, and may be the only one.
            area_share=area / total if total else 0.0,
            force=force,
            friction_force=friction,
            force_share=None if force is None or friction is None else force / friction if friction else 0.0,
            beside=beside,
        )

    def time(self, distance: ArrayLike) -> Doubles | None:
        """Return the time in s at sliding distances in um if the speed is constant; otherwise None."""
        if self.birth_time is None or self.death_time is None or not self.slides_evenly:
            return None
        length = self.death_distance - self.birth_distance
        # Far from the origin a life may be shorter than the step between two doubles.
        pace = (self.death_time - self.birth_time) / length if length else 0.0
        return self.birth_time + pace * (np.asarray(distance, dtype=np.float64) - self.birth_distance)

    def curve(self) -> dict[str, Doubles]:
        """Return distance, time, area and force (those that the run has) from birth to death, mid-life included.

        There are a hundred steps up to mid-life, and steps as long from there to death.
        """
        top = min(self.half_life, self.life_distance)
        age = np.linspace(0.0, top, STEPS + 1)
        if self.life_distance > top:
            steps = max(1, ceil(STEPS * (self.life_distance - top) / self.half_life - 1e-9))
            age = np.concatenate([age, np.linspace(top, self.life_distance, steps + 1)[1:]])
        distance, area = self.birth_distance + age, self.area_at_age(age)
        columns = {
            "distance": distance,
            "time": self.time(distance),
            "area": area,
            "force": None if self.shear_strength is None else self.shear_strength * area,
        }
        return {name: values for name, values in columns.items() if values is not None}


def life_of(file: Reader, junction: JunctionRow) -> Life:
    """Return the life of a junction of a run; reads births and deaths of all rows.

    Raises RunFileRefused for a file with rows that are not lives.
    """
    row: dict[str, Any] = {each.name: getattr(junction, each.name) for each in fields(JunctionRow)}
    numbers = {name: value for name, value in row.items() if isinstance(value, float)}
    even = "landmarks" not in file.columns
    # A two-way slider may never have come by: that time is no number.
    never = [name for name in ("birth_time", "death_time") if not even and isnan(numbers.get(name, 0.0))]
    check_numbers("junctions", [junction.number], {n: np.array([numbers[n]]) for n in numbers if n not in never})
    alive = neighbours(file, junction.birth_distance, junction.death_distance)
    end = stored(file.provenance["scenario_resolved"]).model().distance
    row |= {"rows": file.rows("junctions"), "record_end": end} | dict.fromkeys(never)
    return Life(**row, slides_evenly=even, others=alive.chosen(alive.rows != junction.number))
