"""Quantities as text, `NUMBER UNIT`: the number is read here, the size of a unit is pint's; inside all is um, s, kg.

pint never sees the number: given the whole text it turns "1,5 mm" into 15 mm, drops a Unicode minus, evaluates
"5 mm + 3 mm" and hangs on powers of powers. Nor does it choose the units: to it a bit, a count and a radian are 1, so
that an area may hold one; pa is a picoyear, kt a knot, and Kim 1024 m. The usual ones stand in a table with their
sizes, so that reading an ordinary scenario does not pay the half second of loading pint; tests hold the table equal to
pint.
"""

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isfinite
from numbers import Real
from typing import Any, Self

_MANTISSA = r"[+-]?[0-9]+(?:\.[0-9]+)?"
NUMBER = rf"{_MANTISSA}(?:[eE][+-]?[0-9]{{1,3}})?"
MAX_UNIT_LENGTH = 40
# One small power per name: pint would multiply out a tower of powers until the memory is gone.
_NAME = r"[A-Za-z\u00b5\u03bc%][A-Za-z0-9\u00b5\u03bc%]*"
_FACTOR = rf"{_NAME}(?:(?:\^|\*\*)-?[0-9]{{1,2}}(?:\.[0-9]+)?)?"
_UNIT = re.compile(rf"(?:1 ?/ ?)?{_FACTOR}(?:(?: ?[*/] ?| +){_FACTOR})*")
_QUANTITY = re.compile(rf"((?>{NUMBER}))( *)([^ ].*)")
_FOREIGN = re.compile(r"[^A-Za-z0-9\u00b5\u03bc%*/^. \-]")
_MINUS_SIGNS = "\u2212\u2010\u2011\u2012\u2013\u2014\ufe63\uff0d"
_COMMA = re.compile(r"(?<=[0-9]),(?=[0-9])")
_BARE_POWER = re.compile(r"(?<=[A-Za-z\u00b5\u03bc])(-?[0-9])")

_SI = ("m", "g", "s", "N", "Pa")
_PREFIXES = ("", "f", "p", "n", "u", "\u00b5", "\u03bc", "m", "c", "d", "da", "h", "k", "M", "G", "T")
_SI_WORDS = tuple(word + end for word in ("meter", "metre", "gram", "second", "newton", "pascal") for end in ("", "s"))
_PREFIX_WORDS = (
    "",
    "femto",
    "pico",
    "nano",
    "micro",
    "milli",
    "centi",
    "deci",
    "hecto",
    "kilo",
    "mega",
    "giga",
    "tera",
)
OTHERS = (
    *("micron", "angstrom", "thou", "in", "inch", "ft", "foot", "feet", "yard", "mile"),
    *("sec", "min", "minute", "h", "hr", "hour", "day", "t", "tonne", "oz", "ounce", "lb", "pound"),
    *("lbf", "kgf", "dyn", "dyne", "bar", "mbar", "kbar", "atm", "psi", "ksi"),
)
"""Those beside the SI, which take no prefixes."""

UNITS: frozenset[str] = frozenset(
    (
        *(prefix + unit for prefix in _PREFIXES for unit in _SI),
        *(prefix + unit for prefix in _PREFIX_WORDS for unit in _SI_WORDS),
        *OTHERS,
    )
)
RATIOS = ("%", "percent", "ppm")


class QuantityError(ValueError):
    """A text is not a quantity of the wanted kind; ``hint`` is advice or the right form, if there is one."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """A kind of quantity: its name, working unit, dimension (powers of length, mass, time) and an example."""

    name: str
    unit: str
    dimension: tuple[int, int, int]
    example: str

    def number(self, value: float) -> str:
        """Return a value in working units (a ratio: in 1) as a short text with its unit."""
        return f"{float(value) / float(USUAL_UNITS[self.unit].size):.3g} {self.unit}"


LENGTH = Kind(name="length", unit="um", dimension=(1, 0, 0), example="0.2 um")
AREA = Kind(name="area", unit="um^2", dimension=(2, 0, 0), example="200 um^2")
SPEED = Kind(name="speed", unit="um/s", dimension=(1, 0, -1), example="1 mm/s")
MASS = Kind(name="mass", unit="kg", dimension=(0, 1, 0), example="5 g")
STRESS = Kind(name="stress", unit="MPa", dimension=(-1, 1, -2), example="250 MPa")
STIFFNESS = Kind(name="stiffness", unit="N/m", dimension=(0, 1, -2), example="300 N/m")
DAMPING = Kind(name="damping", unit="N*s/m", dimension=(0, 1, -1), example="0.05 N*s/m")
INVERSE_SPEED = Kind(name="inverse speed", unit="s/um", dimension=(-1, 0, 1), example="60 s/m")
TIME = Kind(name="time", unit="s", dimension=(0, 0, 1), example="0.5 s")
RATIO = Kind(name="ratio", unit="%", dimension=(0, 0, 0), example="20 %")
FORCE = Kind(name="force", unit="uN", dimension=(1, 1, -2), example="0.5 mN")
FREQUENCY = Kind(name="frequency", unit="Hz", dimension=(0, 0, -1), example="20 kHz")
DENSITY = Kind(name="density", unit="1/um^2", dimension=(-2, 0, 0), example="300 1/mm^2")
KINDS = (LENGTH, AREA, SPEED, MASS, STRESS, STIFFNESS, DAMPING, TIME, RATIO, FORCE, FREQUENCY, DENSITY, INVERSE_SPEED)


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: its exact size in working units (for a ratio: as a part of 1), and its dimension."""

    size: Fraction
    dimension: tuple[int, ...]


