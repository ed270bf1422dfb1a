"""Conditions on junctions, as in ``diameter > 6 um and not (ended_early or birth_distance < 1 mm)``.

Columns, numbers with units, and states are joined by < <= > >= == !=, and, or, not and parentheses, as Python joins
them. A number without a unit is in the unit of the column it is compared with. A state (complete, alive_at_start,
alive_at_end, ended_early) by itself, or after ``state ==``, chooses the rows that have it; a row may have several.

Python's own parser reads how the parts are joined; nothing is evaluated by it, and other forms are refused.
"""

import ast
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isinf
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused
from rubnoise.record.sink import Columns
from rubnoise.scenario.fields import did_you_mean as nearest
from rubnoise.scenario.problems import Place, Problem
from rubnoise.storage.schema import JUNCTIONS, Dataset
from rubnoise.units import KINDS, NUMBER, QuantityError, read_quantity

LONGEST: Final = 1000
"""Most characters of a condition: no person writes a longer one."""

STATES: Final = {"complete": 0} | {
    name: bit for column in JUNCTIONS.columns if column.name == "state" for bit, name in column.flags
}

Choose = Callable[[Columns], NDArray[np.bool_]]
"""Returns for each row whether it is chosen, from the columns by name."""

COMPARISONS: Final[Mapping[type[ast.cmpop], Callable[[Any, Any], Any]]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.Eq: np.equal,
    ast.NotEq: np.not_equal,
}

_FACTOR: Final = (
    r"(?!(?:and|or|not)\b)[A-Za-z\u00b5\u03bc%][A-Za-z0-9\u00b5\u03bc%]*+(?:(?:\^|\*\*)-?[0-9]++)?(?![A-Za-z0-9_])"
)
_WORD: Final = re.compile(
    rf"(?i:(?P<number>(?P<digits>{NUMBER})(?![0-9.,_])(?: *{_FACTOR}(?: ?[*/] ?{_FACTOR})*)?))"
    r"|(?P<joint>(?:and|or|not)\b|<=|>=|==|!=|<(?!>)|>(?!<)|[()]|[ \t\r\n]+)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*)"  # keys of a sweep have dots
)
_SLIPS: Final = (
    (re.compile(r"=[<>]|<>|=~"), "no comparison", "the comparisons are < <= > >= == !="),
    (re.compile(r"="), "no comparison", "equality is written =="),
    (re.compile(r"&&?"), "no operator", "write and"),
    (re.compile(r"\|\|?"), "no operator", "write or"),
    (re.compile(r"!"), "no operator", "write not"),
    (re.compile(r"[0-9.]+(?:[,_][0-9.]+)+"), "no number", "digits, with a dot before the decimals, as in 1234.5"),
    (re.compile(r"[+-]?\.[0-9]+|[0-9]+\.|[+-]?(?:nan|inf)\b"), "no number", "digits on both sides of the dot: 0.5"),
    (re.compile(r"[\u2010-\u2014\u2212\ufe63\uff0d]"), "not the minus sign of a number", "that is '-', U+002D"),
    (re.compile(r"[\u00b2\u00b3]"), "no part of a condition", "powers in units are written ^2"),
    (re.compile(r"[-+*/%^]"), "no part of a condition", "there is no arithmetic; compare a column with a number"),
    (re.compile(r"['\"]"), "no part of a condition", "names and states are written without quotation marks"),
    (re.compile(r"."), "no part of a condition", ""),
)
_EXAMPLE: Final = "for instance: diameter > 6 um"
_JOINED: Final = "conditions are joined by and, or"


