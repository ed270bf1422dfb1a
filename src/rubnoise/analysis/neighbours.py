"""Who else was alive: the rows of a result whose lives overlap a stretch of sliding."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import PANEL_ROWS, gather
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.storage.life_curve import stored_pulse


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighbours:
    """Some rows of /junctions in order of birth: row numbers, um, MPa (None without strengths), the shape of all."""

    rows: NDArray[np.int64]
    birth: Doubles
    death: Doubles
    diameter: Doubles
    strength: Doubles | None
    pulse: Pulse

    def alive(self, distance: float, *, just_before: bool = False) -> Self:
        """Return those alive at a distance in um, birth <= s < death, or ``just_before`` it, birth < s <= death."""
        if just_before:
            return self._chosen((self.birth < distance) & (distance <= self.death))
        return self._chosen((self.birth <= distance) & (distance < self.death))

    def area(self, distance: float) -> Doubles:
        """Return the area in um^2 of each at a distance in um at which all are alive."""
        return self.pulse.area(distance - self.birth, self.diameter)

    def total_area(self, distance: Doubles) -> Doubles:
        """Return the sum of their areas in um^2 at sliding distances in um, some junctions at a time."""
        total = np.zeros(distance.size)
        step = max(1, PANEL_ROWS // max(1, distance.size))
        for first in range(0, self.rows.size, step):
            some = self._chosen(slice(first, first + step))
            birth, death = some.birth[:, np.newaxis], some.death[:, np.newaxis]
            areas = self.pulse.area(distance - birth, some.diameter[:, np.newaxis])
            total += np.where((birth <= distance) & (distance < death), areas, 0.0).sum(axis=0)
        return total

    def _chosen(self, which: NDArray[np.bool_] | slice) -> Self:
        return type(self)(
            rows=self.rows[which],
            birth=self.birth[which],
            death=self.death[which],
            diameter=self.diameter[which],
            strength=None if self.strength is None else self.strength[which],
            pulse=self.pulse,
        )


def neighbours(file: Reader, number: int, start: float, stop: float) -> Neighbours:
    """Return all rows but ``number`` that live anywhere between two distances in um; a panel is held at a time.

    Every row is looked at: the longest life is not known beforehand, and a file may come from elsewhere. Raises
    RunFileRefused where one of the rows found is no life.
    """
    total = file.rows("junctions")
    found = [np.zeros(0, dtype=np.int64)]
    for first in range(0, total, PANEL_ROWS):
        last = min(first + PANEL_ROWS, total)
        birth = file.column("junctions", "birth_distance", first, last)
        death = file.column("junctions", "death_distance", first, last)
        found.append(np.flatnonzero((birth <= stop) & (death >= start)) + first)
    rows = np.concatenate(found)
    return _read(file, rows[rows != number])


def check_lives(rows: NDArray[np.int64], columns: Mapping[str, Doubles]) -> None:
    """Raise RunFileRefused, naming the first row, where a number is not finite or a diameter not positive."""
    for name, values in columns.items():
        wrong = ~np.isfinite(values) | ((values <= 0.0) & (name == "diameter"))
        if wrong.any():
            first = int(np.argmax(wrong))
            raise RunFileRefused(f"/junctions is damaged: row {rows[first]} has the {name} {values[first]:g}")


def _read(file: Reader, rows: NDArray[np.int64]) -> Neighbours:
    names = ["birth_distance", "death_distance", "diameter"]
    names += ["shear_strength"] if "shear_strength" in file.columns["junctions"] else []
    panels = list(gather(file, rows, names))
    columns = {name: np.concatenate([np.zeros(0), *(panel[name] for panel in panels)]) for name in names}
    check_lives(rows, columns)
    return Neighbours(
        rows=rows,
        birth=columns["birth_distance"],
        death=columns["death_distance"],
        diameter=columns["diameter"],
        strength=columns.get("shear_strength"),
        pulse=stored_pulse(file.provenance["scenario_resolved"]),
    )