def _usual(kind: Kind, sizes: dict[str, str], suffix: str = "", power: int = 1) -> dict[str, Unit]:
    return {name + suffix: Unit(Fraction(size) ** power, kind.dimension) for name, size in sizes.items()}


_MICRO, _MU = "\u00b5", "\u03bc"
_LENGTHS = {
    "nm": "1e-3",
    "um": "1",
    f"{_MICRO}m": "1",
    f"{_MU}m": "1",
    "mm": "1e3",
    "cm": "1e4",
    "m": "1e6",
    "km": "1e9",
}
_FORCES = {"mN": "1e-3", "N": "1", "kN": "1e3"}
USUAL_UNITS: dict[str, Unit] = {
    **_usual(LENGTH, _LENGTHS),
    **_usual(AREA, _LENGTHS, "^2", 2),
    **_usual(SPEED, _LENGTHS, "/s"),
    **_usual(MASS, {"mg": "1e-6", "g": "1e-3", "kg": "1"}),
    **_usual(STRESS, {"mPa": "1e-9", "Pa": "1e-6", "kPa": "1e-3", "MPa": "1", "GPa": "1e3"}),
    **_usual(STIFFNESS, _FORCES, "/m"),
    **_usual(STIFFNESS, {"N/mm": "1e3"}),
    **_usual(DAMPING, _FORCES, "*s/m"),
    **_usual(DAMPING, _FORCES, " s/m"),
    **_usual(INVERSE_SPEED, {"s/um": "1", "s/mm": "1e-3", "s/m": "1e-6"}),
    **_usual(TIME, {"us": "1e-6", "ms": "1e-3", "s": "1"}),
    **_usual(RATIO, {"%": "1e-2"}),
    **_usual(FORCE, {"uN": "1", "mN": "1e3", "N": "1e6", "kN": "1e9"}),
    **_usual(DENSITY, {"1/um^2": "1", "1/mm^2": "1e-6", "1/cm^2": "1e-8", "1/m^2": "1e-12"}),
    **_usual(FREQUENCY, {"mHz": "1e-3", "Hz": "1", "kHz": "1e3", "MHz": "1e6"}),
}


class Quantity(float):
    """A float in working units that remembers its exact value, its kind and the text it was written as."""

    __slots__ = ("exact", "kind", "written")
    exact: Fraction
    kind: Kind
    written: str

    def __new__(cls, exact: Fraction, kind: Kind, written: str = "") -> Self:
        """Round ``exact`` once; raises OverflowError beyond the largest double."""
        self = super().__new__(cls, float(exact))
        self.exact, self.kind, self.written = exact, kind, written or in_working_unit(exact, kind)
        return self

    def __getnewargs__(self) -> tuple[Fraction, Kind, str]:  # type: ignore[override]  # float's own has one number
        return self.exact, self.kind, self.written

    def as_text(self) -> str:
        """Return a text that reads back to the same exact value, in the working unit if it has finite decimals."""
        return in_working_unit(self.exact, self.kind) if _decimals(self.exact) is not None else self.written


def in_working_unit(exact: Fraction, kind: Kind) -> str:
    """Return ``exact`` as text in the kind's working unit: in full if its decimals end, otherwise rounded once."""
    number = exact / USUAL_UNITS[kind.unit].size
    decimals = _decimals(number)
    if decimals is None:
        return f"{float(number)!r} {kind.unit}"
    return f"{Decimal(f'{int(number * 10**decimals)}e-{decimals}'):f} {kind.unit}"


