"""The words of a condition on junctions: columns, states, numbers with units, comparisons, and/or/not, parentheses."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

from rubnoise.errors import Refused
from rubnoise.scenario.problems import Place, Problem
from rubnoise.units import NUMBER

Sort = Literal["name", "number", "comparison", "and", "or", "not", "(", ")", "end"]

LONGEST: Final = 1000
"""Characters of a condition: more is no condition that anybody has written."""

KEYWORDS: Final = ("and", "or", "not")
_FACTOR: Final = (
    r"(?!(?:and|or|not)\b)[A-Za-z\u00b5\u03bc%][A-Za-z0-9\u00b5\u03bc%]*+(?:(?:\^|\*\*)-?[0-9]++)?(?![A-Za-z0-9_])"
)
_UNIT: Final = rf"{_FACTOR}(?: ?[*/] ?{_FACTOR})*"
_PATTERN: Final = re.compile(
    rf"[ \t\r\n]*(?:"
    rf"(?P<number>(?P<bare>{NUMBER})(?![0-9.,_])(?: *{_UNIT})?)"
    rf"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    rf"|(?P<comparison><=|>=|==|!=|<(?!>)|>(?!<))"
    rf"|(?P<bracket>[()])"
    rf"|(?P<end>$))",
    re.IGNORECASE,  # a shouted AND is no unit, and is then told how it is written
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
    """A condition on junctions that cannot be understood; its message shows where."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Token:
    """One word of a condition, where it stands (from 0), and of a number the length of its digits."""

    sort: Sort
    text: str
    start: int
    digits: int = 0

    @property
    def end(self) -> int:
        """The place behind its last character."""
        return self.start + len(self.text)


def refusal(text: str, start: int, end: int, message: str, hint: str = "") -> ConditionRefused:
    """Return the error that shows a condition with carets below the part it is about."""
    place = Place(source="--where", line=0, text=text, start=start, end=max(end, start + 1))
    return ConditionRefused(str(Problem(path=(), message=message, place=place, hint=hint)))


def tokens(text: str) -> Iterator[Token]:
    """Yield the words of a condition, the last of sort ``end``; raises ConditionRefused at the first that is none."""
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
