"""The laws of a two-way run from its rows alone: path, sticks, work of friction and reversals, energy, mean force."""

from math import sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.findings import identity
from rubnoise.analysis.junctions import checked_chunks
from rubnoise.analysis.motion import Balance
from rubnoise.answer import Row, left_out
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.rows import LandmarkKind, Rows


class FrictionIntegral:
    """Sums P(s) = int_0^s G ds in uN um at places s >= 0 in um, G = sum psi A, from chunks of /junctions."""

    def __init__(self, pulse: Pulse, places: Doubles) -> None:
        """Start without rows; ``places`` may be in any order and may repeat."""
        self._pulse = pulse
        self._places, self._order = np.unique(places, return_inverse=True)
        self._found = np.zeros(self._places.size)
        self.largest = 0.0

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add rows of /junctions, whose lives are 2d long."""
        birth, diameter = columns["birth_distance"], columns["diameter"]
        weight = columns["shear_strength"] * diameter**3
        before = self._so_far(np.maximum(-birth, 0.0) / diameter)
        first = np.searchsorted(self._places, birth, side="right")
        last = np.searchsorted(self._places, birth + 2.0 * diameter, side="left")
        # Places inside a life, one pair of row and place each.
        count = np.maximum(last - first, 0)
        row = np.repeat(np.arange(birth.size), count)
        place = np.arange(row.size) - np.repeat(np.cumsum(count) - count, count) + first[row]
        part = self._so_far((self._places[place] - birth[row]) / diameter[row]) - before[row]
        self._found += np.bincount(place, weight[row] * part, self._places.size)
        whole = weight * (self._pulse.life_integral(1) - before)
        self._found += np.cumsum(np.bincount(last, whole, self._places.size + 1))[:-1]
        self.largest = max(self.largest, float(diameter.max(initial=0.0)))

    def at_places(self) -> Doubles:
        """Return P at the places, in the order in which they were given."""
        found: Doubles = self._found[self._order]
        return found

    def _so_far(self, half_lives: Doubles) -> Doubles:
        """Return the integral of the area over d^2 up to an age over d, over d."""
        rising = area_so_far(self._pulse, np.clip(np.minimum(half_lives, 2.0 - half_lives), 0.0, 1.0))
        return np.where(half_lives <= 1.0, rising, self._pulse.life_integral(1) - rising)


def area_so_far(pulse: Pulse, u: Doubles) -> Doubles:
    """Return the integral of the area over d^2 up to u = s/d <= 1; of a lens (y - x acos x - y^3/3)/2, x = 1 - u."""
    x = 1.0 - u
    y = np.sqrt((1.0 - x) * (1.0 + x))
    lens = 0.5 * (y - x * np.arccos(x) - y**3 / 3.0)
    forms = {"lens": lens, "triangle": 0.125 * np.pi * u * u, "parabola": 0.25 * np.pi * u * u * (1.0 - u / 3.0)}
    return np.asarray(forms[pulse.shape], dtype=np.float64)


FIELD: Final = 1e-9
"""Relative: of a cell that a slider turns in, only a part counts, over which the force is a cubic."""

_ROUNDING: Final = 2.0**-49
_STEPS: Final = 100.0  # in a diameter, about


class Path:
    """The path of a two-way run from its rows: turns and sticks, and int G ds between them."""

    def __init__(self, model: Model, rows: Rows) -> None:
        """Read /balance and /landmarks; raises RunFileRefused for rows that no motion can have."""
        row = {name: rows.column("balance", name) for name in rows.columns["balance"]}
        if any(each.size != 1 or not np.isfinite(each).all() for each in row.values()) or row["time"][0] <= 0.0:
            raise RunFileRefused("/balance is damaged: it has one row of finite numbers, and a time above 0")
        self.balance = Balance.of(model, {name: float(each[0]) for name, each in row.items()})
        self.sticks, self.time_stuck = 0, 0.0
        turns = [self._count_sticks(columns) for columns in _landmark_pairs(rows)]
        self.turns: Doubles = np.concatenate([np.empty((2, 0)), *turns], axis=1)
        self._work = FrictionIntegral(model.pulse, np.maximum([self.balance.distance, *self.turns.ravel()], 0.0))

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        self._work.add(columns)

    @property
    def friction_along(self) -> float:
        """Signed int G ds in uN um from the start to the end."""
        return float(self._work.at_places()[0])

    @property
    def reverse_work(self) -> float | None:
        """Int G |ds| in uN um over reversals; None if one goes back behind the start, before the first rows."""
        if (self.turns < -_ROUNDING * self.balance.distance).any():
            return None
        begin, end = self._work.at_places()[1:].reshape(2, -1)
        return float((begin - end).sum())

    def _count_sticks(self, columns: dict[str, NDArray[Any]]) -> Doubles:
        """Count sticks among landmarks, each with the one after it, and return begins and ends of reversals in um."""
        kind, time, distance = columns["kind"][:-1], columns["time"], columns["distance"]
        stuck = np.diff(time)[kind == LandmarkKind.STICK]
        self.sticks += stuck.size
        self.time_stuck += float(stuck.sum())
        back = np.flatnonzero(kind == LandmarkKind.REVERSAL)
        return np.array([distance[back], distance[back + 1]])


def two_way_identities(model: Model, path: Path) -> list[Row]:
    """Return the identities of every correct two-way run, which hold up to rounding and the error of its steps.

    The travelled distance is V t - (x - x_0); sticks last as long as /landmarks says; friction does the work of the
    lives in /junctions over the path; energy is balanced, so the mean force is int G ds/(V T) plus its excess. The
    allowed deviation is 1e-9 of the largest work, plus the rounding of sums over some 100 steps a
    diameter.
    """
    seen = path.balance
    rounding = _ROUNDING * sqrt(max(_STEPS * model.distance / model.calibrated_diameter, 1.0))
    step = 1e-9 + rounding
    field = max(step, FIELD)
    travelled = seen.speed * seen.time - (seen.displacement - seen.start)
    away = max(abs(travelled - seen.distance), abs(model.distance - seen.distance))
    size = seen.speed * seen.time + abs(seen.displacement) + abs(seen.start)
    over = seen.speed * seen.time
    force = seen.excess_over(path.friction_along) - seen.expected_excess()
    found: list[Row] = [
        identity("sliding_distance", away, rounding * size, "um"),
        identity("time_stuck", abs(seen.time_stuck - path.time_stuck), _ROUNDING * (path.sticks + 1) * seen.time, "s"),
        _work("friction_work", seen.friction_along - path.friction_along, field * seen.scale),
        _work("energy", seen.energy_residual * seen.scale, step * seen.scale),
        identity("mean_force_law", abs(force), (step + field) * seen.scale / over, "uN"),
    ]
    if path.reverse_work is None:
        return [*found, left_out("reverse_work", "a reversal ends behind the start, where there are no rows")]
    return [*found, _work("reverse_work", seen.reverse_work - path.reverse_work, field * seen.scale)]


def _work(name: str, missing: float, allowed: float) -> Row:
    return identity(name, abs(missing), allowed, "uN um")


def _landmark_pairs(rows: Rows) -> Any:
    """Yield kind, time (s) and distance (um) of landmarks, chunk by chunk, each chunk with the first of the next."""
    before: dict[str, NDArray[Any]] | None = None
    for columns in checked_chunks(rows, "landmarks", ("kind", "time", "distance")):
        if before is not None:
            yield {name: np.concatenate([before[name], columns[name][:1]]) for name in columns}
        before = columns
    if before is not None:
        yield before
