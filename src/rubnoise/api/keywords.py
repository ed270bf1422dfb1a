"""Check the values of keywords; a refusal begins with the keyword's name in Python's form.

The command line says `--speed` where these messages say `speed=` (see errors.in_shell).
"""

import re
from collections.abc import Sequence
from numbers import Integral
from typing import Any, Final

from rubnoise.errors import Refused
from rubnoise.units import AREA, FORCE, FREQUENCY, Kind, Quantity, QuantityError, is_of_pint, quantity_of, unit_name

SMALLEST: Final = 1e-12
LARGEST: Final = 1e12
"""Of a quantity in working units: no force, speed or stress that was measured is beyond, and its powers are numbers."""

_SHOWN: Final = 80
_NUMBER: Final = re.compile(r"[+-]?(?:[.0-9]|(?:nan|inf|infinity)\b)", re.IGNORECASE)
_VOLTS: Final = re.compile(r"(.*?) *[unmk\u00b5\u03bc]?V")
_UNIT_FORMS: Final = 'unit="mN", unit="0.5 mN" where a value of 1 is 0.5 mN, unit="V" where the scale is unknown'


def shown(value: Any) -> str:
    """Return a value for a message: as it was written, and cut short."""
    plain = isinstance(value, str | Quantity | int | float) or hasattr(value, "dimensionality")
    text = str(value) if plain else repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def quantity(keyword: str, value: Any, kind: Kind) -> float | None:
    """Return a positive quantity in working units, None if none is given; raises Refused for anything else."""
    if value is None:
        return None
    form = f'right form: {keyword}="{kind.example}"'
    try:
        number = float(quantity_of(value, kind))
    except QuantityError as problem:
        hint = "" if problem.hint.startswith("right form") else f"; {problem.hint}" if problem.hint else ""
        raise Refused(f"{keyword}=: {shown(value)}: {problem}{hint}; {form}") from problem
    if not number > 0.0:
        raise Refused(f"{keyword}=: {shown(value)} is not above 0; {form}")
    if not SMALLEST <= number <= LARGEST:
        raise Refused(f"{keyword}=: {shown(value)} is not between {kind.number(SMALLEST)} and {kind.number(LARGEST)}")
    return number


def frequencies(keyword: str, values: Any) -> list[float]:
    """Return frequencies in Hz from one value, from several separated by commas, or from a sequence."""
    parts = values if isinstance(values, list | tuple) else (values,)
    texts = [each for part in parts for each in (part.split(",") if isinstance(part, str) else (part,))]
    return [number for each in texts if (number := quantity(keyword, each, FREQUENCY)) is not None]


def choice(keyword: str, value: Any, known: Sequence[Any]) -> Any:
    """Return one of the allowed values; raises Refused for another."""
    if any(value is each or (isinstance(value, str) and value == each) for each in known):
        return value
    named = [f'"{each}"' if isinstance(each, str) else str(each) for each in known]
    way = f"neither {' nor '.join(named)}" if len(named) == 2 else f"none of {', '.join(named)}"
    raise Refused(f"{keyword}=: {shown(value)} is {way}")


def count(keyword: str, value: Any, most: int) -> int:
    """Return a whole number from 0 on; raises Refused for another."""
    if isinstance(value, bool) or not isinstance(value, Integral) or not 0 <= int(value) <= most:
        raise Refused(f"{keyword}=: {shown(value)} is no whole number from 0 to {most:,}")
    return int(value)


def unit_text(unit: Any) -> Any:
    """Return a quantity or a unit of pint as a text, anything else as it is."""
    return f"{unit.magnitude} {unit_name(unit.units)}" if is_of_pint(unit) else unit_name(unit)


def scale_of(unit: Any, what: str) -> tuple[float | None, bool]:
    """Return the size in uN (or um^2) of a value of 1, and whether it is an area; None for a voltage.

    ``unit`` is a unit, or the size of a value of 1; ``what`` names it in a refusal.
    """
    text = unit_text(unit)
    if isinstance(text, str):
        text = text.strip() if _NUMBER.match(text.strip()) else f"1 {text.strip()}"
    volts = _VOLTS.fullmatch(text) if isinstance(text, str) else None
    try:
        factor = quantity_of(f"{volts[1]} N" if volts else text, FORCE, AREA)
    except QuantityError as problem:
        hint = f"; {problem.hint}" if problem.hint and not problem.hint.startswith("right form") else ""
        raise Refused(f"{what}: {shown(unit)}: {problem}{hint}; right form: {_UNIT_FORMS}") from problem
    if not SMALLEST <= factor <= LARGEST:
        raise Refused(
            f"{what}: {shown(unit)} is not between {SMALLEST:g} and {LARGEST:g} uN; right form: {_UNIT_FORMS}"
        )
    return (None, False) if volts else (float(factor), factor.kind is AREA)
