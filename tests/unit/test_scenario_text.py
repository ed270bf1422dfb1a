"""The text of a scenario: places of keys, how problems are shown, its schema, and what it may ask of its reader."""

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from rubnoise.scenario.document import SECTIONS, TOP
from rubnoise.scenario.sweep import load_either
from rubnoise.scenario.text import Place, Problem, read_toml
from tests.unit.scenarios import WHOLE, refusal, whole


def shown(place: Place) -> str:
    return place.text[place.start : place.end]


@pytest.mark.parametrize("broken", ["a = 1\nb d = 2\nc = 3", "a = 1\n= 2\nc = 3", 'a = 1\n"\\q" = 2\nc = 3'])
def test_of_a_broken_text_the_other_lines_are_read(broken: str) -> None:
    source = read_toml("a.toml", broken)
    assert source.data == {"a": 1, "c": 3}
    assert [problem.place.line for problem in source.problems] == [2]


# How problems are shown: in order, with the line and a caret, and nothing that a terminal would obey.
def problem(text: str, start: int, end: int, **changes: object) -> Problem:
    place = Place(source="a.toml", line=3, text=text, start=start, end=end)
    return replace(Problem(path=("a", "b"), message="wrong", place=place), **changes)  # type: ignore[arg-type]


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


# What a scenario may ask of its reader: deep keys, readings of a broken text, files in a chain.
@pytest.mark.parametrize("text", ["x" + ".a" * 490 + " = 1", "x = " + "[" * 900, 'x = """\n' + '"" ' * 300])
def test_no_line_takes_long(text: str) -> None:
    assert len(read_toml("a.toml", f"{text}\n" * 60).problems) >= 1


# The schema on file is the schema of the code, and says what is available and needed.
SCENARIOS = Path(__file__).parents[2] / "scenarios"


@pytest.mark.parametrize("path", sorted(SCENARIOS.rglob("*.toml")), ids=lambda path: path.stem)
def test_a_scenario_of_the_project_names_its_schema_and_loads_without_a_warning(path: Path) -> None:
    first = path.read_text(encoding="utf-8").splitlines()[0]
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == SCENARIOS / "scenario.schema.json"
    assert load_either(path).warnings == ()
    assert set(tomllib.loads(path.read_text(encoding="utf-8"))) <= {*TOP, *SECTIONS, "extends", "sweep"}
