"""The rows of /junctions compared with what every life is: numbered, in order of birth, 2d long, of the scenario."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.reading import Chunk, chunks
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.arrays import Doubles
from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Fixed
from rubnoise.contact.off_centre import half_life, overlap
from rubnoise.contact.overlap import max_area
from rubnoise.model import Model
from rubnoise.record.reader import Rows

Mask = NDArray[np.bool_]

AT_START, AT_END, EARLY = 1, 2, 4
"""Bits of a row's state, as the file's format has them."""

_PEAK = 2.0**-48
"""By how much two ways to an area over d^2 may differ."""

_CLOCK = 2.0**-36
"""How far, of a distance, the clock of events may be off where an interrupt ends a life: it adds up gaps."""


def life_checks(model: Model, rows: Rows) -> list[Check]:
    """Return whether the rows of /junctions are what they say of each other and what the scenario says of them."""
    checks: dict[str, Callable[[Notes, Model, Chunk], None]] = {
        "ids": _check_ids,
        "births": _check_births,
        "lives": _check_lives,
        "diameters": _check_diameters,
        "states": _check_states,
    }
    if model.pulse.offset != "none":
        checks["offsets"] = _check_offsets
    if model.strengths is not None:
        checks["strengths"] = _check_strengths
    if model.sliding_speed is not None and not model.is_two_way:
        checks["times"] = _check_times
    notes = {name: Notes(name) for name in checks}
    order = _Order(notes["births"], model, rows)
    for chunk in chunks(rows, "junctions"):
        with np.errstate(invalid="ignore", over="ignore"):
            order.check(chunk)
            for name, check in checks.items():
                check(notes[name], model, chunk)
    return [each.check() for each in notes.values()]


def born_before(rows: Rows) -> int:
    """Return how many rows, of the first ones, were alive before the run: their births have a minus sign, -0.0 too."""
    for chunk in chunks(rows, "junctions"):
        signs = np.signbit(chunk["birth_distance"])
        if not signs.all():
            return chunk.first + int(np.argmin(signs))
    return rows.rows("junctions")


def ended_early(chunk: Chunk) -> Mask:
    """Return which rows say that an interrupt ended their life."""
    found: Mask = (chunk["state"] & EARLY) != 0
    return found


class _Order:
    """Births one after another, and at their places where these are regular."""

    def __init__(self, notes: Notes, model: Model, rows: Rows) -> None:
        self._notes = notes
        self._before = -np.inf
        self._start = born_before(rows)
        self._regular = model.births if isinstance(model.births, RegularBirths) else None
        first = rows.column("junctions", "birth_distance", self._start, self._start + 1)
        self._first = float(first[0]) if first.size else None

    def check(self, chunk: Chunk) -> None:
        birth = chunk["birth_distance"]
        right = birth >= np.concatenate([[self._before], birth[:-1]])
        self._notes.holds("/junctions/birth_distance", chunk.first, birth, right, "at or after the birth before it")
        self._before = float(birth[-1]) if birth.size else self._before
        if self._regular is not None and self._first is not None:
            number = np.arange(chunk.first, chunk.end) - self._start
            early = number < 0
            # Of those before the run only the survivors have rows, each a whole number of spacings away.
            away = np.nan_to_num((birth[early] - self._first) / self._regular.mean)
            number[early] = np.clip(np.rint(away), -(2.0**53), -1.0).astype(np.int64)
            places = self._regular.places(self._first, number)
            self._notes.equal("/junctions/birth_distance", chunk.first, birth, places)


def _check_ids(notes: Notes, _model: Model, chunk: Chunk) -> None:
    notes.equal("/junctions/junction", chunk.first, chunk["junction"], np.arange(chunk.first, chunk.end))


def _check_births(notes: Notes, model: Model, chunk: Chunk) -> None:
    birth = chunk["birth_distance"]
    there = np.isfinite(birth) & (birth <= model.distance)
    if model.start == "empty":
        there &= ~np.signbit(birth)
    else:
        there &= _natural_death(chunk) >= 0.0
    within = "within the run" if model.start == "empty" else "within the run, or so far before it that it is alive"
    notes.holds("/junctions/birth_distance", chunk.first, birth, there, within)


def _check_lives(notes: Notes, _model: Model, chunk: Chunk) -> None:
    """Compare deaths and lives with birth and diameter, bit for bit; a life ended early has the death that it had."""
    birth, death = (chunk[name] for name in ("birth_distance", "death_distance"))
    natural, early = _natural_death(chunk), ended_early(chunk)
    notes.equal("/junctions/death_distance", chunk.first, death, np.where(early, death, natural))
    within = ~early | ((death < natural) & (death >= birth - _CLOCK * np.abs(birth)))
    notes.holds("/junctions/death_distance", chunk.first, death, within, "between birth and the end of a whole life")
    life = np.where(early, death - birth, 2.0 * _half_life(chunk))
    notes.equal("/junctions/life_distance", chunk.first, chunk["life_distance"], life)


def _check_diameters(notes: Notes, model: Model, chunk: Chunk) -> None:
    diameter = chunk["diameter"]
    if isinstance(model.sizes, Fixed):
        notes.equal("/junctions/diameter", chunk.first, diameter, model.sizes.value)
    else:
        right = np.isfinite(diameter) & (diameter > 0.0)
        notes.holds("/junctions/diameter", chunk.first, diameter, right, "positive and finite")
    if model.pulse.offset != "none":
        return  # greatest areas depend on the offset, too
    notes.equal("/junctions/max_area", chunk.first, chunk["max_area"], max_area(diameter))


def _check_offsets(notes: Notes, _model: Model, chunk: Chunk) -> None:
    """Look whether the two circles meet at all, and compare the areas at which they are closest."""
    diameter, offset = chunk["diameter"], chunk["lateral_offset"]
    right = np.abs(offset) < diameter
    notes.holds("/junctions/lateral_offset", chunk.first, offset, right, "nearer to the line than the diameter")
    square = diameter * diameter
    peak = square * overlap(np.abs(offset) / diameter)
    notes.near("/junctions/max_area", chunk.first, chunk["max_area"], peak, _PEAK * square)


def _half_life(chunk: Chunk) -> Doubles:
    """Return how far each junction slides from birth to mid-life in um."""
    return half_life(chunk["diameter"], chunk.get("lateral_offset"))


def _natural_death(chunk: Chunk) -> Doubles:
    death: Doubles = chunk["birth_distance"] + 2.0 * _half_life(chunk)
    return death


def _check_strengths(notes: Notes, model: Model, chunk: Chunk) -> None:
    strength = chunk["shear_strength"]
    if isinstance(model.strengths, Fixed):
        notes.equal("/junctions/shear_strength", chunk.first, strength, model.strengths.mean)
    else:
        right = np.isfinite(strength) & (strength > 0.0)
        notes.holds("/junctions/shear_strength", chunk.first, strength, right, "positive and finite")


def _check_times(notes: Notes, model: Model, chunk: Chunk) -> None:
    for event in ("birth", "death"):
        time = chunk[f"{event}_distance"] / (model.sliding_speed or 1.0)
        notes.equal(f"/junctions/{event}_time", chunk.first, chunk[f"{event}_time"], time)


def _check_states(notes: Notes, model: Model, chunk: Chunk) -> None:
    birth, death, state = (chunk[name] for name in ("birth_distance", "death_distance", "state"))
    right = AT_START * np.signbit(birth) + AT_END * (death > model.distance)
    right = right + EARLY * (death < _natural_death(chunk))
    notes.equal("/junctions/state", chunk.first, state, right.astype(np.uint8))
