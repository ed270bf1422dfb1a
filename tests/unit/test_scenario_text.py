"""The text of a scenario: places of keys, how problems are shown, its schema, and what it may ask of its reader."""

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from rubnoise.scenario import json_schema
from rubnoise.scenario.document import SECTIONS, TOP
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.problems import Place, Problem
from rubnoise.scenario.sweep import load_either
from rubnoise.scenario.sweep_keys import Sweeping
from rubnoise.scenario.text import read_toml
from tests.unit.scenarios import WHOLE, refusal, whole

# The locator finds every key and value of a TOML text that has them line by line.
TEXT = """\
# a = 1
a = 1 # one
"b c".'d' = "x # y" # text
e.f . g = [1, 2, # three
  { h = "]" }, ]
i = { j = 'k', "l" = { m = 1.5 } }
o = 1979-05-27 07:32:00   # a date

[ q . "r" ] # header
s = true
"t" = 'raw " text'
"""


def shown(place: Place) -> str:
    return place.text[place.start : place.end]


@pytest.mark.parametrize(
    ("path", "text", "line"),
    [
        (("a",), "1", 2),
        (("b c", "d"), '"x # y"', 3),
        (("e", "f", "g"), "[1, 2,", 4),
        (("e", "f", "g", 1), "[1, 2,", 4),
        (("i",), "{ j = 'k', \"l\" = { m = 1.5 } }", 6),
        (("i", "l", "m"), "{ j = 'k', \"l\" = { m = 1.5 } }", 6),
        (("o",), "1979-05-27 07:32:00", 7),
        (("q", "r", "s"), "true", 10),
        (("q", "r", "t"), "'raw \" text'", 11),
        (("q", "r", "nothing"), 'q . "r"', 9),
    ],
)
def test_a_value_is_where_it_is(path: tuple[str | int, ...], text: str, line: int) -> None:
    place = read_toml("a.toml", TEXT).value_place(path)
    assert (shown(place), place.line) == (text, line)


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


def test_needed_keys_are_demanded_unless_another_file_may_have_them() -> None:
    schema = json_schema()
    assert schema["required"] == ["format"]
    assert schema["if"] == {"not": {"anyOf": [{"required": ["extends"]}, {"required": ["sweep"]}]}}
    assert schema["then"]["required"] == ["interface", "sliding"]
    assert schema["then"]["properties"]["sliding"] == {"required": ["distance"]}
    assert schema["then"]["dependentSchemas"]["slider"]["required"] == ["strength"]
    assert not any("required" in section for section in schema["$defs"].values())


@pytest.mark.parametrize("path", sorted(SCENARIOS.rglob("*.toml")), ids=lambda path: path.stem)
def test_a_scenario_of_the_project_names_its_schema_and_loads_without_a_warning(path: Path) -> None:
    first = path.read_text(encoding="utf-8").splitlines()[0]
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == SCENARIOS / "scenario.schema.json"
    assert load_either(path).warnings == ()
    assert set(tomllib.loads(path.read_text(encoding="utf-8"))) <= {*TOP, *SECTIONS, "extends", "sweep"}


def test_the_schema_of_a_sweep_takes_lists_of_what_each_key_takes() -> None:
    schema = json_schema()
    sweep = schema["properties"]["sweep"]["properties"]
    assert set(sweep) == {*keys_of(Sweeping), "grid", "zip"}
    for table in (sweep["grid"], sweep["zip"]):
        swept = {
            f"{name}.{key}": about
            for name, keys in table["properties"].items()
            for key, about in keys["properties"].items()
        }
        assert set(swept) == {f"{name}.{key}" for name, section in SECTIONS.items() for key in keys_of(section)} - {
            "run.seed"
        }
        for about in swept.values():
            *_, section, properties, key = about["items"]["$ref"].split("/")
            assert schema["$defs"][section][properties][key]