class ConditionRefused(Refused):
    """A condition on junctions is not valid; its message shows the place."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """A function that chooses rows, and the names of the columns that it needs."""

    columns: frozenset[str]
    chosen: Choose


def condition(text: str, columns: Sequence[Dataset] = JUNCTIONS.columns) -> Condition:
    """Return the condition that a text writes about rows with these columns.

    Raises ConditionRefused, with the text and a caret below the wrong part, if it is not valid.
    """
    if len(text) > LONGEST:
        raise ConditionRefused(f"--where: error: a condition of more than {LONGEST} characters")
    reader = _Reader(text.strip(), columns)
    chosen = reader.choose(reader.parsed())
    return Condition(columns=frozenset(reader.named), chosen=chosen)


def did_you_mean(word: str, names: Iterable[str]) -> str:
    """Return advice for an unknown word: the nearest name, the names that contain it, or all names."""
    known = list(names)
    holding = [name for name in known if len(word) > 2 and word.lower() in name]
    if holding:
        return f"did you mean {' or '.join(holding)}?"
    return nearest(word, tuple(known)) or f"one of {', '.join(known)}"


class _Reader:
    """What a condition says; ``named`` are the columns found so far, ``_operands`` its names and numbers by place."""

    def __init__(self, text: str, columns: Sequence[Dataset]) -> None:
        self._text = text
        self._columns = {column.name: column for column in columns}
        self._states = STATES if any(column.name == "state" and column.flags for column in columns) else {}
        self._operands: dict[int, re.Match[str]] = {}
        self.named: set[str] = set()

    def parsed(self) -> ast.expr:
        """Return how Python joins the operands, each a name at its place."""
        if not self._text:
            raise self._refused((0, 1), "no condition", _EXAMPLE)
        plain = self._plain()
        try:
            return ast.parse(plain, mode="eval").body
        except SyntaxError as error:
            raise self._misread((error.offset or 0) - 1, error.msg) from None
        except (RecursionError, MemoryError):
            raise self._refused((0, len(plain)), "too many levels of not") from None

    def _plain(self) -> str:
        """Return the text with an x and blanks for each operand, so that all places stay."""
        plain = ""
        while len(plain) < len(self._text):
            place = len(plain)
            word = _WORD.match(self._text, place)
            if word is None:
                raise self._slip(place)
            if plain[-1:].isalnum() and word[0][0] not in "<>=!() \t\r\n":
                raise self._refused(word.span(), f'"{word[0]}" does not belong here', _JOINED)
            if word["joint"] is None:
                self._operands[place] = self._known(word)
                plain += "x".ljust(len(word[0]))
            else:
                plain += word[0] if word[0].strip() else " " * len(word[0])
        return plain

    def _slip(self, place: int) -> ConditionRefused:
        found = ((pattern.match(self._text, place), what, hint) for pattern, what, hint in _SLIPS)
        slip, what, hint = next((slip, what, hint) for slip, what, hint in found if slip)
        return self._refused(slip.span(), f'"{slip[0]}" is {what}', hint)

    def _known(self, word: "re.Match[str]") -> "re.Match[str]":
        name = word["name"]
        if name and name not in self._columns and name not in self._states:
            raise self._refused(word.span(), f"no column {name}", self._advice(name))
        return word

    def _misread(self, place: int, reason: str) -> ConditionRefused:
        """Return the error of a text that Python cannot join, at the place and for the reason that it says."""
        word = _WORD.match(self._text, place) if 0 <= place < len(self._text) else None
        if word is None:
            return self._refused((len(self._text),) * 2, "the end stands where a column or a number is needed")
        if "never closed" in reason:
            return self._refused(word.span(), "this parenthesis is not closed")
        if "unmatched" in reason:
            return self._refused(word.span(), "no parenthesis is open here")
        return self._refused(word.span(), f'"{word[0]}" does not belong here', "" if word["joint"] else _JOINED)

    def choose(self, node: ast.expr) -> Choose:
        """Return what chooses the rows for which a part of the condition holds."""
        match node:
            case ast.BoolOp():
                join = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
                parts = [self.choose(each) for each in node.values]
                return lambda rows: join.reduce([part(rows) for part in parts])
            case ast.UnaryOp():
                part = self.choose(node.operand)
                return lambda rows: ~part(rows)
            case ast.Compare():
                return self._compared(node)
            case ast.Name():
                return self._alone(self._side(node))
        raise self._refused(self._span(node), "no condition", _EXAMPLE)

    def _compared(self, node: ast.Compare) -> Choose:
        sides = [self._side(side) for side in (node.left, *node.comparators)]
        parts = [
            self._pair(left, operator, right) for left, operator, right in zip(sides, node.ops, sides[1:], strict=False)
        ]
        return lambda rows: np.logical_and.reduce([part(rows) for part in parts])

    def _side(self, node: ast.expr) -> "re.Match[str]":
        """Return a name or number that is known here."""
        if not isinstance(node, ast.Name):
            raise self._refused(self._span(node), "a condition stands where a column or a number is needed")
        side = self._operands[node.col_offset]
        name = side["name"]
        if name in self._columns and np.dtype(self._columns[name].dtype).kind == "U":
            hint = f'numbers are compared; ["{name}"][:] == "..." in Python compares texts'
            raise self._refused(side.span(), f"{name} holds texts", hint)
        return side

    def _advice(self, name: str) -> str:
        if name.lower() in {"and", "or", "not"}:
            return f"write {name.lower()}"
        if name in STATES:
            return "only junctions have states"
        if any(column.name == name for column in JUNCTIONS.columns):
            return f"this run has no {name}; it has {', '.join(self._columns)}"
        return did_you_mean(name, [*self._columns, *self._states])

    def _alone(self, side: "re.Match[str]") -> Choose:
        if side[0] in self._states:
            return self._in_state(side[0])
        if side["number"]:
            raise self._refused(side.span(), "a number by itself", _EXAMPLE)
        raise self._refused(side.span(), f"{side[0]} is compared with nothing", f"for instance: {side[0]} > 0")

    def _in_state(self, state: str) -> Choose:
        """Return what chooses the rows whose state has a bit, or, for complete, no bit at all."""
        self.named.add("state")
        bit = STATES[state]
        return lambda rows: (rows["state"] & bit) != 0 if bit else rows["state"] == 0

    def _pair(self, left: "re.Match[str]", operator: ast.cmpop, right: "re.Match[str]") -> Choose:
        span = left.start(), right.end()
        if self._states.keys() & {left[0], right[0]}:
            return self._state(left[0], operator, right[0], span)
        column = self._columns.get(left[0]) or self._columns.get(right[0])
        if column is None:
            raise self._refused(span, "neither side is a column")
        other = self._columns.get(right[0], column)
        if other.units != column.units:
            raise self._refused(span, f"{column.name} is in {column.units}, {other.name} in {other.units}")
        compare, one, two = COMPARISONS[type(operator)], self._value(left, column), self._value(right, column)
        return lambda rows: compare(one(rows), two(rows))

    def _state(self, left: str, operator: ast.cmpop, right: str, span: tuple[int, int]) -> Choose:
        state, other = (left, right) if left in self._states else (right, left)
        if other != "state":
            raise self._refused(span, f"{state} is a state", f"write {state}, or not {state}")
        if not isinstance(operator, ast.Eq | ast.NotEq):
            raise self._refused(span, "states have no order", f"write state == {state}")
        chosen = self._in_state(state)
        return chosen if isinstance(operator, ast.Eq) else lambda rows: ~chosen(rows)

    def _value(self, side: "re.Match[str]", column: Dataset) -> Callable[[Columns], Any]:
        name = side["name"]
        if name:
            self.named.add(name)
            return lambda rows: rows[name]
        unit = side["number"][len(side["digits"]) :].strip(" ")
        value = self._quantity(side, unit, column) if unit else float(side["digits"])
        if isinf(value):
            raise self._refused(side.span(), "too large a number")
        return lambda _: value

    def _quantity(self, side: "re.Match[str]", unit: str, column: Dataset) -> float:
        if unit in self._states or unit in self._columns:
            raise self._refused((side.end() - len(unit), side.end()), f'"{unit}" does not belong here', _JOINED)
        kind = next((kind for kind in KINDS if kind.unit == column.units), None)
        if kind is None:
            raise self._refused(side.span(), f"{column.name} has no unit", f"write {side['digits']}")
        try:
            return float(read_quantity(side[0], kind))
        except QuantityError as error:
            raise self._refused(side.span(), str(error), error.hint.replace('"', "")) from None

    def _span(self, node: ast.expr) -> tuple[int, int]:
        return node.col_offset, node.end_col_offset or len(self._text)

    def _refused(self, span: tuple[int, int], message: str, hint: str = "") -> ConditionRefused:
        """Return the error that shows the condition with carets below the wrong part."""
        start, end = span
        place = Place(source="--where", line=0, text=self._text, start=start, end=max(end, start + 1))
        return ConditionRefused(str(Problem(path=(), message=message, place=place, hint=hint)))
