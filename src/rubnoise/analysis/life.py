"""The life of one junction in a file: the values of its row, its curve, and the contact at its peak."""

import json
from dataclasses import dataclass, fields
from math import ceil, isnan, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.selection import Neighbours, check_numbers, neighbours
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse, area_of
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.record.rows import JunctionState
from rubnoise.units import LENGTH, QuantityError, read_quantity

STEPS: Final = 100
"""Points of a curve to a diameter of sliding, so that a whole life has 201 with mid-life among them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Life:
    """One junction and those that it shared the contact with; um, um^2, s, MPa, uN.

    Its peak is the place of its largest area during its life and the record: at mid-life, unless its life was ended
    before, or mid-life lies outside of the record, 0 to ``record_end``, where the other live junctions are unknown.
    ``others`` are the rows that overlap its life anywhere; times are None without a sliding speed and if the slider
    never passed, forces are None without a strength. ``slides_evenly``: whether distance is a multiple of time.
    """

    number: int
    rows: int
    birth_distance: float
    death_distance: float
    life_distance: float
    diameter: float
    max_area: float
    state: JunctionState
    shear_strength: float | None
    birth_time: float | None
    death_time: float | None
    slides_evenly: bool
    record_end: float
    others: Neighbours
    lateral_offset: float | None = None

    @property
    def half_life(self) -> float:
        """Sliding distance in um from birth to mid-life: d, or sqrt(d^2 - b^2) at a lateral offset b."""
        d, b = self.diameter, self.lateral_offset or 0.0
        return d if not b else sqrt((d - b) * (d + b))

    @property
    def pulse(self) -> Pulse:
        """The shape of its life, and of the others'."""
        return self.others.pulse

    @property
    def mid_life_distance(self) -> float | None:
        """Sliding distance of the largest area, birth + d (paper Eq. 5), or None if the life was ended before.

        Off the centre line it is birth + sqrt(d^2 - b^2).
        """
        middle = self.birth_distance + self.half_life
        return middle if self.life_distance >= self.half_life else None

    @property
    def peak_age(self) -> float:
        """Sliding distance in um from birth to the largest area within life and record: half of a whole life."""
        reached = min(self.half_life, self.life_distance)
        return min(max(reached, -self.birth_distance), self.record_end - self.birth_distance)

    @property
    def peak_distance(self) -> float:
        """Sliding distance in um of that area."""
        return self.death_distance if self._peaks_at_death else self.birth_distance + self.peak_age

    @property
    def peak_area(self) -> float:
        """That area in um^2; for a life ended before mid-life, the area that it reached."""
        return float(self.area_at_age(self.peak_age))

    @property
    def peak_force(self) -> float | None:
        """Friction force at the peak distance in uN: strength times peak area."""
        return None if self.shear_strength is None else self.shear_strength * self.peak_area

    @property
    def beside(self) -> Neighbours:
        """The others alive at the peak distance, or just before it if this life was ended there."""
        return self.others.alive(self.peak_distance, just_before=self._peaks_at_death)

    @property
    def real_contact_area(self) -> float:
        """Real contact area at the peak distance in um^2: the sum over all rows alive there, not the nearest tick's."""
        return self.peak_area + float(self.beside.area(self.peak_distance).sum())

    @property
    def friction_force(self) -> float | None:
        """Friction force at the peak distance in uN, the sum of strength times area over the same rows."""
        beside = self.beside
        if self.peak_force is None or beside.strength is None:
            return None
        return self.peak_force + float((beside.strength * beside.area(self.peak_distance)).sum())

    @property
    def area_share(self) -> float:
        """Share of this junction in the real contact area at its peak."""
        return _share(self.peak_area, self.real_contact_area)

    @property
    def force_share(self) -> float | None:
        """Share of this junction in the friction force at its peak."""
        own, whole = self.peak_force, self.friction_force
        return None if own is None or whole is None else _share(own, whole)

    def time(self, distance: ArrayLike) -> Doubles | None:
        """Return the time in s at sliding distances in um if the speed is constant; otherwise None."""
        if self.birth_time is None or self.death_time is None or not self.slides_evenly:
            return None
        length = self.death_distance - self.birth_distance
        # Far from the origin a life may be shorter than the step between two doubles.
        pace = (self.death_time - self.birth_time) / length if length else 0.0
        return self.birth_time + pace * (np.asarray(distance, dtype=np.float64) - self.birth_distance)

    def area_at_age(self, age: ArrayLike) -> Doubles:
        """Return the area in um^2 at sliding distances after birth, 0 to the life distance."""
        return area_of(self.pulse, age, self.diameter, self.lateral_offset)

    def curve(self) -> dict[str, Doubles]:
        """Return distance, time, area and force (those that the run has) from birth to death, mid-life included."""
        age = _ages(self.half_life, self.life_distance)
        distance = self.birth_distance + age
        columns = {
            "distance": distance,
            "time": self.time(distance),
            "area": self.area_at_age(age),
            "force": None if self.shear_strength is None else self.shear_strength * self.area_at_age(age),
        }
        return {name: values for name, values in columns.items() if values is not None}

    @property
    def _peaks_at_death(self) -> bool:
        return self.peak_age == self.life_distance


