"""Names of columns with their units, as laboratories write them: `Force (N)`, `Force [N]`, `Force/N`, `force_N`."""

import re
from dataclasses import dataclass
from typing import Final

from rubnoise.errors import Refused
from rubnoise.units import USUAL_UNITS, QuantityError, parse_unit

ELECTRIC: Final = ("V", "A", "W", "Hz", "Ohm", "\u03a9", "\u2126")
OTHERS: Final = frozenset(
    [prefix + unit for unit in ELECTRIC for prefix in ("", "u", "\u00b5", "\u03bc", "m", "k", "M")]
    + ["K", "C", "\u00b0C", "degC", "rpm", "1/min", "dB", "rad", "deg", "\u00b0", "%"]
)
"""Units of columns beside the friction: known, and kept as they are."""

NONE: Final = frozenset(["", "1", "-"])
"""What stands in place of a unit if a column has none."""

LONGEST_NAME: Final = 200
"""Characters of a name with a unit at most: the forms below take the square of them."""

_BRACKETS: Final = re.compile(
    r"(?P<name>[^()\[\]]*[^\W\d][^()\[\]]*?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\[\]]*)\])"
)
_SLASH: Final = re.compile(r"(?P<name>[^/]*[^\W\d][^/]*?)\s*/\s*(?P<unit>\S.*)")
_IN: Final = re.compile(r"(?P<name>.*[^\W\d].*?)\s+in\s+(?P<unit>\S.*)")
_ENDING: Final = re.compile(r"(?P<name>.*?[^\W\d_].*?)_(?P<unit>[A-Za-z\u00b5\u03bc]+2?(?:_per_[A-Za-z]+)?)")


@dataclass(frozen=True, slots=True)
class Head:
    """The name of a column and its unit, which is empty if it has none; ``written`` is the cell itself."""

    name: str
    unit: str
    written: str


def head_of(cell: str) -> Head:
    """Return name and unit of a column. A text in brackets is its unit; after `/`, `in` and `_` a known unit is."""
    text = cell.strip()
    if len(text) > LONGEST_NAME:
        return Head(text, "", text)
    if found := _BRACKETS.fullmatch(text):
        unit = (found["round"] if found["round"] is not None else found["square"]).strip()
        return Head(found["name"].strip(), spelled(unit), text)
    for form in (_SLASH, _IN, _ENDING):
        if found := form.fullmatch(text):
            unit = (
                re.sub("(?<=[a-z])2$", "^2", found["unit"].replace("_per_", "/")) if form is _ENDING else found["unit"]
            )
            if spelled(unit) in USUAL_UNITS or (form is not _ENDING and is_unit(unit)) or unit in ("V", "mV"):
                return Head(found["name"].strip(), spelled(unit), text)
    return Head(text, "", text)


_SPELLINGS: Final = {"kp": "kgf", "msec": "ms", "usec": "us", "sek": "s", "sek.": "s"}
_POWERS: Final = str.maketrans({"\u00b2": "^2", "\u00b3": "^3", "\u00b7": "*", "\u22c5": "*"})


def spelled(unit: str) -> str:
    """Return a unit as the table of units spells it: newton for Newton, um^2 for um2, an empty text for `-`."""
    text = unit.strip().translate(_POWERS)
    if text in NONE:
        return ""
    lower = text.lower() if text[1:].islower() and len(text) > 2 else ""
    powered = re.sub(r"(?<=[A-Za-z\u00b5\u03bc])([23])(?=$|/)", r"^\1", text)
    ways = (text, _SPELLINGS.get(text.lower(), ""), lower, powered)
    return next((way for way in ways if _is_known(way)), text)


def is_unit(text: str) -> bool:
    """Whether a text is a known unit."""
    return _is_known(spelled(text))


def check_unit(unit: str, what: str) -> None:
    """Raise Refused, which names the unit, if it is unknown."""
    if unit in NONE or unit in OTHERS:
        return
    try:
        parse_unit(unit)
    except QuantityError as problem:
        raise Refused(f"{what}: {problem}{f' ({problem.hint})' if problem.hint else ''}") from None


def _is_known(unit: str) -> bool:
    try:
        check_unit(unit, "")
    except Refused:
        return False
    return unit not in NONE