def _decimals(value: Fraction) -> int | None:
    """Return the number of decimals that write the value in full, or None if that is more than 60."""
    return next((n for n in range(61) if 10**n % value.denominator == 0), None)


def read_quantity(text: str, *kinds: Kind) -> Quantity:
    """Return the quantity that ``text`` (`NUMBER UNIT`) writes, converted exactly and rounded once.

    Raises QuantityError if the text is no such thing or its unit is of none of the ``kinds``.
    """
    number, unit_text = _split(text.strip(" "), kinds[0])
    unit = _read_unit(unit_text, number)
    kind = next((k for k in kinds if k.dimension == unit.dimension), None)
    if kind is None:
        wanted = " or ".join(_with_article(k) for k in kinds)
        other = next((k for k in KINDS if k.dimension == unit.dimension), None)
        what = _with_article(other) if other else "something else"
        raise QuantityError(
            f'"{unit_text}" is the unit of {what}, {wanted} is needed', f'right form: "{number} {kinds[0].unit}"'
        )
    if kind is RATIO and unit_text not in RATIOS:
        raise QuantityError(f'"{unit_text}" is no unit of a ratio', f'right form: "{RATIO.example}"')
    try:
        return Quantity(Fraction(number) * unit.size, kind, text)
    except OverflowError:
        raise QuantityError("too large a number") from None


def parse_unit(text: str) -> Unit:
    """Return the exact size and dimension of a unit; raises QuantityError if the text is not a unit."""
    return _read_unit(text, "1")


def _read_unit(text: str, number: str) -> Unit:
    if text in USUAL_UNITS:
        return USUAL_UNITS[text]
    if len(text) > MAX_UNIT_LENGTH:
        raise QuantityError(f"a unit of more than {MAX_UNIT_LENGTH} characters")
    if foreign := _FOREIGN.search(text):
        raise QuantityError(f"the character {_named_character(foreign[0])} has no place in a unit")
    if not _UNIT.fullmatch(text):
        raise QuantityError(f'"{text}" is no unit', 'names joined by * or /, powers as in um^2, as in "N*s/m"')
    for name in () if text in RATIOS else re.findall(_NAME, text):
        if name in RATIOS:
            raise QuantityError(f'"{name}" is part of no other unit', f'right form: "{RATIO.example}"')
        if name not in UNITS:
            raise QuantityError(f'unknown unit "{name}"', _power_hint(text, number) or _name_hint(name))
    return _sized_by_pint(text)


def _name_hint(name: str) -> str:
    """Return advice on an unknown name: MPa for Mpa, otherwise the names that exist."""
    meant = sorted(known for known in UNITS if known.casefold() == name.casefold())
    quoted = " or ".join(f'"{known}"' for known in meant)
    return f"did you mean {quoted}?" if meant else "a length, time, mass, force or pressure, such as um, s, kg, N, MPa"


def _power_hint(text: str, number: str) -> str:
    """Advise um^2 for um2."""
    powered = _BARE_POWER.sub(r"^\1", text)
    return f'write "{number} {powered}"' if powered != text and _UNIT.fullmatch(powered) else ""


def in_unit(value: Any, unit: str) -> Any:
    """Return numbers unchanged, since they are in ``unit`` already, and quantities of pint converted to it.

    Raises QuantityError for a quantity of another dimension.
    """
    if isinstance(value, list | tuple):
        return [in_unit(each, unit) for each in value]
    if not is_of_pint(value):
        return value
    try:
        return value.to(unit).magnitude
    except Exception as problem:  # pint's errors, which are not loaded here
        text = str(value)
        given = text if len(text) <= MAX_UNIT_LENGTH else f"values in {value.units}"
        raise QuantityError(f"{given}: a quantity in {unit} is needed, or a number") from problem


def quantity_of(value: Any, *kinds: Kind) -> Quantity:
    """Return a quantity given from Python, as a text or as a quantity of pint.

    Raises QuantityError as `read_quantity` does, and for a number, which does not say its unit.
    """
    if isinstance(value, str):
        return read_quantity(value, *kinds)
    if is_of_pint(value):
        return from_pint(value, *kinds)
    if isinstance(value, Quantity) and value.kind in kinds:
        return value
    if isinstance(value, Real) and not isinstance(value, bool):
        raise QuantityError("a number without a unit", f'right form: "{kinds[0].example}"')
    raise QuantityError("needs a number with a unit", f'right form: "{kinds[0].example}"')


