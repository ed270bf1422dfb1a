"""Check the values of keywords; a refusal begins with the keyword's name in Python's form.

The command line says `--speed` where these messages say `speed=` (see errors.in_shell).
"""

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from numbers import Integral
from typing import Any, Final

from rubnoise import units
from rubnoise.errors import Refused
from rubnoise.storage.measured import Asked, Source

SMALLEST: Final = 1e-12
LARGEST: Final = 1e12
"""Of a quantity in working units: no force, speed or stress that was measured is beyond, and its powers are numbers."""

MOST_COLUMNS: Final = 100_000
_SHOWN: Final = 80
_SIZE: Final = re.compile(r"([+-]?[0-9]+(?:[.][0-9]*)?(?:[eE][+-]?[0-9]{1,3})?(?![0-9.eE,]))? *(.*)", re.DOTALL)
_VOLTS: Final = re.compile(r"[unmk\u00b5\u03bc]?V")
_WEIGHED: Final = {"mg": "9.80665 uN", "g": "9.80665 mN", "kg": "9.80665 N", "t": "9.80665 kN"}
"""The force with which a mass pulls, since many balances show one."""

_UNIT_FORMS: Final = 'unit="mN", unit="0.5 mN" where a value of 1 is 0.5 mN, unit="V" where the scale is unknown'


def shown(value: Any) -> str:
    """Return a value for a message: as it was written, and cut short."""
    plain = isinstance(value, str | units.Quantity | int | float) or hasattr(value, "dimensionality")
    text = str(value) if plain else repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def quantity(
    keyword: str, value: Any, kind: units.Kind, limits: tuple[float, float] = (SMALLEST, LARGEST)
) -> float | None:
    """Return a quantity within limits in working units, None if none is given; raises Refused for anything else."""
    if value is None:
        return None
    form = f'{keyword}="{kind.example}"'
    try:
        number = float(units.quantity_of(value, kind))
    except units.QuantityError as problem:
        raise _refusal(f"{keyword}=", value, problem, form) from problem
    if number <= 0.0 < limits[0]:
        raise Refused(f"{keyword}=: {shown(value)} is not above 0; right form: {form}")
    if not limits[0] <= number <= limits[1]:
        least, most = map(kind.number, limits)
        raise Refused(f"{keyword}=: {shown(value)} is not between {least} and {most}")
    return number


def needed(keyword: str, value: Any, kind: units.Kind) -> float:
    """Return a positive quantity in working units; raises Refused for anything else, and if none is given."""
    number = quantity(keyword, value, kind)
    if number is None:
        raise Refused(f'{keyword}= is needed; right form: {keyword}="{kind.example}"')
    return number


def _refusal(what: str, value: Any, problem: units.QuantityError, form: str, more: str = "") -> Refused:
    """Return the refusal of a value that is no quantity, with advice and the right form."""
    hint = f"; {problem.hint}" if problem.hint and not problem.hint.startswith("right form") else ""
    return Refused(f"{what}: {shown(value)}: {problem}{hint}{more}; right form: {form}")


def frequencies(keyword: str, values: Any) -> list[float]:
    """Return frequencies in Hz from one value, from several separated by commas, or from a sequence."""
    parts = values if isinstance(values, list | tuple) else (values,)
    texts = [each for part in parts for each in (part.split(",") if isinstance(part, str) else (part,))]
    return [number for each in texts if (number := quantity(keyword, each, units.FREQUENCY)) is not None]


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


def asked(*, rate: Any = None, from_: Any = None, to: Any = None, **columns: Any) -> Asked:
    """Return what was said of a measured trace; ``columns`` are names, or numbers from 1 on."""
    if columns.get("place") is not None and columns.get("time") is not None:
        raise Refused("place=: time= names a column, too; samples have one place")
    named = {
        key: value if value is None or isinstance(value, str) else str(count(key, value, MOST_COLUMNS))
        for key, value in columns.items()
    }
    often, ends = quantity("rate", rate, units.FREQUENCY), (_end("from_", from_), _end("to", to))
    return Asked(**named, rate=often, begin=ends[0], end=ends[1])


