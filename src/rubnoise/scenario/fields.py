"""What a key may hold: a quantity, a number, a choice or a line of text, each read strictly; and tables of keys.

Each type of value reads or refuses the value of a key.
"""

import re
import unicodedata
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from datetime import date, datetime, time
from fractions import Fraction
from inspect import cleandoc
from math import isfinite
from typing import Any, Final

from rubnoise.contact.laws import LAWS
from rubnoise.errors import did_you_mean
from rubnoise.units import LENGTH, NUMBER, RATIO, Kind, Quantity, Unfit, is_of_pint, quantity_of, read_quantity

TITLE_CHARACTERS: Final = 200

# Letters and marks that print as nothing, such as fillers; and selectors of a variant without a sign before them.
_SELECTORS = "\u180b-\u180d\u180f\ufe00-\ufe0f\U000e0100-\U000e01ef"
_HIDDEN = re.compile(
    rf"[\u034f\u115f\u1160\u17b4\u17b5\u3164\uffa0\U00016fe4\U0001d159]|(?:^|[ {_SELECTORS}])[{_SELECTORS}]"
)
_BLANK = "\u2800"
"""A letter of Braille without a dot: it looks like a space."""


@dataclass(frozen=True, slots=True)
class Range:
    """Bounds of a number in working units; ``low`` itself is allowed, and 0 if ``zero`` is true."""

    low: float
    high: float
    zero: bool = False

    def __contains__(self, value: object) -> bool:
        return isinstance(value, (int, float)) and ((self.zero and value == 0) or self.low <= value <= self.high)


class Field(ABC):
    """A type of value: ``read`` converts the value of the file."""

    @abstractmethod
    def read(self, value: Any) -> Any:
        """Return the value, or raise Unfit."""

    def of_python(self, value: Any) -> Any:
        """Return a value from Python, which may be of more types than one of a file."""
        return self.read(value)


@dataclass(frozen=True, slots=True)
class Measure(Field):
    """A quantity with a unit, of the first kind or another of ``kinds``; outside of ``plausible`` it gets a warning."""

    kinds: tuple[Kind, ...]
    possible: Range
    plausible: Range

    def of_python(self, value: Any) -> Quantity:
        """Return a quantity; a bare number is in working units, as it is never in a file."""
        if isinstance(value, bool | Quantity) or not isinstance(value, int | float) or _no_double(value):
            return self.read(value)
        # By way of Python's own type: a subclass may show itself otherwise.
        exact = Fraction(repr(int(value) if isinstance(value, int) else float(value)))
        return self._within(Quantity(exact, self.kinds[0]))

    def read(self, value: Any) -> Quantity:
        """Return the quantity that a text writes, or one of Python."""
        form = f'right form: "{self.kinds[0].example}"'
        if isinstance(value, str | Quantity) or is_of_pint(value):
            return self._within(quantity_of(value, *self.kinds))
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise Unfit(f"needs a number with a unit, not {_named(value)}", form)
        if reason := _no_double(value):
            raise Unfit(reason, form)
        raise Unfit("a number without a unit", f'right form: "{value} {self.kinds[0].unit}"')

    def _within(self, quantity: Quantity) -> Quantity:
        if quantity in self.possible:
            return quantity
        if quantity < 0 or (float(quantity) == 0.0 and not self.possible.zero):
            raise Unfit(f"must {'not be negative' if self.possible.zero else 'be above 0'}")
        low, high = (quantity.kind.number(bound) for bound in (self.possible.low, self.possible.high))
        raise Unfit("too large" if quantity > self.possible.high else "too small", f"possible: {low} to {high}")


