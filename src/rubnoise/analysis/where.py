"""Conditions on junctions, as in ``diameter > 6 um and not (ended_early or birth_distance < 1 mm)``.

    condition  = conjunction { "or" conjunction }
    conjunction = negation { "and" negation }
    negation   = "not" negation | "(" condition ")" | comparison
    comparison = side { ("<" | "<=" | ">" | ">=" | "==" | "!=") side } | STATE
    side       = COLUMN | NUMBER [UNIT] | STATE

A number without a unit is in the unit of the column it is compared with. ``0 < birth_distance < 1 mm`` is both of its
comparisons. A state (complete, alive_at_start, alive_at_end, ended_early) by itself, or after ``state ==``, chooses
the rows that have it; a row may have several. Python's own ``eval`` is never used.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import isinf
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused
from rubnoise.record.sink import Columns
from rubnoise.scenario.problems import Place, Problem
from rubnoise.storage.schema import JUNCTIONS, Dataset
from rubnoise.units import KINDS, NUMBER, QuantityError, read_quantity

Sort = Literal["name", "number", "comparison", "and", "or", "not", "(", ")", "end"]

LONGEST: Final = 1000
"""Most characters of a condition: no person writes a longer one."""

KEYWORDS: Final = ("and", "or", "not")
_FACTOR: Final = (
    r"(?!(?:and|or|not)\b)[A-Za-z\u00b5\u03bc%][A-Za-z0-9\u00b5\u03bc%]*+(?:(?:\^|\*\*)-?[0-9]++)?(?![A-Za-z0-9_])"
)
_UNIT: Final = rf"{_FACTOR}(?: ?[*/] ?{_FACTOR})*"
_PATTERN: Final = re.compile(
    rf"[ \t\r\n]*(?:"
    rf"(?P<number>(?P<bare>{NUMBER})(?![0-9.,_])(?: *{_UNIT})?)"
    rf"|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*)"  # keys of a sweep have dots
    rf"|(?P<comparison><=|>=|==|!=|<(?!>)|>(?!<))"
    rf"|(?P<bracket>[()])"
    rf"|(?P<end>$))",
    re.IGNORECASE,  # a shouted AND is no unit, and the message says how it is written
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
)


class ConditionRefused(Refused):
    """A condition on junctions is not valid; its message shows the place."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Token:
    """One word of a condition, its place (from 0), and the length of its digits if it is a number."""

    sort: Sort
    text: str
    start: int
    digits: int = 0

    @property
    def end(self) -> int:
        """The place after its last character."""
        return self.start + len(self.text)


def refusal(text: str, start: int, end: int, message: str, hint: str = "") -> ConditionRefused:
    """Return the error that shows a condition with carets below the wrong part."""
    place = Place(source="--where", line=0, text=text, start=start, end=max(end, start + 1))
    return ConditionRefused(str(Problem(path=(), message=message, place=place, hint=hint)))


def tokens(text: str) -> Iterator[Token]:
    """Yield the words of a condition, the last of kind ``end``; raises ConditionRefused at the first invalid one."""
    if len(text) > LONGEST:
        raise ConditionRefused(f"--where: error: a condition of more than {LONGEST} characters")
    position = 0
    while True:
        found = _PATTERN.match(text, position)
        if found is None:
            raise _not_a_word(text, position)
        token = _token(found)
        yield token
        if token.sort == "end":
            return
        position = found.end()


def _token(found: "re.Match[str]") -> Token:
    kind = str(found.lastgroup if found.lastgroup != "bare" else "number")
    word, start = found[kind], found.start(kind)
    if kind == "number":
        return Token(sort="number", text=word, start=start, digits=len(found["bare"]))
    if kind == "comparison":
        return Token(sort="comparison", text=word, start=start)
    if kind == "end":
        return Token(sort="end", text="", start=start)
    return Token(sort=_sort_of(word), text=word, start=start)


def _sort_of(word: str) -> Sort:
    for sort in ("and", "or", "not", "(", ")"):
        if word == sort:
            return sort
    return "name"


def _not_a_word(text: str, position: int) -> ConditionRefused:
    start = position + len(text[position:]) - len(text[position:].lstrip(" \t\r\n"))
    for pattern, what, hint in _SLIPS:
        if slip := pattern.match(text, start):
            return refusal(text, start, slip.end(), f'"{slip[0]}" is {what}', hint)
    return refusal(text, start, start + 1, f'"{text[start]}" is no part of a condition')