def _end(keyword: str, value: Any) -> int | units.Quantity | None:
    """Return the number of a sample, from 1 on, or a time or distance from the first one."""
    is_number = isinstance(value, Integral) and not isinstance(value, bool)
    if value is None or is_number or (isinstance(value, str) and re.fullmatch("[0-9]{1,15}", value.strip())):
        return None if value is None else int(value)
    try:
        return units.quantity_of(value, units.TIME, units.LENGTH)
    except units.QuantityError as problem:
        form = f'{keyword}="7201" for a sample, {keyword}="{units.TIME.example}"'
        raise _refusal(f"{keyword}=", value, problem, form) from problem


def unit_text(unit: Any) -> Any:
    """Return a quantity or a unit of pint as a text, anything else as it is."""
    return f"{unit.magnitude} {units.unit_name(unit.units)}" if units.is_of_pint(unit) else units.unit_name(unit)


def scale_of(unit: Any, what: str) -> tuple[float | None, bool, float]:
    """Return the size in uN (or um^2) of a value of 1, whether it is an area, and its sign; None for a voltage.

    ``unit`` is a unit, or the size of a value of 1, which may be negative; ``what`` names it in a refusal.
    """
    text = unit_text(unit)
    number, name = "1", ""
    if isinstance(text, str):
        number, name = _SIZE.fullmatch(text.strip()).groups()  # type: ignore[union-attr]  # fits any text
        number, name = number or "1", units.spelled(name)
    volts = _VOLTS.fullmatch(name)
    size = f"{number} {'N' if volts else name}" if isinstance(text, str) else text
    try:
        factor = units.quantity_of(size, units.FORCE, units.AREA)
    except units.QuantityError as problem:
        weighed = _WEIGHED.get(name, "")
        pulls = f'; what weighs 1 {name} pulls with {weighed}: unit="{weighed}"' if weighed else ""
        raise _refusal(what, unit, problem, _UNIT_FORMS, pulls) from problem
    if not SMALLEST <= abs(factor) <= LARGEST:
        limits = f"is not between {SMALLEST:g} and {LARGEST:g} uN"
        raise Refused(f"{what}: {shown(unit)} {limits}; right form: {_UNIT_FORMS}")
    sign = -1.0 if factor < 0.0 else 1.0
    return (None, False, sign) if volts else (abs(float(factor)), factor.kind is units.AREA, sign)


def check_own_unit(found: Source, unit: Any) -> None:
    """Raise Refused for a unit beside values from Python that have another one; that of a file is replaced."""
    own = "" if found.of_file else found.head.unit
    what = ": ".join(each for each in (found.where, found.head.name) if each)
    if any(units.unit_or_one(own).dimension) and scale_of(own, f"{what}: unit") != scale_of(unit, "unit="):
        raise Refused(f"unit=: {shown(unit)}: {what} is in {own} by its own words; leave unit= out")


_MEANT: Final = {
    'rate="2500 Hz"': "fs dt sampling_rate sample_rate samplerate freq frequency delta period step",
    'unit="0.5 mN"': "units scale factor",
    'column="force"': "col columns usecols y channel",
    'from_="2 s"': "start begin skip skiprows first",
    'to="30 s"': "stop end last nrows",
    'size="84 mm x 60 mm"': "figsize sizes",
}
"""Keywords of other libraries, by what they mean here."""


def refuse_unknown(unknown: Mapping[str, Any], known: Sequence[str]) -> None:
    """Raise Refused for a keyword that does not exist, with the right one."""
    for name, value in unknown.items():
        forms = [form for form, words in _MEANT.items() if name.lower() in words.split()]
        forms += [f"{each}=..." for each in get_close_matches(name, known, 1)]
        right = next((form for form in forms if form.partition("=")[0] in known), "")
        said = f"right form: {right}" if right else f"there are {', '.join(known)}"
        raise Refused(f"{name}=: {shown(value)}: is no keyword here; {said}")
