"""Conditions on junctions: what they choose, and what is said where they cannot be read."""

import operator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rubnoise.analysis.where import DEEPEST, LONGEST, ConditionRefused, condition
from rubnoise.storage.schema import JUNCTIONS

ROWS: dict[str, Any] = {
    "junction": np.arange(6),
    "birth_distance": np.array([-1.0, 0.5, 999.0, 1000.0, 1500.0, 2500.0]),
    "diameter": np.array([4.0, 5.0, 6.0, 6.5, 7.0, 8.0]),
    "life_distance": np.array([8.0, 10.0, 12.0, 6.0, 14.0, 16.0]),
    "max_area": np.array([12.0, 19.0, 28.0, 33.0, 38.0, 50.0]),
    "shear_strength": np.array([250.0, 250.0, 249.0, 251.0, 250.0, 250.0]),
    "birth_time": np.array([-0.001, 0.0005, 0.999, 1.0, 1.5, 2.5]),
    "state": np.array([1, 0, 0, 4, 0, 2], dtype=np.uint8),
}

CHOSEN = {
    "diameter > 6": [3, 4, 5],
    "diameter>=6": [2, 3, 4, 5],
    "diameter > 6 um": [3, 4, 5],
    "diameter > 0.006 mm": [3, 4, 5],
    "diameter > 6um": [3, 4, 5],
    "diameter>6um and complete": [4],
    "6000 nm < diameter": [3, 4, 5],
    "diameter == 6": [2],
    "diameter != 6e0 µm": [0, 1, 3, 4, 5],
    "birth_distance < -5e-1": [0],
    "birth_distance >= 1.5 mm and (state == complete or not ended_early)": [4, 5],
    "0 < birth_distance < 1 mm": [1, 2],
    "birth_time <= 999 ms": [0, 1, 2],
    "max_area > 3e-5 mm^2": [3, 4, 5],
    "max_area > 3e-5 mm**2": [3, 4, 5],
    "shear_strength > 0.25 GPa": [3],
    "shear_strength > 250 N/mm^2": [3],
    "life_distance < diameter": [3],
    "complete": [1, 2, 4],
    "not complete": [0, 3, 5],
    "state != complete": [0, 3, 5],
    "alive_at_start == state": [0],
    "state == 4": [3],
    "state > 1 and state < 4": [5],
    "alive_at_start or alive_at_end": [0, 5],
    "junction == 2 or junction == 3 and diameter > 7": [2],
    "(junction == 2 or junction == 3) and diameter > 6": [3],
    "not junction < 3 and not not diameter < 8": [3, 4],
    "not(junction<3)and(diameter<7)": [3],
    "diameter\n  > 7": [5],
}


@pytest.mark.parametrize("text", CHOSEN)
def test_a_condition_chooses_its_rows(text: str) -> None:
    assert np.flatnonzero(condition(text).chosen(ROWS)).tolist() == CHOSEN[text]


def test_only_columns_that_are_named_are_needed() -> None:
    assert condition("diameter > 6 and (complete or birth_time < 3 s)").columns == {"diameter", "state", "birth_time"}


def test_a_state_is_a_bit_of_several() -> None:
    both = {"state": np.array([1, 2, 3], dtype=np.uint8)}
    assert condition("alive_at_start").chosen(both).tolist() == [True, False, True]
    assert condition("state == alive_at_end").chosen(both).tolist() == [False, True, True]
    assert condition("state == 3").chosen(both).tolist() == [False, False, True]


