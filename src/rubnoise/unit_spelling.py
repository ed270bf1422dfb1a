"""How files and people spell units: newton for Newton, um^2 for um2; one way for text, HDF5 and the shell."""

import re
from typing import Final

from rubnoise.errors import Refused
from rubnoise.units import QuantityError, parse_unit, unit_or_one

NONE: Final = frozenset(["", "1", "-"])
"""What stands in place of a unit if a column has none."""

OTHERS: Final = frozenset(
    [prefix + unit for unit in ("V", "A", "W", "Hz", "Ohm", "\u03a9", "\u2126") for prefix in ("", *"u\u00b5\u03bcmkM")]
    + ["K", "C", "\u00b0C", "degC", "rpm", "1/min", "dB", "rad", "deg", "\u00b0", "%"]
)
"""Units of columns beside the friction: known, and kept as they are."""

_POWERS: Final = str.maketrans({"\u00b2": "^2", "\u00b3": "^3", "\u00b7": "*", "\u22c5": "*"})
_SPELLINGS: Final = {
    "kp": "kgf",
    "msec": "ms",
    "usec": "us",
    "d": "day",
    "days": "day",
    "hours": "hour",
    "minutes": "minute",
    **dict.fromkeys(("sek", "sek.", "sekunde", "sekunden"), "s"),
}


def spelled(unit: str) -> str:
    """Return a unit as the table of units spells it: newton for Newton, um^2 for um2, an empty text for `-`."""
    text = unit.strip().translate(_POWERS).replace("_per_", "/")
    lower = text.lower() if text[1:].islower() and len(text) > 2 else ""
    powered = re.sub(r"(?<=[A-Za-z\u00b5\u03bc])([23])(?=$|/)", r"^\1", text)
    known = (way for way in (text, _SPELLINGS.get(text.lower(), ""), lower, powered) if is_unit(way))
    return next(known, "" if text in NONE else text)


def is_unit(text: str) -> bool:
    """Whether a text is a known unit, as `spelled` returns it."""
    return text in OTHERS or len(unit_or_one(text).dimension) > 0


def check_unit(unit: str, what: str) -> None:
    """Raise Refused, which names the unit, if it is unknown."""
    try:
        if unit not in NONE | OTHERS:
            parse_unit(unit)
    except QuantityError as problem:
        raise Refused(f"{what}: {problem}{f' ({problem.hint})' if problem.hint else ''}") from None
