"""Conditions on junctions, as in ``diameter > 6 um and not (ended_early or birth_distance < 1 mm)``.

Columns, numbers with units, and states are joined by < <= > >= == !=, and, or, not and parentheses, as Python joins
them. A number without a unit is in the unit of the column it is compared with. A state (complete, alive_at_start,
alive_at_end, ended_early) by itself, or after ``state ==``, chooses the rows that have it; a row may have several.
Python's own parser reads the text; nothing is evaluated by it, and other forms are refused.
"""

import ast
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import isinf
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused, did_you_mean
from rubnoise.record.rows import Columns
from rubnoise.scenario.text import Place, Problem
from rubnoise.storage.schema import JUNCTIONS, Dataset
from rubnoise.units import KINDS, NUMBER, QuantityError, read_quantity

LONGEST: Final = 1000  # characters of a condition: no person writes a longer one
STATES: Final = {"complete": 0} | {name: bit for column in JUNCTIONS.columns for bit, name in column.codes}
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
_FACTOR: Final = r"(?!(?:and|or|not)\b)[A-Za-z\u00b5\u03bc%][A-Za-z0-9\u00b5\u03bc%]*+(?:(?:\^|\*\*)-?[0-9]++)?(?!\w)"
_QUANTITY: Final = re.compile(
    rf"(?<![\w.])(?P<digits>{NUMBER})(?![0-9.,_])(?P<unit>(?: *{_FACTOR}(?: ?[*/] ?{_FACTOR})*)?)", re.IGNORECASE
)
_JOINED: Final = "comparisons are < <= > >= == !=, joined by and, or, not"
_EXAMPLE: Final = "for instance: diameter > 6 um and not ended_early"


class ConditionRefused(Refused):
    """A condition on junctions is not valid; its message shows the place."""


def advice(word: str, columns: Sequence[str], states: Iterable[str] = ()) -> str:
    """Return advice for an unknown word: why it is unknown, the names like it or that contain it, or all names."""
    known = [*columns, *states]
    if word in STATES:
        return "only junctions have states"
    if any(column.name == word for column in JUNCTIONS.columns):
        return f"this run has {', '.join(columns)}"
    holding = [name for name in known if len(word) > 2 and word.lower() in name]
    return did_you_mean(word, known, holding) or f"one of {', '.join(known)}"