REFUSED = {
    "diametr > 6": ("no column diametr", "diametr", "did you mean diameter?"),
    "Diameter > 6": ("no column Diameter", "Diameter", "did you mean diameter?"),
    "diameter = 6": ('"=" is no comparison', "=", "equality is written =="),
    "diameter => 6": ('"=>" is no comparison', "=>", "the comparisons are < <= > >= == !="),
    "diameter <> 6": ('"<>" is no comparison', "<>", "the comparisons are < <= > >= == !="),
    "diameter > 6 mm^2": ('"mm^2" is the unit of an area, a length is needed', "6 mm^2", "right form: 6 um"),
    "diameter > 6 foo": (
        'unknown unit "foo"',
        "6 foo",
        "a length, time, mass, force or pressure, such as um, s, kg, N, MPa",
    ),
    "junction > 6 um": ("junction has no unit", "6 um", "write 6"),
    "diameter > 1,5 mm": ('"1,5" is no number', "1,5", "digits, with a dot before the decimals, as in 1234.5"),
    "diameter > .5": ('".5" is no number', ".5", "digits on both sides of the dot: 0.5"),
    "diameter > 6.": ('"6." is no number', "6.", "digits on both sides of the dot: 0.5"),
    "diameter > 1e999": ("too large a number", "1e999", ""),
    "diameter > \u22125": ('"\u2212" is not the minus sign of a number', "\u2212", "that is '-', U+002D"),
    "diameter > nan": ("no column nan", "nan", None),
    "diameter < 2*3": ('"*" is no part', "*", "there is no arithmetic; compare a column with a number"),
    "max_area > 30 um\u00b2": ('"\u00b2" is no part', "\u00b2", "powers in units are written ^2"),
    "diameter": ("diameter is compared with nothing", "diameter", "for instance: diameter > 0"),
    "6": ("a number by itself", "6", "for instance: diameter > 6 um"),
    "3 < 4": ("neither side is a column", "3 < 4", ""),
    "diameter < max_area": ("diameter is in um, max_area in um^2", "diameter < max_area", ""),
    "diameter >": ("the end stands where a column or a number is needed", "", ""),
    "diameter > > 6": ('">" stands where a column or a number is needed', ">", ""),
    "(diameter > 3": ("this parenthesis is not closed", "(", ""),
    "diameter > 3)": ("no parenthesis is open here", ")", ""),
    "()": ('")" stands where', ")", ""),
    "diameter > 3 AND complete": ('"AND" does not belong here', "AND", "write and"),
    "diameter > 3 complete": ('"complete" does not belong here', "complete", "conditions are joined by and, or"),
    "NOT complete": ("no column NOT", "NOT", "write not"),
    "diameter > 3 && complete": ('"&&" is no operator', "&&", "write and"),
    "!complete": ('"!" is no operator', "!", "write not"),
    "state < complete": ("states have no order", "<", "write state == complete"),
    "diameter == complete": ("complete is a state", "diameter == complete", "write complete, or not complete"),
    'diameter > "6"': ('""" is no part', '"', "names and states are written without quotation marks"),
    "": ("no condition", None, "for instance: diameter > 6 um"),
    "__import__('os')": ("no column __import__", "__import__", None),
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_cannot_be_read_is_shown_with_a_caret(text: str) -> None:
    message, marked, hint = REFUSED[text]
    with pytest.raises(ConditionRefused) as refused:
        condition(text)
    lines = str(refused.value).splitlines()
    assert lines[0].startswith(f"--where: error: {message}")
    if marked is not None:
        caret = lines[2]
        assert lines[1] == f"    {text}"
        start = caret.index("^")
        assert lines[1][start : start + caret.count("^")] == marked
    if hint is not None:
        assert lines[-1] == (f"    {hint}" if hint else lines[2])


def test_a_column_of_other_runs_is_told_apart_from_a_slip() -> None:
    bare = [column for column in JUNCTIONS.columns if column.needs is None]
    with pytest.raises(ConditionRefused, match="this run has no birth_time; it has junction, birth_distance"):
        condition("birth_time > 1 s", bare)


def test_length_and_depth_are_bounded() -> None:
    longest = "diameter > 1" + " " * (LONGEST - 12)
    deepest = "(" * DEEPEST + "complete" + ")" * DEEPEST
    assert condition(longest).columns == {"diameter"}
    assert condition(deepest).columns == {"state"}
    assert condition(f"{deepest} and {deepest}").columns == {"state"}
    for text in (f"{longest} ", f"({deepest})", "not " * (DEEPEST + 1) + "complete", "(" * LONGEST):
        with pytest.raises(ConditionRefused, match="more than"):
            condition(text)


def test_what_would_steer_a_terminal_is_escaped() -> None:
    with pytest.raises(ConditionRefused) as refused:
        condition("diameter > 6 \x1b[31m")
    assert "\x1b" not in str(refused.value)


OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq}
COLUMNS = ("birth_distance", "diameter", "life_distance", "max_area")
comparisons = st.tuples(
    st.sampled_from(COLUMNS), st.sampled_from(list(OPERATORS)), st.sampled_from([-1.0, 0.5, 6.0, 12.0, 1000.0])
)
trees = st.recursive(
    comparisons,
    lambda parts: st.one_of(
        st.tuples(st.just("not"), parts),
        st.tuples(st.sampled_from(["and", "or"]), parts, parts),
    ),
    max_leaves=8,
)


def _text(tree: Any) -> str:
    """Write a tree with no more parentheses than the rules of precedence ask for."""
    if tree[0] == "not":
        inner = _text(tree[1])
        return f"not ({inner})" if tree[1][0] in {"and", "or"} else f"not {inner}"
    if tree[0] == "or":
        return f"{_text(tree[1])} or {_text(tree[2])}"
    if tree[0] == "and":
        sides = (f"({_text(side)})" if side[0] == "or" else _text(side) for side in tree[1:])
        return " and ".join(sides)
    column, sign, value = tree
    return f"{column} {sign} {value!r}"


def _truth(tree: Any, row: int) -> bool:
    if tree[0] == "not":
        return not _truth(tree[1], row)
    if tree[0] in {"and", "or"}:
        first, second = _truth(tree[1], row), _truth(tree[2], row)
        return first and second if tree[0] == "and" else first or second
    column, sign, value = tree
    return bool(OPERATORS[sign](ROWS[column][row], value))


@given(trees)
def test_and_or_not_mean_what_they_mean_in_python(tree: Any) -> None:
    chosen = condition(_text(tree)).chosen(ROWS)
    assert chosen.tolist() == [_truth(tree, row) for row in range(6)]


@given(st.text(max_size=60) | st.text(alphabet="()<>=! 0123456789.eandorntdiameterum*/^", max_size=60))
def test_whatever_is_written_is_read_or_refused(text: str) -> None:
    with suppress(ConditionRefused):
        assert condition(text).columns <= {column.name for column in JUNCTIONS.columns}