def life_of(file: Reader, number: int) -> Life:
    """Return the life of one junction by its row number; reads its row, and births and deaths of all rows.

    Raises Refused, naming the range, if there is no such row, RunFileRefused for a file without the end of its record,
    or with rows that are not lives.
    """
    rows = file.rows("junctions")
    if not 0 <= number < rows:
        there = f"it has junctions 0 to {rows - 1}" if rows else "it has no junctions at all"
        raise Refused(f"there is no junction {number} in this run; {there}")
    row: dict[str, Any] = {
        name: file.column("junctions", name, number, number + 1)[0].item()
        for name in file.columns["junctions"]
        if name != "junction"
    }
    even = "landmarks" not in file.columns
    # A two-way slider may never have come by: that time is no number.
    checked = row if even else {name: value for name, value in row.items() if name not in {"birth_time", "death_time"}}
    check_numbers("junctions", [number], {name: np.array([value]) for name, value in checked.items()})
    known = {each.name: row.get(each.name) for each in fields(Life) if each.name in row}
    times = {name: _known(row.get(name)) for name in ("birth_time", "death_time")}
    others = neighbours(file, number, row["birth_distance"], row["death_distance"])
    return Life(
        **{"shear_strength": None} | known | times | {"state": JunctionState(row["state"])},
        number=number,
        rows=rows,
        slides_evenly=even,
        record_end=record_end(file),
        others=others,
    )


def record_end(file: Reader) -> float:
    """Return the sliding distance in um at which a run stopped, from its own scenario; the last tick may lie before.

    Raises RunFileRefused if its scenario does not have it.
    """
    try:
        return float(
            read_quantity(json.loads(str(file.provenance["scenario_resolved"]))["sliding"]["distance"], LENGTH)
        )
    except (KeyError, TypeError, AttributeError, ValueError, RecursionError, QuantityError) as problem:
        raise RunFileRefused("the scenario in the file gives no sliding distance") from problem


def _known(time: float | None) -> float | None:
    return None if time is None or isnan(time) else time


def _share(part: float, whole: float) -> float:
    # Born where the record ends: no area yet, and perhaps no other junction has one.
    return part / whole if whole else 0.0


def _ages(half_life: float, life: float) -> Doubles:
    """Return distances since birth: a hundred steps up to mid-life, and steps as long from there to death."""
    top = min(half_life, life)
    rising = np.linspace(0.0, top, STEPS + 1)
    if life <= top:
        return rising
    steps = max(1, ceil(STEPS * (life - top) / half_life - 1e-9))
    return np.concatenate([rising, np.linspace(top, life, steps + 1)[1:]])
