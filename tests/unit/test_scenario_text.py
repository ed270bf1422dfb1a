"""The text of a scenario: places of keys, how problems are shown, its schema, and what it may ask of its reader."""

import json
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from rubnoise.contact.laws import LAWS
from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import json_schema, limits, load, loads
from rubnoise.scenario.document import Document
from rubnoise.scenario.keys import SECTIONS
from rubnoise.scenario.problems import Place, Problem, in_order, report
from rubnoise.scenario.source import locate, parse
from rubnoise.scenario.sweep import load_either
from rubnoise.scenario.sweep_table import Sweeping
from tests.unit.scenarios import BARE, WHOLE, refusal, whole

# The locator finds every key and value of a TOML text.
TEXT = '''\
# a = 1
a = 1 # one
"b c".'d' = "x # y" # text
e.f . g = [1, 2, # three
  { h = "]" }, ]
i = { j = 'k', "l" = { m = 1.5 } }
n = """two
lines " "" """""
o = 1979-05-27 07:32:00   # a date
p = \'\'\'raw ' text\'\'\'

[ q . "r" ] # header
s = true
[[t]]
u = "\\u00b5\\""
[[t]]
u = 2
[t.v]
w = 3
[[t.x]]
[[t.x]]
y=4'''


def value(*path: str | int) -> str:
    span = locate(TEXT).values[path]
    return TEXT[span.start : span.end]


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (("a",), "1"),
        (("b c", "d"), '"x # y"'),
        (("e", "f", "g"), '[1, 2, # three\n  { h = "]" }, ]'),
        (("e", "f", "g", 1), "2"),
        (("e", "f", "g", 2, "h"), '"]"'),
        (("i",), "{ j = 'k', \"l\" = { m = 1.5 } }"),
        (("i", "l", "m"), "1.5"),
        (("n",), '"""two\nlines " "" """""'),
        (("o",), "1979-05-27 07:32:00"),
        (("p",), "'''raw ' text'''"),
        (("q", "r", "s"), "true"),
        (("t", 0, "u"), '"\\u00b5\\""'),
        (("t", 1, "u"), "2"),
        (("t", 1, "v", "w"), "3"),
        (("t", 1, "x", 1, "y"), "4"),
    ],
)
def test_a_value_is_where_it_is(path: tuple[str | int, ...], text: str) -> None:
    assert value(*path) == text


def test_a_key_is_where_it_is_first_named() -> None:
    keys = locate(TEXT).keys
    assert TEXT[keys["q", "r"].start : keys["q", "r"].end] == 'q . "r"'
    assert TEXT[keys["e", "f", "g"].start : keys["e", "f", "g"].end] == "e.f . g"
    assert TEXT[keys["e",].start : keys["e",].end] == "e"


@pytest.mark.parametrize("broken", ["a = 1\nb d = 2\nc = 3", "a = 1\n[b\nc = 3", "a = 1\n= 2", 'a = 1\n"\\q" = 2'])
def test_of_a_broken_text_the_sound_part_is_found(broken: str) -> None:
    spans = locate(broken)
    assert ("a",) in spans.values
    assert ("c",) not in spans.values


def test_the_last_key_named() -> None:
    assert locate("[a]\nb.c = 1,5").last == ("a", "b", "c")
    assert locate("[a]\nb = 1\n[d.e").last == ("d", "e")
    assert locate("").last == ()


def test_deep_nesting_ends_in_time() -> None:
    assert locate("a = " + "[" * 60_000).keys.keys() == {("a",)}


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


# What a scenario may ask of its reader: parts of a key anywhere, readings of a broken text, files in a chain.
Counted = Callable[[], int]

PARTS = ".a" * limits.KEY_DOTS
"""Seventeen parts with the one before them are the most."""

