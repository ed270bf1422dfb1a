"""How problems are shown: in order, with the line and a caret, and nothing that a terminal would obey."""

from dataclasses import replace

from rubnoise.scenario.problems import Place, Problem, in_order, report
from tests.unit.scenarios import WHOLE, refusal, whole


def problem(text: str, start: int, end: int, **changes: object) -> Problem:
    place = Place(source="a.toml", line=3, text=text, start=start, end=end)
    return replace(Problem(path=("a", "b"), message="wrong", place=place), **changes)  # type: ignore[arg-type]


def test_a_problem_shows_line_caret_and_hint() -> None:
    shown = str(problem("b = 12 # x", 4, 6, hint="write 13"))
    assert shown == "a.toml:3: error: a.b: wrong\n    b = 12 # x\n        ^^\n    write 13"


def test_an_empty_line_is_not_shown() -> None:
    assert str(problem("", 0, 0)) == "a.toml:3: error: a.b: wrong"


def test_carets_stand_below_what_they_mark_after_wide_and_escaped_characters() -> None:
    lines = str(problem("\t\u6f22\u001b = 12", 6, 8)).splitlines()
    assert lines[1:] == ["     \u6f22\\x1b = 12", " " * 4 + " " * 10 + "^^"]


def test_a_long_line_is_cropped_around_the_caret() -> None:
    lines = str(problem("x" * 400 + "12" + "y" * 400, 400, 402)).splitlines()
    assert lines[1] == "    ..." + "x" * 50 + "12" + "y" * 48 + "..."
    assert lines[2].index("^") == lines[1].index("12")
    assert lines[2].count("^") == 2


def test_nothing_that_a_terminal_would_obey_is_shown() -> None:
    nasty = '"20 \u202emm" # \u202e \x7f'
    shown = refusal(whole(distance=nasty)) + refusal(WHOLE.replace("mass", '"ma\\u001b[31mss"'))
    assert shown.replace("\n", "").isprintable()
    assert "\\u202e" in shown
    assert "slider.ma\\x1b[31mss: unknown key" in shown


def test_problems_come_by_source_line_and_column_and_once() -> None:
    first, second = problem("b = 12", 4, 6), problem("b = 12", 0, 1)
    later = replace(first, place=replace(first.place, rank=1, line=1))
    assert in_order([later, first, second, first]) == (second, first, later)
    assert report([first, second]) == f"{second}\n{first}"


def test_a_warning_about_a_wrong_key_is_left_out() -> None:
    error, warning = problem("b = 12", 4, 6), problem("b = 12", 4, 6, severity="warning")
    assert in_order([warning, error]) == (error,)
    assert "warning: a.b: wrong" in report([warning])
