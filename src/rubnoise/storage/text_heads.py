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

_NAME: Final = r"(?P<name>[^()\[\]]*[^\W\d][^()\[\]]*?)\s*"
_BRACKETS: Final = (re.compile(_NAME + r"\((?P<unit>[^()]*)\)"), re.compile(_NAME + r"\[(?P<unit>[^\[\]]*)\]"))
_SLASH: Final = re.compile(r"(?P<name>[^/]*[^\W\d][^/]*?)\s*/\s*(?P<unit>\S.*)")
_IN: Final = re.compile(r"(?P<name>.*[^\W\d].*?)(?:\s+in|,)\s+(?P<unit>\S.*)")
_ENDING: Final = re.compile(r"(?P<name>.*?[^\W\d_].*?)_(?P<unit>[A-Za-z\u00b5\u03bc]+2?(?:_per_[A-Za-z]+)?)")
_POWERS: Final = str.maketrans({"\u00b2": "^2", "\u00b3": "^3", "\u00b7": "*", "\u22c5": "*"})
_SPELLINGS: Final = {"kp": "kgf", "msec": "ms", "usec": "us", "d": "day", "days": "day", "hours": "hour"} | {
    **dict.fromkeys(("sek", "sek.", "sekunde", "sekunden"), "s"),
    "minutes": "minute",
}


@dataclass(frozen=True, slots=True)
class Head:
    """The name of a column and its unit, empty if it has none, and the cell as ``written``.

    Its cells are of a ``kind``, "number" or "time", empty for others; ``missing`` says what nan stands for.
    """

    name: str
    unit: str
    written: str
    kind: str = "number"
    missing: str = ""


def head_of(cell: str) -> Head:
    """Return name and unit of a column. A text in brackets is its unit; after `/`, `in`, comma and `_` a known one."""
    text = cell.strip()
    for form in (*_BRACKETS, _SLASH, _IN, _ENDING) if len(text) <= LONGEST_NAME else ():
        if found := form.fullmatch(text):
            unit = found["unit"].strip()
            if form is _ENDING:
                unit = re.sub("(?<=[a-z])2$", "^2", unit.replace("_per_", "/"))
            known = spelled(unit) in USUAL_UNITS or unit in ("V", "mV") or (form is not _ENDING and is_unit(unit))
            if known or form in _BRACKETS:
                return Head(found["name"].strip(), spelled(unit), text)
    return Head(text, "", text)


def spelled(unit: str) -> str:
    """Return a unit as the table of units spells it: newton for Newton, um^2 for um2, an empty text for `-`."""
    text = unit.strip().translate(_POWERS)
    if text in NONE:
        return ""
    lower = text.lower() if text[1:].islower() and len(text) > 2 else ""
    powered = re.sub(r"(?<=[A-Za-z\u00b5\u03bc])([23])(?=$|/)", r"^\1", text)
    return next((way for way in (text, _SPELLINGS.get(text.lower(), ""), lower, powered) if _is_known(way)), text)


def is_unit(text: str) -> bool:
    """Whether a text is a known unit, in any spelling."""
    return _is_known(spelled(text))


def check_unit(unit: str, what: str) -> None:
    """Raise Refused, which names the unit, if it is unknown."""
    try:
        if unit not in NONE | OTHERS:
            parse_unit(unit)
    except QuantityError as problem:
        raise Refused(f"{what}: {problem}{f' ({problem.hint})' if problem.hint else ''}") from None


def _is_known(unit: str) -> bool:
    try:
        check_unit(unit, "")
    except Refused:
        return False
    return unit not in NONE