LONG = {
    "bare": "a{}.a = 1",
    "commas": '"a,b"{}.a = 1',
    "an equals sign": "'a=b'{}.a = 1",
    "a hash": '"a#b"{}.a = 1',
    "dots in quotation marks": '"..."{}."..." = 1',
    "an escaped quotation mark": r'"a\",\\"{}.a = 1',
    "blanks": 'a{}\t. "a" = 1',
    "a header": '["a,b"{}.a]',
    "a header of tables": "[['a=b'{}.a]]",
    "an inline table": "x = {{ a{}.a = 1 }}",
    "tables in an array": "x = [1, 'a', {{ y = 2, a{}.a = 1 }}]",
    "behind a long string": 'x = [\n"""\n""", {{ a{}.a = 1 }}, "z"]',
    "behind a long literal": "x = ['''\n''''', {{ a{}.a = 1 }}]",
    "behind a broken line": 'x = 1,5 mm\n"a,b"{}.a = 1',
    "behind a string that is left out with its line": 'x = """ """ """\n"a,b"{}.a = 1\n',
}


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> Counted:
    """Return how often tomllib has been asked to parse a whole text."""
    calls: list[int] = []
    original = tomllib.loads

    def counting(text: str) -> object:
        calls.append(len(text))
        return original(text)

    monkeypatch.setattr(tomllib, "loads", counting)
    return lambda: len(calls)


@pytest.mark.parametrize("context", LONG)
def test_parts_of_a_key_are_counted_wherever_it_stands(context: str) -> None:
    text = LONG[context]
    (too_long,) = [fault for fault in parse(text.format(PARTS).split("\n")).faults if "parts" in fault.message]
    assert too_long.message == "a key of more than 17 parts"
    assert text.split("\n")[too_long.line - 1].count("{}") == 1
    shorter = parse(text.format(PARTS[2:]).split("\n")).faults
    assert not [fault for fault in shorter if "parts" in fault.message]


@pytest.mark.parametrize("context", [name for name in LONG if not name.startswith("behind a broken")])
def test_a_key_of_too_many_parts_never_meets_the_parser(context: str, parsed: Counted) -> None:
    faults = parse(LONG[context].format(PARTS).split("\n")).faults
    assert parsed() == len(faults) - 1


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


def test_a_short_text_is_read_until_every_broken_line_is_named(parsed: Counted) -> None:
    faults = parse([f"x{number} = 1,5 mm" for number in range(19)]).faults
    assert len(faults) == parsed() - 1 == 19


def test_a_long_text_is_read_a_few_times(parsed: Counted) -> None:
    lines = [f'"k{number}" = 1' for number in range(4000)] + ['"k1" = 1'] * 19
    faults = parse(lines).faults
    assert 2 <= len(faults) == parsed() <= 4
    assert {fault.hint for fault in faults} == {"first given in line 2; keep one of the two"}


def test_files_that_extend_one_another_are_bounded_together(tmp_path: Path) -> None:
    for number in range(3):
        text = f'format = 1\nextends = "{number + 1}.toml"\n'
        (tmp_path / f"{number}.toml").write_text(text + ("#" * 99 + "\n") * 500, encoding="utf-8")
    (tmp_path / "3.toml").write_text(BARE, encoding="utf-8")
    assert load(tmp_path / "2.toml").title == load(tmp_path / "1.toml").title
    with pytest.raises(
        ScenarioRefused, match=r"1\.toml:2: error: extends: with it more than 128 kB extend one another"
    ):
        load(tmp_path / "0.toml")


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
    assert set(tomllib.loads(path.read_text(encoding="utf-8"))) <= {*Document.model_fields, "extends", "sweep"}


def test_the_schema_of_a_sweep_takes_lists_of_what_each_key_takes() -> None:
    schema = json_schema()
    sweep = schema["properties"]["sweep"]["properties"]
    assert set(sweep) == {*Sweeping.model_fields, "grid", "zip"}
    for table in (sweep["grid"], sweep["zip"]):
        swept = {
            f"{name}.{key}": about
            for name, keys in table["properties"].items()
            for key, about in keys["properties"].items()
        }
        assert set(swept) == {f"{name}.{key}" for name, section in SECTIONS.items() for key in section.model_fields} - {
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
