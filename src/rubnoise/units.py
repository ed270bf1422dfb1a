"""Quantities as text, `NUMBER UNIT`: an exact number and an exact size of its unit, in um, s and kg.

The grammar is narrow on purpose: "1,5 mm" is not 15 mm, a Unicode minus is not dropped, "5 mm + 3 mm" is refused, and
so is a tower of powers. Nor is a bit, a count or a radian a unit, which libraries take for 1, so that an area may hold
one. Sizes stand in a table, which tests hold equal to pint's; quantities of pint are taken from Python, and pint is
loaded by those who make them.
"""

import re
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from numbers import Real
from typing import Any, Self

_MANTISSA = r"[+-]?[0-9]+(?:\.[0-9]+)?"
NUMBER = rf"{_MANTISSA}(?:[eE][+-]?[0-9]{{1,3}})?"
MAX_UNIT_LENGTH = 40
# One small power per name: a tower of powers would be worked out exactly until the memory is gone.
_NAME = r"[A-Za-z\u00b5\u03bc%][A-Za-z0-9\u00b5\u03bc%]*"
_FACTOR = rf"{_NAME}(?:(?:\^|\*\*)-?[0-9]{{1,2}}(?:\.[0-9]+)?)?"
_UNIT = re.compile(rf"(?:1 ?/ ?)?{_FACTOR}(?:(?: ?[*/] ?| +){_FACTOR})*")
_QUANTITY = re.compile(rf"((?>{NUMBER}))( *)([^ ].*)")
_FACTORS = re.compile(rf"([*/ ]*)({_NAME})(?:(?:\^|\*\*)(-?[0-9]+))?")
_FOREIGN = re.compile(r"[^A-Za-z0-9\u00b5\u03bc%*/^. \-]")
_MINUS_SIGNS = "\u2212\u2010\u2011\u2012\u2013\u2014\ufe63\uff0d"
_BARE_POWER = re.compile(r"(?<=[A-Za-z\u00b5\u03bc])(-?[0-9])")


