"""The life of one junction in a file: the values of its row, its curve, and the contact at its peak."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import ceil, isnan, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.selection import Neighbours, check_numbers, neighbours
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import area_of
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.record.rows import JunctionState
from rubnoise.units import LENGTH, QuantityError, read_quantity

STEPS: Final = 100
"""Points of a curve to a diameter of sliding, so that a whole life has 201 with mid-life among them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Life:
    """One junction and those that it shared the contact with; um, um^2, s, MPa, uN.

    mid_life_distance is that of the largest area, birth + d (paper Eq. 5), off the centre line birth + sqrt(d^2 - b^2);
    None if the life was ended before. Its peak is the place of its largest area during its life and the record: at
    mid-life, unless its life was ended before, or mid-life lies outside of the record, 0 to ``record_end``, where the
    other live junctions are unknown. real_contact_area and friction_force are sums over all rows alive there, of which
    the shares are its own, and not those of the nearest tick; ``beside`` are the others there, or just before it if
    this life was ended there. ``others`` are the rows that overlap its life anywhere; times are None without a sliding
    speed and if the slider never passed, forces are None without a strength. ``slides_evenly``: whether distance is a
    multiple of time.
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
    half_life: float
    mid_life_distance: float | None
    peak_age: float
    peak_distance: float
    peak_area: float
    peak_force: float | None
    beside: Neighbours
    real_contact_area: float
    friction_force: float | None
    area_share: float
    force_share: float | None

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
        return area_of(self.others.pulse, age, self.diameter, self.lateral_offset)

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
    others = neighbours(file, number, row["birth_distance"], row["death_distance"])
    end = record_end(file)
    found: dict[str, Any] = {each.name: row.get(each.name) for each in fields(Life) if each.name in row}
    found |= {name: _known(row.get(name)) for name in ("birth_time", "death_time")}
    found |= {"state": JunctionState(row["state"]), "shear_strength": row.get("shear_strength")}
    found |= _at_its_peak(row, others, end)
    return Life(**found, number=number, rows=rows, slides_evenly=even, record_end=end, others=others)


def _at_its_peak(row: Mapping[str, Any], others: Neighbours, end: float) -> dict[str, Any]:
    """Return middle and peak of a life, and the contact at its peak, by the names that a Life has for them."""
    d, birth, life = (row[name] for name in ("diameter", "birth_distance", "life_distance"))
    b = row.get("lateral_offset")
    half = sqrt((d - b) * (d + b)) if b else d
    age = min(max(min(half, life), -birth), end - birth)
    at_death = age == life
    distance = row["death_distance"] if at_death else birth + age
    beside = others.alive(distance, just_before=at_death)
    own, areas = float(area_of(others.pulse, age, d, b)), beside.area(distance)
    total, strength = own + float(areas.sum()), row.get("shear_strength")
    force = whole = None
    if strength is not None and beside.strength is not None:
        force = strength * own
        whole = force + float((beside.strength * areas).sum())
    return {
        "half_life": half,
        "mid_life_distance": birth + half if life >= half else None,
        "peak_age": age,
        "peak_distance": distance,
        "peak_area": own,
        "peak_force": force,
        "beside": beside,
        "real_contact_area": total,
        "friction_force": whole,
        "area_share": _share(own, total),
        "force_share": None if force is None or whole is None else _share(force, whole),
    }


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
