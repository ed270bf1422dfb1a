"""What is printed ends where the terminal does, and is the same as ever where there is no terminal."""

import os
import re
import sys
from io import StringIO
from itertools import pairwise
from pathlib import Path

import pytest

import rubnoise
from rubnoise.cli.app import COMMANDS
from rubnoise.cli.layout import cut, groups_that_fit, line, remark, sentence, table_row
from tests.cli.terminal import WITH_SLIDER, call, command, shown_on_terminal

SLIDER = Path("../given/slider.toml")
READING = ["info", "junction", "junctions", "compare", "theory", "verify", "check"]


def _longest(shown: str) -> int:
    """Return the length of the longest line but for commands, which are kept whole to be pasted."""
    return max(len(text) for text in re.split(r"[\r\n]+", shown) if not text.startswith("  command"))


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a scenario of a long title, and its result."""
    folder = tmp_path_factory.mktemp("wide")
    (folder / "t.toml").write_text(f'title = "{"words to fill a line " * 8}"\n{WITH_SLIDER}', encoding="utf-8")
    rubnoise.run(rubnoise.load(folder / "t.toml", ["sliding.distance=4mm"]), folder / "t.h5").close()
    return folder


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_help_of_every_command_keeps_within_the_terminal(columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    pages = [call("--help").out, *(call(name, "--help").out for name in COMMANDS)]
    assert len(pages) > 15
    assert {max(map(len, page.splitlines())) for page in pages} == {columns}
    assert "…" not in "".join(pages)


def test_sentences_of_help_are_broken_by_the_terminal_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    said = call("sweep", "--help").out
    lines = said[said.index(" The same command") : said.index(" Example")].strip().splitlines()
    assert len(lines) > 2
    for text, following in pairwise(lines):
        assert len(text.strip()) + len(following.split()[0]) > 56


@pytest.mark.parametrize("name", READING)
def test_a_narrow_terminal_gets_no_line_that_runs_over(
    results: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(results)
    more = {"junction": ["17"], "junctions": ["--columns", "junction,diameter,birth_distance,death_distance,state"]}
    arguments = (name, "t.toml" if name == "check" else "t.h5", *more.get(name, []))
    piped = call(*arguments).out
    monkeypatch.setenv("COLUMNS", "60")
    narrow = call(*arguments).out
    assert 30 < _longest(narrow) <= 60
    words = [re.findall(r"[\w.]+", text) for text in (piped, narrow)]
    told = words[0] if name != "junctions" else [*words[0], "junction", *map(str, range(20))]  # each part is numbered
    assert sorted(words[1]) == sorted(told) or name in ("info", "check")  # which forecast a time


def test_a_real_terminal_is_filled_and_a_pipe_is_none(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = "written; `rubnoise check n.toml` says what it means, `rubnoise run n.toml` runs it"
    narrow = shown_on_terminal(command("new", "n.toml"), 60)[1]
    assert narrow.split("\r\n")[:2] == [
        "n.toml: written; `rubnoise check n.toml` says what it means,",
        "  `rubnoise run n.toml` runs it",
    ]
    wide = shown_on_terminal(command("new", "w.toml"), 120)[1]
    assert wide == f"w.toml: {told.replace('n.toml', 'w.toml')}\r\n"
    monkeypatch.delenv("COLUMNS", raising=False)
    assert call("new", "p.toml").out == f"p.toml: {told.replace('n.toml', 'p.toml')}\n"


def test_without_a_terminal_text_is_80_columns_wide(results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(results)
    monkeypatch.delenv("COLUMNS", raising=False)
    heading, *rest = call("info", "t.h5").out.splitlines()
    assert heading == f"t.h5: {'words to fill a line ' * 8}"
    assert 72 < _longest("\n".join(rest)) <= 80
    monkeypatch.setenv("COLUMNS", "120")
    assert 110 < _longest(call("info", "t.h5").out) <= 120


def test_progress_on_a_narrow_terminal_stays_in_its_line_and_tells_the_time_to_go(here: Path) -> None:
    arguments = command("run", SLIDER, "-o", "long.h5", "--set", "sliding.distance=100 mm")
    code, shown = shown_on_terminal(arguments, 40)
    assert code == 0
    steps = [text for text in shown.split("\r") if "of 100 mm" in text]
    assert len(steps) >= 3
    assert all(len(text) < 40 for text in steps)
    assert any("to go" in text for text in steps)


class Terminal(StringIO):
    """A stream that is a terminal of 50 columns."""

    def fileno(self) -> int:
        return 99


@pytest.fixture
def fifty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    monkeypatch.setattr("sys.stdout", Terminal())
    monkeypatch.setattr("os.get_terminal_size", lambda _: os.terminal_size((50, 24)))


@pytest.mark.usefixtures("fifty")
def test_pieces_of_text_are_laid_out_for_the_terminal() -> None:
    assert table_row("  a label     ", "1.0 2.0") == "  a label     1.0 2.0"
    assert table_row("  a label" + " " * 35, "   1.0   2.0") == "  a label\n     1.0   2.0"
    assert groups_that_fit([10, 30, 10, 20, 60, 5]) == [[0, 1, 2], [0, 3], [0, 4], [0, 5]]
    assert all(len(text) <= 50 for text in remark("word " * 40).splitlines())
    assert line("label", "word " * 20).splitlines()[1].index("word") == 27
    assert len(sentence("word " * 20).splitlines()) == 3
    assert cut("x" * 60, sys.stdout) == "x" * 49


@pytest.mark.usefixtures("fifty")
def test_the_environment_may_say_how_wide_text_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert len(sentence("word " * 19)) == 94
    monkeypatch.setenv("COLUMNS", "nonsense")
    assert "\n" in sentence("word " * 19)


def test_where_no_terminal_is_nothing_is_broken_that_programs_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    monkeypatch.setattr("sys.stdout", StringIO())
    assert groups_that_fit([50] * 9) == [list(range(9))]
    assert table_row("x" * 80, "1.0") == f"{'x' * 80}1.0"
    assert sentence("word " * 50) == "word " * 50
    assert cut("x" * 300, sys.stdout) == "x" * 300