DEEPEST: Final = 50
"""Levels of parentheses and ``not`` in a condition."""

_JOINED: Final = "conditions are joined by and, or"

STATES: Final = {"complete": 0} | {
    name: bit for column in JUNCTIONS.columns if column.name == "state" for bit, name in column.flags
}


Choose = Callable[[Columns], NDArray[np.bool_]]
"""Returns for each row whether it is chosen, from the columns by name."""

COMPARISONS: Final[Mapping[str, Callable[[Any, Any], Any]]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """A function that chooses rows, and the names of the columns that it needs."""

    columns: frozenset[str]
    chosen: Choose


def condition(text: str, columns: Sequence[Dataset] = JUNCTIONS.columns) -> Condition:
    """Return the condition that a text writes about rows with these columns.

    Raises ConditionRefused, with the text and a caret below the wrong part, if it is not valid.
    """
    reader = _Reader(text, columns)
    chosen = reader.whole()
    return Condition(columns=frozenset(reader.named), chosen=chosen)


def did_you_mean(word: str, names: Iterable[str]) -> str:
    """Return advice for an unknown word: the nearest name, the names that contain it, or all names."""
    known = list(names)
    holding = [name for name in known if len(word) > 2 and word.lower() in name]
    near = holding or get_close_matches(word.lower(), known, n=1)
    return f"did you mean {' or '.join(near)}?" if near else f"one of {', '.join(known)}"


class _Reader:
    """Parser of a condition, from left to right, one word ahead; ``named`` are the columns found so far."""

    def __init__(self, text: str, columns: Sequence[Dataset]) -> None:
        self._text = text
        self._columns = {column.name: column for column in columns}
        self._states = STATES if any(column.name == "state" and column.flags for column in columns) else {}
        self._tokens = tokens(text)
        self._next = next(self._tokens)
        self._depth = 0
        self.named: set[str] = set()

    def whole(self) -> Choose:
        if self._next.sort == "end":
            raise refusal(self._text, 0, 1, "no condition", "for instance: diameter > 6 um")
        node = self._condition()
        rest = self._next
        if rest.sort == ")":
            raise self._refused(rest, "no parenthesis is open here")
        if rest.sort != "end":
            raise self._not_going_on()
        return node

    def _condition(self) -> Choose:
        parts = [self._conjunction()]
        while self._next.sort == "or":
            self._take()
            parts.append(self._conjunction())
        return _joined(np.logical_or, parts)

    def _conjunction(self) -> Choose:
        parts = [self._negation()]
        while self._next.sort == "and":
            self._take()
            parts.append(self._negation())
        return _joined(np.logical_and, parts)

    def _negation(self) -> Choose:
        if self._next.sort not in {"not", "("}:
            return self._comparison()
        opening = self._take()
        self._depth += 1
        if self._depth > DEEPEST:
            raise self._refused(opening, f"more than {DEEPEST} levels of parentheses and not")
        node = _opposite(self._negation()) if opening.sort == "not" else self._in_parentheses(opening)
        self._depth -= 1
        return node

    def _in_parentheses(self, opening: Token) -> Choose:
        node = self._condition()
        if self._next.sort == "end":
            raise self._refused(opening, "this parenthesis is not closed")
        if self._next.sort != ")":
            raise self._not_going_on()
        self._take()
        return node

    def _comparison(self) -> Choose:
        left = self._side()
        if self._next.sort != "comparison":
            return self._alone(left)
        parts: list[Choose] = []
        while self._next.sort == "comparison":
            operator = self._take()
            right = self._side()
            parts.append(self._compared(left, operator, right))
            left = right
        return _joined(np.logical_and, parts)

    def _side(self) -> Token:
        token = self._take()
        if token.sort == "number":
            return token
        if token.sort != "name":
            found = f'"{token.text}"' if token.text else "the end"
            raise self._refused(token, f"{found} stands where a column or a number is needed")
        if token.text not in self._columns and token.text not in self._states:
            known = [*self._columns, *self._states]
            raise self._refused(token, f"no column {token.text}", self._advice(token.text, known))
        if token.text in self._columns and np.dtype(self._columns[token.text].dtype).kind == "U":
            hint = f'numbers are compared; ["{token.text}"][:] == "..." in Python compares texts'
            raise self._refused(token, f"{token.text} holds texts", hint)
        return token

    def _not_going_on(self) -> ConditionRefused:
        word = self._next.text.lower()
        hint = f"write {word}" if word in KEYWORDS else _JOINED
        return self._refused(self._next, f'"{self._next.text}" does not belong here', hint)

    def _advice(self, word: str, known: list[str]) -> str:
        if word.lower() in KEYWORDS:
            return f"write {word.lower()}"
        if word in STATES:
            return "only junctions have states"
        if any(column.name == word for column in JUNCTIONS.columns):
            return f"this run has no {word}; it has {', '.join(self._columns)}"
        return did_you_mean(word, known)

    def _alone(self, token: Token) -> Choose:
        if token.text in self._states:
            return self._in_state(token)
        if token.sort == "number":
            raise self._refused(token, "a number by itself", "for instance: diameter > 6 um")
        raise self._refused(token, f"{token.text} is compared with nothing", f"for instance: {token.text} > 0")

    def _compared(self, left: Token, operator: Token, right: Token) -> Choose:
        if self._states.keys() & {left.text, right.text}:
            return self._state(left, operator, right)
        column = next((self._columns[side.text] for side in (left, right) if side.sort == "name"), None)
        if column is None:
            raise self._refused_span(left, right, "neither side is a column")
        other = self._columns.get(right.text, column)
        if other.units != column.units:
            message = f"{column.name} is in {column.units}, {other.name} in {other.units}"
            raise self._refused_span(left, right, message)
        compare, one, two = COMPARISONS[operator.text], self._value(left, column), self._value(right, column)
        return lambda rows: compare(one(rows), two(rows))

    def _state(self, left: Token, operator: Token, right: Token) -> Choose:
        word, other = (left, right) if left.text in self._states else (right, left)
        if other.text != "state":
            raise self._refused_span(left, right, f"{word.text} is a state", f"write {word.text}, or not {word.text}")
        if operator.text not in {"==", "!="}:
            raise self._refused(operator, "states have no order", f"write state == {word.text}")
        chosen = self._in_state(word)
        return chosen if operator.text == "==" else _opposite(chosen)

    def _in_state(self, word: Token) -> Choose:
        """Return a function that chooses the rows whose state has a bit, or, for complete, no bit at all."""
        self.named.add("state")
        bit = STATES[word.text]
        return lambda rows: (rows["state"] & bit) != 0 if bit else rows["state"] == 0

    def _value(self, side: Token, column: Dataset) -> Callable[[Columns], Any]:
        if side.sort == "name":
            self.named.add(side.text)
            return lambda rows: rows[side.text]
        value = float(side.text) if side.digits == len(side.text) else self._quantity(side, column)
        if isinf(value):
            raise self._refused(side, "too large a number")
        return lambda _: value

    def _quantity(self, side: Token, column: Dataset) -> float:
        unit = side.text[side.digits :].strip(" ")
        if unit in self._states or unit in self._columns:
            raise refusal(self._text, side.end - len(unit), side.end, f'"{unit}" does not belong here', _JOINED)
        kind = next((kind for kind in KINDS if kind.unit == column.units), None)
        if kind is None:
            raise self._refused(side, f"{column.name} has no unit", f"write {side.text[: side.digits]}")
        try:
            return float(read_quantity(side.text, kind))
        except QuantityError as error:
            raise self._refused(side, str(error), error.hint.replace('"', "")) from None

    def _take(self) -> Token:
        token = self._next
        if token.sort != "end":
            self._next = next(self._tokens)
        return token

    def _refused(self, token: Token, message: str, hint: str = "") -> ConditionRefused:
        return refusal(self._text, token.start, token.end, message, hint)

    def _refused_span(self, first: Token, last: Token, message: str, hint: str = "") -> ConditionRefused:
        return refusal(self._text, first.start, last.end, message, hint)


def _joined(join: np.ufunc, parts: Sequence[Choose]) -> Choose:
    return parts[0] if len(parts) == 1 else lambda rows: join.reduce([part(rows) for part in parts])


def _opposite(part: Choose) -> Choose:
    return lambda rows: ~part(rows)
