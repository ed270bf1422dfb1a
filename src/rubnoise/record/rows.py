"""The codes in whole numbers of all groups."""

from collections.abc import Container
from enum import IntEnum, IntFlag

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