def from_pint(value: Any, *kinds: Kind) -> Quantity:
    """Return a quantity of pint as it is written, which is exact, or converted to the unit of its kind.

    Raises QuantityError if it is of none of the ``kinds``, or not finite.
    """
    try:
        magnitude = float(value.magnitude)
    except (TypeError, ValueError, OverflowError):
        raise QuantityError("needs one finite number with a unit", f'right form: "{kinds[0].example}"') from None
    if not isfinite(magnitude):
        raise QuantityError("not a finite number")
    try:
        return read_quantity(f"{magnitude!r} {value.units:~C}", *kinds)
    except QuantityError:
        for kind in kinds:
            with suppress(QuantityError):
                return Quantity(Fraction(repr(float(in_unit(value, kind.unit)))), kind)
        raise


def unit_name(unit: Any) -> Any:
    """Return a unit of pint as a text, anything else as it is."""
    return f"{unit:~C}".replace(_MICRO, "u") if hasattr(unit, "m_from") else unit


def is_of_pint(value: Any) -> bool:
    """Whether a value is a quantity of pint, which need not be loaded for that."""
    return hasattr(value, "magnitude") and hasattr(value, "to") and hasattr(value, "units")


@lru_cache(maxsize=256)
def _sized_by_pint(text: str) -> Unit:
    registry = _registry()
    try:
        units = registry.parse_units(text)
        size, _ = registry.get_base_units(units)
        dimension = units.dimensionality
    except Exception:  # noqa: BLE001  (pint raises TypeError, OverflowError and more for odd powers)
        raise QuantityError(f'"{text}" is no unit') from None
    powers = tuple(dimension.get(name, 0) for name in ("[length]", "[mass]", "[time]"))
    if not isinstance(size, (int, Fraction)) or any(power % 1 for power in powers):
        raise QuantityError(f'the unit "{text}" has no exact size in um, s and kg')
    return Unit(Fraction(size) * Fraction(10**6) ** int(powers[0]), tuple(int(power) for power in powers))


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Fraction)


def _split(text: str, kind: Kind) -> tuple[str, str]:
    """Return the number and the unit of a text, or raise QuantityError with the most helpful message."""
    right_form = f'right form: "{kind.example}"'
    if len(text) > _MAX_TEXT_LENGTH:
        raise QuantityError(f"a text of more than {_MAX_TEXT_LENGTH} characters", right_form)
    for pattern, message, hint in _TRAPS:
        if found := pattern.search(text):
            raise QuantityError(message.format(_named_character(found[0])), hint(text) if hint else right_form)
    match = _QUANTITY.fullmatch(text)
    if match is None:
        if re.fullmatch(NUMBER, text):
            raise QuantityError("no unit", f'right form: "{text} {kind.unit}"')
        raise QuantityError("not a number and a unit", right_form)
    number, gap, unit = match.groups()
    if not gap and unit[0] in "./*^":
        raise QuantityError("not a number and a unit", right_form)
    return number, unit


def _without_comma(text: str) -> str:
    if "." in text or text.count(",") > 1:
        return "no commas between thousands; a dot before the decimals"
    return f'write "{_COMMA.sub(".", text)}"'


_MAX_TEXT_LENGTH = 200
Hint = Callable[[str], str]
_TRAPS: tuple[tuple[re.Pattern[str], str, Hint | None], ...] = (
    (
        re.compile(rf"[{_MINUS_SIGNS}]"),
        "{} is not the minus sign of a number; that is '-', U+002D",
        lambda text: f'write "{re.sub(f"[{_MINUS_SIGNS}]", "-", text)}"',
    ),
    (re.compile(r"(?<=[0-9]),[0-9]+"), "a comma in a number", _without_comma),
    (re.compile(r"^[+-]?0[xobXOB]"), "not a decimal number", None),
    (re.compile(r"^[+-]?(?:nan|inf|infinity)\b", re.IGNORECASE), "not a finite number", None),
    (re.compile(r"[0-9]_[0-9]"), "an underscore in a number", lambda text: f'write "{text.replace("_", "")}"'),
    (
        re.compile(r"[0-9] *(?:\*|/|\+|-)+ *[0-9(]|[^*/^eE ] +[+-] *[0-9]|[()]"),
        "an expression; one number and one unit are needed",
        None,
    ),
    (re.compile(rf"^{_MANTISSA}[eE][+-]?[0-9]{{4,}}"), "an exponent of more than three digits", None),
)


def _named_character(character: str) -> str:
    return f"'{character}' (U+{ord(character[0]):04X})" if character.isprintable() else f"U+{ord(character[0]):04X}"


def _with_article(kind: Kind) -> str:
    return f"an {kind.name}" if kind.name[0] in "aeiou" else f"a {kind.name}"