class Unfit(ValueError):  # noqa: N818  (says what the value is)
    """A value that does not fit its key; ``hint`` is advice or the right form, if there is one."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


class QuantityError(Unfit):
    """A text is not a quantity of the wanted kind."""


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


_PREFIXES = (
    *(("f", "femto", -15), ("p", "pico", -12), ("n", "nano", -9), ("u", "micro", -6), ("\u00b5", "micro", -6)),
    *(("\u03bc", "micro", -6), ("m", "milli", -3), ("c", "centi", -2), ("d", "deci", -1), ("da", "", 1)),
    *(("h", "hecto", 2), ("k", "kilo", 3), ("M", "mega", 6), ("G", "giga", 9), ("T", "tera", 12)),
)
_SI = {
    "m": ("1e6", LENGTH, ("meter", "meters", "metre", "metres")),
    "g": ("1e-3", MASS, ("gram", "grams")),
    "s": ("1", TIME, ("second", "seconds")),
    "N": ("1e6", FORCE, ("newton", "newtons")),
    "Pa": ("1e-6", STRESS, ("pascal", "pascals")),
}
_OTHERS = {
    LENGTH: "micron 1, angstrom 1e-4, thou 25.4, in inch 25400, ft foot feet 304800, yard 914400, mile 1609344e3",
    TIME: "sec 1, min minute 60, h hr hour 3600, day 86400",
    MASS: "t tonne 1000, oz ounce 0.028349523125, lb pound 0.45359237",
    FORCE: "lbf 4448221.6152605, kgf 9806650, gf 9806.65, dyn dyne 10",
    STRESS: "bar 0.1, mbar 1e-4, kbar 100, atm 0.101325, psi 8896443230521/1290320000000000, "
    "ksi 8896443230521/1290320000000",
    RATIO: "% 1e-2, percent 1e-2, ppm 1e-6",
}
"""Sizes in working units of units without prefixes."""


def _table() -> dict[str, Unit]:
    """Return every unit by its names, also with prefixes: symbols before symbols, words before words."""
    units: dict[str, Unit] = {}
    for symbol, (size, kind, words) in _SI.items():
        for mark, prefix, power in (("", "", 0), *_PREFIXES):
            unit = Unit(Fraction(size) * Fraction(10) ** power, kind.dimension)
            units |= {mark + symbol: unit} | {prefix + word: unit for word in words if prefix or not mark}
    for kind, told in _OTHERS.items():
        for *names, size in map(str.split, told.split(",")):
            units |= dict.fromkeys(names, Unit(Fraction(size), kind.dimension))
    return units


UNITS = _table()
RATIOS = tuple(name for name, unit in UNITS.items() if unit.dimension == RATIO.dimension)


def _product(text: str) -> Unit:
    size, dimension = Fraction(1), tuple[int, ...]((0, 0, 0))
    for operator, name, power in _FACTORS.findall(text):
        unit, exponent = UNITS[name], int(power or 1) * (-1 if "/" in operator else 1)
        size *= unit.size**exponent
        dimension = tuple(had + exponent * more for had, more in zip(dimension, unit.dimension, strict=True))
    return Unit(size, dimension)


_FREQUENCIES = {"mHz": -3, "Hz": 0, "kHz": 3, "MHz": 6}
_LENGTHS = ("nm", "um", "\u00b5m", "\u03bcm", "mm", "cm", "m", "km")
_USUAL = (
    "mg,g,kg,mPa,Pa,kPa,MPa,GPa,mN/m,N/m,kN/m,N/mm,mN*s/m,N*s/m,kN*s/m,mN s/m,N s/m,kN s/m,s/um,s/mm,s/m,us,ms,s,%,uN,"
    "mN,N,kN,1/um^2,1/mm^2,1/cm^2,1/m^2"
)
USUAL_UNITS: dict[str, Unit] = {
    text: _product(text)
    for text in (*(f"{length}{end}" for end in ("", "^2", "/s") for length in _LENGTHS), *_USUAL.split(","))
} | {name: Unit(Fraction(10) ** power, FREQUENCY.dimension) for name, power in _FREQUENCIES.items()}
"""What a text usually says, and an axis of a page offers."""


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
    unit = parse_unit(unit_text, number)
    kind = next((k for k in kinds if k.dimension == unit.dimension), None)
    if kind is None:
        wanted = " or ".join(_with_article(k) for k in kinds)
        other = next((_with_article(k) for k in KINDS if k.dimension == unit.dimension), "something else")
        said = f'"{unit_text}" is the unit of {other}, {wanted} is needed'
        raise QuantityError(said, f'right form: "{number} {kinds[0].unit}"')
    if kind is RATIO and unit_text not in RATIOS:
        raise QuantityError(f'"{unit_text}" is no unit of a ratio', f'right form: "{RATIO.example}"')
    try:
        return Quantity(Fraction(number) * unit.size, kind, text)
    except OverflowError:
        raise QuantityError("too large a number") from None


def parse_unit(text: str, number: str = "1") -> Unit:
    """Return the exact size and dimension of a unit; raises QuantityError, with advice for ``number`` of it."""
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
    if re.search(r"(?:\^|\*)-?[0-9]+\.", text):
        raise QuantityError(f'the unit "{text}" has no exact size in um, s and kg')
    return _product(text)


def unit_or_one(text: str) -> Unit:
    """Return a unit; one of size 1 without a dimension for none, and for an unknown one."""
    with suppress(QuantityError):
        return parse_unit(text)
    return Unit(Fraction(1), ())


def _name_hint(name: str) -> str:
    """Return advice on an unknown name: MPa for Mpa, otherwise the names that exist."""
    meant = sorted(known for known in UNITS if known.casefold() == name.casefold())
    quoted = " or ".join(f'"{known}"' for known in meant)
    return f"did you mean {quoted}?" if meant else "a length, time, mass, force or pressure, such as um, s, kg, N, MPa"


def _power_hint(text: str, number: str) -> str:
    powered = _BARE_POWER.sub(r"^\1", text)
    return f'write "{number} {powered}"' if powered != text and _UNIT.fullmatch(powered) else ""


def in_unit(value: Any, unit: str) -> Any:
    """Return numbers as they are, quantities of pint converted; raises QuantityError for one of another dimension."""
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
    """Return a text or a quantity of pint as a quantity; raises as `read_quantity`, and for a number without a unit."""
    if isinstance(value, str):
        return read_quantity(value, *kinds)
    if isinstance(value, Quantity) and value.kind in kinds:
        return value
    if is_of_pint(value):
        return _from_pint(value, *kinds)
    bare = isinstance(value, Real) and not isinstance(value, bool)
    what = "a number without a unit" if bare else "needs a number with a unit"
    raise QuantityError(what, f'right form: "{kinds[0].example}"')


def _from_pint(value: Any, *kinds: Kind) -> Quantity:
    """Return a quantity of pint as it is written, which is exact, or converted to the unit of its kind."""
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
    return f"{unit:~C}".replace("\u00b5", "u") if hasattr(unit, "m_from") else unit


def is_of_pint(value: Any) -> bool:
    """Whether a value is a quantity of pint, which need not be loaded for that."""
    return hasattr(value, "magnitude") and hasattr(value, "to") and hasattr(value, "units")


def _split(text: str, kind: Kind) -> tuple[str, str]:
    """Return the number and the unit of a text, or raise QuantityError with the most helpful message."""
    right_form = f'right form: "{kind.example}"'
    if len(text) > _MAX_TEXT_LENGTH:
        raise QuantityError(f"a text of more than {_MAX_TEXT_LENGTH} characters", right_form)
    for pattern, message in _TRAPS.items():
        if found := re.search(pattern, text):
            raise QuantityError(message.format(_named_character(found[0])), _mended(text, pattern) or right_form)
    if re.fullmatch(NUMBER, text):
        raise QuantityError("no unit", f'right form: "{text} {kind.unit}"')
    match = _QUANTITY.fullmatch(text)
    if match is None or (not match[2] and match[3][0] in "./*^"):
        raise QuantityError("not a number and a unit", right_form)
    return match[1], match[3]


def _mended(text: str, trap: str) -> str:
    """Return advice on a text in a trap if there is some: the text with another sign of minus, or another point."""
    if trap == _COMMA and ("." in text or text.count(",") > 1):
        return "no commas between thousands; a dot before the decimals"
    right = {_MINUS: "-", _COMMA: ".", _UNDERSCORE: ""}
    return f'write "{re.sub(trap, right[trap], text)}"' if trap in right else ""


_MAX_TEXT_LENGTH = 200
_MINUS, _COMMA, _UNDERSCORE = f"[{_MINUS_SIGNS}]", "(?<=[0-9]),(?=[0-9])", "(?<=[0-9])_(?=[0-9])"
_TRAPS = {
    _MINUS: "{} is not the minus sign of a number; that is '-', U+002D",
    _COMMA: "a comma in a number",
    "^[+-]?0[xobXOB]": "not a decimal number",
    r"(?i)^[+-]?(?:nan|inf|infinity)\b": "not a finite number",
    _UNDERSCORE: "an underscore in a number",
    r"[0-9] *(?:\*|/|\+|-)+ *[0-9(]|[^*/^eE ] +[+-] *[0-9]|[()]": "an expression; one number and one unit are needed",
    rf"^{_MANTISSA}[eE][+-]?[0-9]{{4,}}": "an exponent of more than three digits",
}
"""What a text may have in place of a number, in the order in which it is looked for, and what is said of it."""


def _named_character(character: str) -> str:
    return f"'{character}' (U+{ord(character[0]):04X})" if character.isprintable() else f"U+{ord(character[0]):04X}"


def _with_article(kind: Kind) -> str:
    return f"an {kind.name}" if kind.name[0] in "aeiou" else f"a {kind.name}"


# How files and people spell units: newton for Newton, um^2 for um2; one way for text, HDF5 and the shell.
NONE = frozenset(["", "1", "-"])  # what stands in place of a unit if a column has none
BESIDE = frozenset(
    [prefix + unit for unit in ("V", "A", "W", "Hz", "Ohm", "\u03a9", "\u2126") for prefix in ("", *"u\u00b5\u03bcmkM")]
    + ["K", "C", "\u00b0C", "degC", "rpm", "1/min", "dB", "rad", "deg", "\u00b0", "%"]
)
"""Units of other columns: known, and kept as they are."""

_POWERS = str.maketrans({"\u00b2": "^2", "\u00b3": "^3", "\u00b7": "*", "\u22c5": "*"})
_ALSO = "kp kgf, msec ms, usec us, d day, days day, hours hour, minutes minute, sek s, sek. s, sekunde s, sekunden s"
_SPELLINGS = dict(pair.split() for pair in _ALSO.split(", "))


def spelled(unit: str) -> str:
    """Return a unit as the table of units spells it: newton for Newton, um^2 for um2, an empty text for `-`."""
    text = unit.strip().translate(_POWERS).replace("_per_", "/")
    lower = text.lower() if text[1:].islower() and len(text) > 2 else ""
    powered = re.sub(r"(?<=[A-Za-z\u00b5\u03bc])([23])(?=$|/)", r"^\1", text)
    known = (way for way in (text, _SPELLINGS.get(text.lower(), ""), lower, powered) if is_unit(way))
    return next(known, "" if text in NONE else text)


def is_unit(text: str) -> bool:
    """Whether a text is a known unit, as `spelled` returns it."""
    return text in BESIDE or len(unit_or_one(text).dimension) > 0