@dataclass(frozen=True, slots=True)
class Number(Field):
    """A TOML number within ``possible``; with ``whole`` an integer."""

    possible: Range
    whole: bool = False

    def read(self, value: Any) -> int | float:
        """Return the number; raises Unfit for strings and booleans."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise Unfit(f"needs a number, not {_named(value)}", _unquoted_hint(value))
        if not (isinstance(value, int) or isfinite(value)):
            raise Unfit("not a finite number")
        if self.whole and not isinstance(value, int):
            raise Unfit("needs a whole number")
        if value not in self.possible:
            low, high = self.possible.low, self.possible.high
            bounds = f"{low} to {high}" if self.whole else f"{low:g} to {high:g}"
            wrong = "must be above 0" if value <= 0 < low else "too large" if value > high else "too small"
            raise Unfit(wrong, f"possible: {bounds}")
        return value if self.whole else float(value)


@dataclass(frozen=True, slots=True)
class Choice(Field):
    """One of the ``available`` words."""

    available: tuple[str, ...]

    def read(self, value: Any) -> str:
        """Return the word."""
        available = f"available: {', '.join(self.available)}"
        if isinstance(value, str) and value in self.available:
            return value
        if not isinstance(value, str):
            raise Unfit(f"needs a word in quotation marks, not {_named(value)}", available)
        raise Unfit(f'unknown value "{value[:40]}"', did_you_mean(value, self.available, quote='"') or available)


@dataclass(frozen=True, slots=True)
class Line(Field):
    """One line of printable text."""

    def read(self, value: Any) -> str:
        """Return the text."""
        if not isinstance(value, str):
            raise Unfit(f"needs a text in quotation marks, not {_named(value)}")
        if len(value) > TITLE_CHARACTERS:
            raise Unfit(f"longer than {TITLE_CHARACTERS} characters")
        if not value.isprintable():
            raise Unfit("holds a line break or another character that does not print")
        if hidden := _HIDDEN.search(value):
            raise Unfit(f"holds a character that cannot be seen, U+{ord(hidden[0][-1]):04X}")
        # Letters, digits, signs and symbols show something by themselves, spaces and marks do not.
        if value and not any(unicodedata.category(each)[0] in "LNPS" and each != _BLANK for each in value):
            raise Unfit("holds nothing that can be seen", "leave it out, or say what the run is about")
        return value


def _no_double(value: float) -> str:
    """Return why a number is not a finite double, if it is not: integers may have any length."""
    try:
        return "" if isfinite(value) else "not a finite number"
    except OverflowError:
        return "too large"


def _named(value: Any) -> str:
    names: dict[type, str] = {
        bool: "a boolean",
        str: "a text",
        int: "a number",
        float: "a number",
        list: "a list",
        dict: "a table",
        **dict.fromkeys((date, datetime, time), "a date or time"),
    }
    return names.get(type(value), f"a value of type {type(value).__name__}")


def _unquoted_hint(value: Any) -> str:
    if not isinstance(value, str):
        return ""
    if re.fullmatch(NUMBER, value):
        return f"write {value} without quotation marks"
    percent = re.fullmatch(rf"({NUMBER}) *%", value)
    return f"write {float(percent[1]) / 100.0:.12g}" if percent else ""


MOST: Final = 2000  # values of a list at most: a result file keeps them all

_POSSIBLE = Range(1e-12, 1e12)
LAWS_OF_PARTS = tuple(name for name, entry in LAWS.items() if not (entry.own_keys or entry.parameters))
_RATIO = Measure((RATIO,), _POSSIBLE, _POSSIBLE)


@dataclass(frozen=True, slots=True)
class Sizes(Field):
    """A list of positive numbers, or of lengths as texts, which become um."""

    what: str

    def read(self, value: Any) -> tuple[float, ...]:
        """Return the numbers."""
        if not isinstance(value, list | tuple) or not 1 <= len(value) <= MOST:
            raise Unfit(f"needs a list of 1 to {MOST} {self.what}", "in brackets: [4.1, 5.3]")
        return tuple(_size(each) for each in value)


@dataclass(frozen=True, slots=True)
class Parts(Field):
    """A list of tables: law, mean, and spread if the law takes one."""

    def read(self, value: Any) -> tuple[dict[str, Any], ...]:
        """Return the tables, means in um and spreads as they are written."""
        if not isinstance(value, list | tuple) or not 1 <= len(value) <= MOST:
            raise Unfit(f"needs a list of 1 to {MOST} tables", 'such as [{law = "fixed", mean = 4}]')
        return tuple(_part(number, each) for number, each in enumerate(value, 1))


def ratio_of(part: Mapping[str, Any]) -> float:
    """Return the standard deviation of a part over its mean; 0 without a spread."""
    return float(read_quantity(part["spread"], RATIO)) if "spread" in part else 0.0


def _size(value: Any) -> float:
    if isinstance(value, str):
        return float(Measure((LENGTH,), _POSSIBLE, _POSSIBLE).read(value))
    return float(Number(_POSSIBLE).read(value))


def _part(number: int, value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping) or not {"law", "mean"} <= value.keys() <= {"law", "mean", "spread"}:
        raise Unfit(f"part {number} needs a law and a mean, and may have a spread", '{law = "fixed", mean = 4}')
    law = Choice(LAWS_OF_PARTS).read(value["law"])
    entry, read = LAWS[law], {"law": law, "mean": _size(value["mean"])}
    if entry.takes_spread != ("spread" in value):
        raise Unfit(f'part {number}: the law "{law}" {"needs a" if entry.takes_spread else "takes no"} spread')
    if not entry.takes_spread:
        return read
    spread = _RATIO.read(value["spread"])
    if spread > entry.widest:
        raise Unfit(f'part {number}: too wide for the law "{law}"', f'up to "{100.0 * entry.widest:g} %"')
    return read | {"spread": spread.as_text()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """A key of a table: the values it takes, its meaning, its default, and whether a scenario must have it.

    ``sample`` is an ordinary value; ``form`` is what a refusal advises, if that is more than the sample; ``remark`` is
    what the template adds.
    """

    kind: Field
    about: str = ""
    default: Any = None
    is_needed: bool = False
    sample: Any = None
    form: str = ""
    remark: str = ""


def key(kind: Field, default: Any = None, **more: Any) -> Any:
    """Return a field of a table that a scenario may leave out."""
    return field(default=default, metadata={Key: Key(kind=kind, default=default, **more)})


def needed(kind: Field, **more: Any) -> Any:
    """Return a field of a table that a scenario must have."""
    return field(metadata={Key: Key(kind=kind, is_needed=True, **more)})


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """The values of a table, all of whose keys are known; its docstring ends with a paragraph of the keys' meanings."""


_KEYS: Final[dict[type[Section], Mapping[str, Key]]] = {}
_MEANING: Final = re.compile(r"^(\w+): (.*(?:\n +.*)*)", re.MULTILINE)


def keys_of(section: type[Section]) -> Mapping[str, Key]:
    """Return the keys of a table by their names."""
    if section not in _KEYS:
        told = {name: " ".join(words.split()) for name, words in _MEANING.findall(cleandoc(section.__doc__ or ""))}
        keys = {each.name: each.metadata[Key] for each in fields(section) if Key in each.metadata}
        _KEYS[section] = {name: replace(key, about=key.about or told.get(name, "")) for name, key in keys.items()}
    return _KEYS[section]


def about_of(section: type[Section]) -> str:
    """Return what a table is about, without the meanings of its keys."""
    paragraphs = cleandoc(section.__doc__ or "").split("\n\n")
    return "\n\n".join(each for each in paragraphs if _MEANING.match(each) is None)
