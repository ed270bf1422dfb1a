"""The text of a scenario: places of keys, how problems are shown, its schema, and what it may ask of its reader."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from rubnoise.contact.laws import LAWS
from rubnoise.scenario import json_schema, load, loads
from rubnoise.scenario.document import SECTIONS, TOP
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.problems import Place, Problem, in_order, report
from rubnoise.scenario.sweep import load_either
from rubnoise.scenario.sweep_keys import Sweeping
from rubnoise.scenario.text import SYNTAX_ERRORS, read_toml
from tests.unit.scenarios import BARE, WHOLE, refusal, whole

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


def test_a_key_is_where_it_is_first_named() -> None:
    source = read_toml("a.toml", TEXT + '["b c"]\ne = 1\n')
    assert [shown(source.key_place(path)) for path in (("q", "r"), ("e", "f"), ("b c",))] == [
        'q . "r"',
        "e.f . g",
        "\"b c\".'d'",
    ]


@pytest.mark.parametrize("broken", ["a = 1\nb d = 2\nc = 3", "a = 1\n= 2\nc = 3", 'a = 1\n"\\q" = 2\nc = 3'])
def test_of_a_broken_text_the_other_lines_are_read(broken: str) -> None:
    source = read_toml("a.toml", broken)
    assert source.data == {"a": 1, "c": 3}
    assert [problem.place.line for problem in source.problems] == [2]


def test_without_a_sound_header_nothing_is_blamed_on_the_wrong_table() -> None:
    source = read_toml("a.toml", "a = 1\n[b\nc = 3")
    assert (source.data, len(source.problems)) == ({}, 1)


# How problems are shown: in order, with the line and a caret, and nothing that a terminal would obey.
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


# What a scenario may ask of its reader: deep keys, readings of a broken text, files in a chain.
@pytest.mark.parametrize("text", ["x" + ".a" * 490 + " = 1", "x = " + "[" * 900, 'x = """\n' + '"" ' * 300])
def test_no_line_takes_long(text: str) -> None:
    assert len(read_toml("a.toml", f"{text}\n" * 60).problems) >= 1


@pytest.mark.parametrize(
    "line",
    [
        "# a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a",
        'title = "a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a"',
        "title = 'a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a' # 'a.a",
        'title = """a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a ""."" """',
        "title = '''a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a'''",
    ],
)
def test_dots_elsewhere_are_no_parts(line: str) -> None:
    assert loads(BARE.replace("format = 1\n", f"format = 1\n{line}\n")).title.count("a") in {0, 21}


@pytest.mark.parametrize(("lines", "named"), [(19, 19), (40, SYNTAX_ERRORS)])
def test_a_text_is_read_until_every_broken_line_is_named_or_there_are_many(lines: int, named: int) -> None:
    found = read_toml("a.toml", "\n".join(f"x{number} = 1,5 mm" for number in range(lines))).problems
    assert {problem.hint for problem in found} == {'write "1.5 mm"'}
    assert len(found) == named


def test_a_key_that_is_given_twice_names_the_first() -> None:
    lines = [f'"k{number}" = 1' for number in range(400)] + ['"k1" = 1'] * 19
    found = read_toml("a.toml", "\n".join(lines)).problems
    assert {problem.hint for problem in found} == {"first given in line 2; keep one of the two"}


# The schema on file is the schema of the code, and says what is available and needed.
SCENARIOS = Path(__file__).parents[2] / "scenarios"


def test_the_schema_on_file_is_that_of_the_code() -> None:
    on_file = json.loads((SCENARIOS / "scenario.schema.json").read_text(encoding="utf-8"))
    assert on_file == json_schema(), "rubnoise schema > scenarios/scenario.schema.json"


def test_every_key_is_described() -> None:
    for name, section in json_schema()["$defs"].items():
        assert section["additionalProperties"] is False, name
        assert all(about["description"] for about in section["properties"].values())


def test_the_schema_offers_what_is_available_and_no_more() -> None:
    sections = json_schema()["$defs"]
    assert sections["Diameter"]["properties"]["law"]["enum"] == list(LAWS)
    assert sections["Run"]["properties"]["engine"]["enum"] == ["events", "batch"]


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


def test_the_papers_figure_5_has_the_papers_numbers() -> None:
    model = load(SCENARIOS / "paper" / "fig5.toml").model()
    assert model.calibrated_diameter == pytest.approx(5.5300126, abs=5e-8)
    assert model.stationary_mean_area == pytest.approx(204.6736, abs=5e-5)
    assert model.equilibrium_displacement == pytest.approx(170.561, abs=5e-4)
    assert model.slider is not None
    assert model.slider.natural_frequency == pytest.approx(38.985, abs=5e-4)
    assert model.slider.damping_ratio == pytest.approx(0.02041, abs=5e-6)
    assert (model.distance, model.tick, model.tick_count) == (20_000.0, 0.1, 200_000)


def test_the_scenarios_of_figure_6_differ_in_the_number_of_junctions_and_are_runs_of_their_own() -> None:
    models = [load(SCENARIOS / "paper" / f"fig6_n{n}.toml").resolved() for n in (10, 20, 30, 40, 50)]
    counts = [model["interface"].pop("mean_junction_count") for model in models]
    titles = {model.pop("title") for model in models}
    seeds = {model["run"].pop("seed") for model in models}
    assert counts == [10, 20, 30, 40, 50]
    assert len(seeds) == 5
    assert len(titles) == 5
    assert all(model == models[0] for model in models)