class Condition:
    """A condition that a text writes about rows with some columns: ``chosen`` chooses rows, and needs ``columns``.

    Raises ConditionRefused, with how it was ``said``, the text and a caret below the wrong part, if it is not valid.
    """

    def __init__(self, text: str, columns: Sequence[Dataset] = JUNCTIONS.columns, said: str = "--where") -> None:
        if len(text) > LONGEST:
            raise ConditionRefused(f"{said}: error: a condition of more than {LONGEST} characters")
        self._text, self._said = text.strip(), said
        self._known = {column.name: column for column in columns}
        self._states = STATES if any(column.name == "state" and column.codes for column in columns) else {}
        self._numbers = {found.start(): found for found in _QUANTITY.finditer(self._text)}
        self.columns: set[str] = set()
        self._tree = self._parsed()
        self.chosen({column.name: np.zeros(0, column.dtype) for column in columns})  # which refuses what is wrong

    def chosen(self, rows: Columns) -> NDArray[np.bool_]:
        """Return for each row whether it is chosen."""
        return self._holds(self._tree, rows)

    def _parsed(self) -> ast.expr:
        """Return how Python joins the parts; each number is a name of its length, so that all places stay."""
        if not self._text:
            raise self._refused((0, 1), "no condition", _EXAMPLE)
        plain = re.sub(r"\s", " ", _QUANTITY.sub(lambda found: "_".ljust(len(found[0])), self._text))
        if (odd := re.search(r"[^ -~]", plain)) is not None:
            raise self._refused(
                odd.span(), f'"{odd[0]}" is no part of a condition', "write -5 and um^2 with the signs of a keyboard"
            )
        try:
            return ast.parse(plain, mode="eval").body
        except SyntaxError as error:
            place = min(max((error.offset or 1) - 1, 0), len(plain))
            stop = place + 1 if (error.end_offset or 0) <= place else (error.end_offset or 0) - 1
            raise self._refused((place, stop), f"Python reads: {error.msg}", _JOINED) from None
        except (RecursionError, MemoryError):
            raise self._refused((0, len(plain)), "too many levels") from None

    def _holds(self, node: ast.expr, rows: Columns) -> NDArray[np.bool_]:
        """Return for each row whether a part of the condition holds."""
        match node:
            case ast.BoolOp():
                join = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
                return join.reduce([self._holds(each, rows) for each in node.values])
            case ast.UnaryOp(op=ast.Not()):
                return ~self._holds(node.operand, rows)
            case ast.Compare():
                sides = zip([node.left, *node.comparators], node.ops, node.comparators, strict=False)
                return np.logical_and.reduce([self._pair(*each, rows) for each in sides])
            case ast.Name() if node.id in self._states:
                return self._in_state(node.id, rows)
        name = self._name(node)  # which refuses what is no name and no number
        hint = f"for instance: {name} > 0" if name in self._known else _EXAMPLE
        raise self._refused(_span(node), "nothing is compared", hint)

    def _name(self, node: ast.expr) -> str:
        """Return the name of a column or a state, "" for a number; raises ConditionRefused for anything else."""
        if not isinstance(node, ast.Name | ast.Attribute):
            raise self._refused(_span(node), "neither a column nor a number", _EXAMPLE)
        if node.col_offset in self._numbers:
            return ""
        name = ast.unparse(node)
        if name not in self._known and name not in self._states:
            raise self._refused(_span(node), f"no column {name}", advice(name, [*self._known], self._states))
        if name in self._known and np.dtype(self._known[name].dtype).kind == "U":
            hint = f'numbers are compared; ["{name}"][:] == "..." in Python compares texts'
            raise self._refused(_span(node), f"{name} holds texts", hint)
        return name

    def _in_state(self, state: str, rows: Columns) -> NDArray[np.bool_]:
        """Return for each row whether its state has a bit, or, for complete, no bit at all."""
        self.columns.add("state")
        bit = STATES[state]
        return (rows["state"] & bit) != 0 if bit else rows["state"] == 0

    def _pair(self, left: ast.expr, operator: ast.cmpop, right: ast.expr, rows: Columns) -> NDArray[np.bool_]:
        names, span = [self._name(side) for side in (left, right)], (_span(left)[0], _span(right)[1])
        if type(operator) not in COMPARISONS:
            raise self._refused(span, "no comparison", _JOINED)
        if states := [name for name in names if name in self._states]:
            if "state" not in names or not isinstance(operator, ast.Eq | ast.NotEq):
                hint = f"write {states[0]}, not {states[0]}, or state == {states[0]}"
                raise self._refused(span, f"{states[0]} is a state, which has no order", hint)
            return self._in_state(states[0], rows) == isinstance(operator, ast.Eq)
        known = [self._known[name] for name in names if name]
        if not known:
            raise self._refused(span, "neither side is a column")
        if known[0].units != known[-1].units:
            raise self._refused(span, f"{known[0].name} is in {known[0].units}, {known[-1].name} in {known[-1].units}")
        self.columns.update(each.name for each in known)
        one, two = (self._value(*each, known[0], rows) for each in zip((left, right), names, strict=True))
        return np.asarray(COMPARISONS[type(operator)](one, two))

    def _value(self, node: ast.expr, name: str, column: Dataset, rows: Columns) -> NDArray[Any] | float:
        """Return the values of a side: those of a column, or a number in the unit of the column beside it."""
        if name:
            return rows[name]
        found = self._numbers[node.col_offset]
        kind = next((kind for kind in KINDS if kind.unit == column.units), None)
        if found["unit"] and kind is None:
            raise self._refused(found.span(), f"{column.name} has no unit", f"write {found['digits']}")
        try:
            value = float(read_quantity(found[0], kind)) if found["unit"] and kind else float(found["digits"])
        except QuantityError as error:
            raise self._refused(found.span(), str(error), error.hint.replace('"', "")) from None
        if isinf(value):
            raise self._refused(found.span(), "too large a number")
        return value

    def _refused(self, span: tuple[int, int], message: str, hint: str = "") -> ConditionRefused:
        """Return the error that shows the condition with carets below the wrong part."""
        start, end = span
        place = Place(source=self._said, line=0, text=self._text, start=start, end=max(end, start + 1))
        return ConditionRefused(str(Problem(path=(), message=message, place=place, hint=hint)))


def _span(node: ast.expr) -> tuple[int, int]:
    return node.col_offset, node.end_col_offset or node.col_offset + 1
