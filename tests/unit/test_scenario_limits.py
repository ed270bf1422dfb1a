"""What a scenario may ask of its reader: parts of a key anywhere, readings of a broken text, files in a chain."""

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import limits, load, loads
from rubnoise.scenario.source import parse
from tests.unit.scenarios import BARE

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
