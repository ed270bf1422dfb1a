"""The columns of /junctions, one row for each junction, and the codes in whole numbers of all groups."""

from collections.abc import Container
from enum import IntEnum, IntFlag
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.off_centre import half_life
from rubnoise.contact.overlap import max_area
from rubnoise.errors import Refused


class JunctionState(IntFlag):
    """The bits of the ``state`` of a junction's row.

    >>> import rubnoise
    >>> rubnoise.JunctionState(3) == rubnoise.JunctionState.ALIVE_AT_START | rubnoise.JunctionState.ALIVE_AT_END
    True
    """

    COMPLETE = 0
    ALIVE_AT_START = 1
    ALIVE_AT_END = 2
    ENDED_EARLY = 4


class Phase(IntEnum):
    """The ``phase`` in a row of a two-way slider: how it moves over the surface."""

    SLIP = 0
    STICK = 1
    REVERSAL = 2


class LandmarkKind(IntEnum):
    """The ``kind`` of a landmark: what a two-way slider begins there. A slip begins with the breakaway from a stick."""

    STICK = 0
    SLIP = 1
    REVERSAL = 2
    FORWARD = 3


class ContactKind(IntEnum):
    """The ``kind`` of a landmark of a slider that may leave its contact."""

    CONTACT_LOST = 4
    CONTACT_MADE = 5


def refuse_touches(names: Container[str]) -> None:
    """Raise Refused if rows are touches, since their areas follow the separation and not the curve of a row."""
    if "encounter" in names:
        raise Refused("rows of free motion are touches, whose areas follow the separation; no row says its curve")


def natural_death(birth: Doubles, diameter: Doubles, offset: Doubles | None = None) -> Doubles:
    """Return the distance in um at which a life of 2d ends (paper Eq. 5), or one of 2 sqrt(d^2 - b^2)."""
    return birth + 2.0 * half_life(diameter, offset)


def junction_states(
    natural: Doubles, departure: Doubles, at_start: NDArray[np.bool_], distance: float
) -> NDArray[np.uint8]:
    """Return the state bits of junctions from their natural deaths and departures (um).

    A departure is infinite for a junction that is not known to have left.
    """
    bits = (
        (JunctionState.ALIVE_AT_START, at_start),
        (JunctionState.ALIVE_AT_END, np.minimum(departure, natural) > distance),
        (JunctionState.ENDED_EARLY, departure < natural),
    )
    state = np.zeros(natural.size, dtype=np.uint8)
    for bit, of_whom in bits:
        if of_whom.any():
            state |= of_whom.view(np.uint8) * np.uint8(bit)
    return state


def junction_columns(
    *,
    first_row: int,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles | None,
    natural: Doubles,
    departure: Doubles,
    state: NDArray[np.uint8],
    speed: float | None,
    offset: Doubles | None = None,
    peak: Doubles | None = None,
) -> dict[str, NDArray[Any]]:
    """Return the columns of /junctions for rows in order of birth (um, um^2, MPa, s), with their natural deaths given.

    A row that was ended early has its real death and life; every other row has death = birth + 2d, also beyond the run.
    offset and peak (um, um^2): lateral offset and area at mid-life of passes off the centre line.
    """
    early = departure < natural
    death, life = natural, 2.0 * half_life(diameter, offset)
    if early.any():
        death = np.where(early, departure, natural)
        life = np.where(early, death - birth, life)
    columns: dict[str, NDArray[Any]] = {
        "junction": np.arange(first_row, first_row + birth.size, dtype=np.int64),
        "birth_distance": birth,
        "death_distance": death,
        "life_distance": life,
        "diameter": diameter,
    }
    if offset is not None:
        columns["lateral_offset"] = offset
    columns["max_area"] = max_area(diameter) if peak is None else peak
    if strength is not None:
        columns["shear_strength"] = strength
    if speed is not None:
        columns["birth_time"] = birth / speed
        columns["death_time"] = death / speed
    columns["state"] = state
    return columns
