"""The row of /balance computed again: from lives, landmarks and laws, and from rows of /slider within a bound.

Between two rows h apart the displacement is a cubic but for what the acceleration a does there: of int x dt the
trapezoidal rule misses A h^3/12 at most, |a| <= A, and of int x^2 dt (2 max x'^2 + 2 A max |x|) h^3/12.
"""

from typing import Final

import numpy as np

from rubnoise.analysis.balance import Balance
from rubnoise.analysis.comparing.findings import Identity
from rubnoise.analysis.comparing.motion import Path, two_way_identities
from rubnoise.analysis.reading import checked_chunks, chunks
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.arrays import Doubles
from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import Rows

BETWEEN: Final = 2.0
"""Times the largest force and velocity in the rows: what they may come to between two of them."""

NAMES: Final = ("birth_distance", "diameter", "shear_strength")

PLACES: Final = {
    "sliding_distance": "distance",
    "energy": "velocity_squared_integral",
    "mean_force_law": "displacement_integral",
}
"""The column that an identity speaks of, where it bears another name."""


def balance_check(model: Model, rows: Rows) -> Check:
    """Return whether the integrals of a two-way run are those of its rows, and its laws hold for them."""
    notes = Notes("balance")
    try:
        path = Path(model, rows)
        for columns in checked_chunks(rows, "junctions", NAMES):
            path.add(columns)
        identities = [each for each in two_way_identities(model, path) if isinstance(each, Identity)]
    except RunFileRefused as refusal:
        notes.say("/balance", found=str(refusal), expected="one row of a motion")
        return notes.check()
    for each in identities:
        column = PLACES.get(each.name, each.name)
        off = f"off by {each.deviation:.3g} {each.units}"
        right = f"{each.name.replace('_', ' ')} within {each.allowed:.3g} {each.units}"
        notes.say(f"/balance/{column}", found=right if each.holds else off, expected=right)
    with np.errstate(over="ignore", invalid="ignore"):
        _by_rows(notes, path.balance, rows, model.tick / path.balance.speed)
    return notes.check()


def _by_rows(notes: Notes, seen: Balance, rows: Rows, step: float) -> None:
    """Compare integrals over time, and the end, with the rows of /slider, ``step`` s apart."""
    first = _Sums()
    for chunk in chunks(rows, "slider"):
        first.add(chunk["displacement"], chunk["velocity"], chunk["friction_force"], step)
    rest = seen.time - (rows.rows("slider") - 1) * step
    rounded = 4.0 * float(np.spacing(seen.time))
    inside = np.array([-rounded <= rest <= step + rounded])
    notes.holds("/balance/time", 0, np.array([seen.time]), inside, "in the tick after the last row")
    force = BETWEEN * first.force + seen.slider.stiffness * first.place + BETWEEN * seen.slider.damping * first.speed
    most = force / seen.slider.mass
    end = first.last_place + first.last_velocity * rest
    _near(notes, "displacement", seen.displacement, end, 0.5 * most * rest * rest)
    _near(notes, "velocity", seen.velocity, first.last_velocity, most * rest)
    first.add_end(seen.displacement, seen.velocity, rest)
    cubes = seen.time * step * step / 12.0
    largest = first.place + BETWEEN * first.speed * step
    _near(notes, "displacement_integral", seen.displacement_integral, first.place_time, most * cubes)
    fastest = BETWEEN * first.speed
    squares = 2.0 * fastest * fastest + 2.0 * most * largest
    _near(
        notes, "displacement_squared_integral", seen.displacement_squared_integral, first.square_time, squares * cubes
    )


def _near(notes: Notes, column: str, found: float, expected: float, allowed: float) -> None:
    # What a sum over many rows rounds.
    rounding = 1e-12 * abs(expected)
    notes.near(f"/balance/{column}", 0, np.array([found]), np.array([expected]), allowed + rounding)


class _Sums:
    """Integrals over time of x and x^2 from rows, and the largest moduli in them."""

    def __init__(self) -> None:
        self.place_time = self.square_time = 0.0
        self.force = self.place = self.speed = 0.0
        self.last_place = self.last_velocity = 0.0
        self._begun = False

    def add(self, place: Doubles, velocity: Doubles, force: Doubles, step: float) -> None:
        """Take in rows."""
        if not place.size:
            return
        self.force = max(self.force, float(np.abs(force).max()))
        self.place = max(self.place, float(np.abs(place).max()))
        self.speed = max(self.speed, float(np.abs(velocity).max()))
        if self._begun:
            place, velocity = np.append(self.last_place, place), np.append(self.last_velocity, velocity)
        self._begun = True
        self.place_time += _integral(place, velocity, step)
        self.square_time += _integral(place * place, 2.0 * place * velocity, step)
        self.last_place, self.last_velocity = float(place[-1]), float(velocity[-1])

    def add_end(self, place: float, velocity: float, rest: float) -> None:
        """Take in the end of a run, so much time (s) after the last row."""
        self.add(np.array([place]), np.array([velocity]), np.zeros(1), rest)


def _integral(value: Doubles, slope: Doubles, step: float) -> float:
    """Return the integral of the cubics through values with their slopes."""
    inner = value.sum() - 0.5 * (value[0] + value[-1])
    return float(step * inner + step * step / 12.0 * (slope[0] - slope[-1]))
