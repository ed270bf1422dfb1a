"""The rows of junctions as a run holds them and as /junctions has them, and what one block passes to the next."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import half_life, max_area, peak_areas
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState

Watch = Callable[[float, int, int], None]
"""Called after each tick range: distance reached (um), junctions born, live count. It may raise to stop the run."""

_NOTHING = np.empty(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveRows:
    """Junctions whose death lies beyond the last finished tick, in order of birth.

    junction: row numbers; birth, diameter, departure (um); strength (MPa). departure: where a life was ended early;
    infinite if it was not. offset: distance of each pass from the centre line (um), with a sign; None if all pass
    through both centres.
    """

    junction: NDArray[np.int64]
    birth: Doubles
    diameter: Doubles
    strength: Doubles
    departure: Doubles
    offset: Doubles | None = None

    @classmethod
    def none(cls) -> "LiveRows":
        """Return no rows."""
        empty = np.empty(0)
        return cls(junction=np.empty(0, np.int64), birth=empty, diameter=empty, strength=empty, departure=empty)

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.birth.size

    @property
    def half_life(self) -> Doubles:
        """Half of each whole life, in um: the distance from birth to mid-life."""
        return half_life(self.diameter, self.offset)

    @property
    def natural_death(self) -> Doubles:
        """Where each life ends if it is not ended early, in um."""
        return self.birth + 2.0 * self.half_life

    @property
    def death(self) -> Doubles:
        """Where each life ends, in um: its departure if it was ended early, else its natural death."""
        return np.minimum(self.departure, self.natural_death)

    def at(self, rows: NDArray[np.int64] | slice) -> "LiveRows":
        """Return the rows with these indices, or those of a slice without a copy."""
        return LiveRows(**{name: values[rows] for name, values in self.columns()})

    def then(self, other: "LiveRows") -> "LiveRows":
        """Return these rows followed by others that were born later; either all rows have offsets or none."""
        mine, others = dict(self.columns()), dict(other.columns())
        names = mine | others  # no rows have no offsets either
        return LiveRows(
            **{name: np.concatenate([mine.get(name, _NOTHING), others.get(name, _NOTHING)]) for name in names}
        )

    def columns(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Yield name and values of every column that is not None."""
        for f in fields(self):
            values = getattr(self, f.name)
            if values is not None:
                yield f.name, values


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """The state of a run between two blocks; at first no rows and no ticks are finished.

    block: the next block; next_birth (um): its first birth, where the block before it ended; junctions: rows born so
    far; ticks: ticks finished so far; live: the rows that are carried.
    """

    block: int = 0
    next_birth: float = 0.0
    junctions: int = 0
    ticks: int = 0
    live: LiveRows = field(default_factory=LiveRows.none)


def junction_columns(model: Model, rows: LiveRows) -> dict[str, NDArray[Any]]:
    """Return the columns of /junctions for rows in order of birth (um, um^2, MPa, s).

    A row that was ended early has its real death and life; every other row has death = birth + 2d, also beyond the run.
    """
    natural, death = rows.natural_death, rows.death
    early = death < natural
    columns: dict[str, NDArray[Any]] = {
        "junction": rows.junction,
        "birth_distance": rows.birth,
        "death_distance": death,
        "life_distance": np.where(early, death - rows.birth, 2.0 * rows.half_life),
        "diameter": rows.diameter,
    }
    if rows.offset is None:
        columns["max_area"] = max_area(rows.diameter)
    else:
        columns["lateral_offset"] = rows.offset
        columns["max_area"] = peak_areas(model.pulse.shape, rows.diameter, rows.offset)
    if model.strengths is not None:
        columns["shear_strength"] = rows.strength
    if model.sliding_speed is not None:
        columns["birth_time"] = rows.birth / model.sliding_speed
        columns["death_time"] = death / model.sliding_speed
    # Only junctions alive at the start have a birth with a minus sign, even if it is -0.0.
    at_start, at_end = np.signbit(rows.birth), death > model.distance
    state = at_start * JunctionState.ALIVE_AT_START.value | at_end * JunctionState.ALIVE_AT_END.value
    columns["state"] = (state | early * JunctionState.ENDED_EARLY.value).astype(np.uint8)
    return columns
