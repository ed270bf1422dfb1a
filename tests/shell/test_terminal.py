"""What a terminal shows: lines of its width, nothing that steers it, and progress."""

import io
import json
import re
import sys
import time
from io import StringIO
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rubnoise
from rubnoise.cli.app import COMMANDS, escaped, escaping
from rubnoise.cli.terminal import bar
from rubnoise.storage.reader import open_run
from tests.files.runs import attempt
from tests.shell.terminal import (
    WITH_SLIDER,
    call,
    command,
    shown_on_terminal,
    spawn,
)

# What is printed ends where the terminal does, and is the same as ever where there is no terminal.
CONTACT = Path("../given/contact.toml")
"""Without a slider, whose kernels take longer to compile."""
COLUMNS = "junction,diameter,birth_distance,death_distance,life_distance,max_area,state"
READING = ["info", "junction", "junctions", "compare", "theory", "verify", "check"]


def _longest(shown: str) -> int:
    """Return the length of the longest line but for commands, which are kept whole to be pasted."""
    return max(len(text) for text in re.split(r"[\r\n]+", shown) if not text.startswith("  command"))


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a scenario of a long title, and its result."""
    folder = tmp_path_factory.mktemp("wide")
    (folder / "t.toml").write_text(f'title = "{"words to fill a line " * 8}"\n{WITH_SLIDER}', encoding="utf-8")
    scenario = rubnoise.load(folder / "t.toml", ["sliding.distance=4mm"])
    rubnoise.run(scenario, folder / "t.h5", command=["rubnoise"]).close()
    return folder


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_help_of_every_command_keeps_within_the_terminal(columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    pages = [call("--help").out, *(call(name, "--help").out for name in COMMANDS)]
    assert len(pages) > 15
    assert all(max(map(len, page.splitlines())) <= columns for page in pages)
    assert columns < 80 or "..." not in pages[0].partition("Begin and run:")[2]


@pytest.mark.slow("compare", "verify")
@pytest.mark.parametrize("name", READING)
def test_a_narrow_terminal_gets_no_line_that_runs_over(
    results: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(results)
    more = {"junction": ["17"], "junctions": ["--columns", COLUMNS]}
    arguments = (name, "t.toml" if name == "check" else "t.h5", *more.get(name, []))
    piped = call(*arguments).out
    monkeypatch.setenv("COLUMNS", "60")
    narrow = call(*arguments).out
    assert 30 < _longest(narrow) <= 60
    words = [re.findall(r"[\w.]+", text) for text in (piped, narrow)]
    told = words[0] if name != "junctions" else [*words[0], "junction", *map(str, range(20))]  # each part is numbered
    assert sorted(words[1]) == sorted(told) or name in ("info", "check")  # which forecast a time


# Whatever stands in a file, or is its name, steers no terminal and adds no line to what is printed.
HOSTILE = "a\x1b]0;owned\x07b\u202ec\u2066d\x9be\rf\x7f\nagreed: everything"
NAME = "x\x1b[2J\u202e\x9b"
TEXTS = ("command", "started", "scenario_toml", "software", "environment")


def assert_harmless(text: str) -> None:
    assert text
    assert text.replace("\n", "").isprintable()
    assert not any(line.lstrip().startswith("agreed:") for line in text.splitlines())


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a result whose every text is hostile, its name too, and with such a scenario."""
    folder = tmp_path_factory.mktemp("hostile")
    (folder / f"{NAME}.toml").write_text(f"title = {json.dumps(HOSTILE)}\n{WITH_SLIDER}", encoding="utf-8")
    ran = call("run", folder / f"{NAME}.toml", "-o", folder / f"{NAME}.h5", "--set", "title=harmless")
    assert ran.code == 0, ran.err
    assert_harmless(ran.out + ran.err)
    with h5py.File(folder / f"{NAME}.h5", "r+") as file:
        for owner, names in ((file, ("title", "source")), (file["provenance"], TEXTS)):
            for name in names:
                owner.attrs[name] = np.bytes_(HOSTILE.encode())
        file["provenance"].attrs["finished"] = np.bytes_(HOSTILE.encode())
        file["summary"].attrs[HOSTILE] = 1.0
    return folder


@pytest.mark.parametrize(
    "words",
    [
        ("info",),
        ("junction", "3"),
        ("junctions",),
        ("junctions", "--csv"),
        ("compare",),
        ("compare", "--bound", "0.001"),
        ("theory",),
        ("plot",),
        ("export", "--to", "csv", "--group", "trace"),
        ("listen", "--speed-up", "0.001"),
        ("teach", "-o", "page.html"),
        ("run",),
        ("check",),
    ],
    ids=" ".join,
)
def test_no_command_prints_what_steers_a_terminal(
    hostile: Path, words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    answer = call(words[0], hostile / f"{NAME}.h5", *words[1:])
    assert_harmless(answer.out + answer.err)
    assert "internal error" not in answer.err


@pytest.mark.parametrize("words", [("check",), ("theory",), ("run",), ("teach",)], ids=" ".join)
@pytest.mark.parametrize("changes", [(), ("--set", "title=harmless"), ("--set", f"run.{HOSTILE}=1")])
def test_a_scenario_steers_no_terminal(
    hostile: Path, words: tuple[str, ...], changes: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    answer = call(words[0], hostile / f"{NAME}.toml", *(changes if words != ("teach",) else ()))
    assert answer.code == (0 if "title=harmless" in changes and words != ("teach",) else 2)
    assert_harmless(answer.out + answer.err)


def test_a_name_in_a_usage_error_is_escaped_too(tmp_path: Path) -> None:
    answer = spawn("info", "one.h5", NAME)
    assert answer.code == 2
    assert_harmless(answer.err)
    assert r"x\x1b[2J\u202e\x9b" in answer.err


@given(st.text())
def test_escaped_text_is_printable_and_keeps_what_was(text: str) -> None:
    shown = escaped(text)
    assert shown.removeprefix("\r").replace("\n", "").isprintable()
    assert shown.count("\n") == text.count("\n")
    assert escaped(shown) == shown
    if text.isprintable():
        assert shown == text


def test_only_what_is_printed_meanwhile_is_escaped(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = StringIO()
    monkeypatch.setattr(sys, "stdout", stream)
    with escaping():
        sys.stdout.write("\x1ba\rb\n")
        sys.stdout.writelines(["\x07", "c\n"])
        sys.stdout.write("\r 5 %")
        assert not sys.stdout.isatty()
    sys.stdout.write("\x1b")
    assert stream.getvalue() == "\\x1ba\\rb\n\\x07c\n\r 5 %\x1b"


# What a terminal shows of a run.
LINE = re.compile(
    r"(?P<share>\d+)% (?P<reached>[\d.e-]+) of 100 mm, (?P<junctions>[\d,]+) junctions, (?P<live>\d+) alive"
    r" +(?P<rest>\d+:\d\d:\d\d|-:--:--)?"
)
STEERING = re.compile(r"\x1b\[[0-9;?]*[a-zA-Z]")


@pytest.mark.slow
def test_a_terminal_sees_compilation_once_and_how_far_the_run_is(here: Path, tmp_path: Path) -> None:
    arguments = command("run", CONTACT, "--force", "--set", "sliding.distance=100 mm")
    began = time.monotonic()
    code, first = shown_on_terminal(arguments, NUMBA_CACHE_DIR=str(tmp_path))
    took = time.monotonic() - began
    assert code == 0
    assert first.count("Compiling the kernels") == 1
    (said,) = re.findall(r"ticks, .*, in ([0-9.]+) s", first)
    assert float(said) < 0.5 * took, "compiling is no part of the run's seconds"
    code, second = shown_on_terminal(arguments, NUMBA_CACHE_DIR=str(tmp_path))
    assert code == 0
    assert "Compiling" not in second
    for shown in (first, second):
        _check_progress(shown)
    assert "real contact area mean (um^2)" in second


def _check_progress(shown: str) -> None:
    lines = list(LINE.finditer(STEERING.sub("", shown)))
    assert len(lines) >= 3
    reached = [float(line["reached"]) for line in lines]
    junctions = [int(line["junctions"].replace(",", "")) for line in lines]
    assert reached == sorted(reached)
    assert junctions == sorted(junctions)
    assert junctions[-1] > 1000
    assert all(0 < int(line["live"]) < 60 for line in lines if float(line["reached"]) > 0.0)
    assert any(line["rest"] not in {None, "-:--:--"} for line in lines)
    assert all(len(line[0].rstrip()) <= 80 for line in lines)


def test_a_look_through_a_file_is_shown_where_it_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    attempt(tmp_path / "run.h5")
    for shown in (True, False):
        monkeypatch.setattr("sys.stderr", screen := Screen())
        with open_run(tmp_path / "run.h5") as run, bar(shown=shown) as show:
            run.watch = lambda column, row, rows, show=show: show(row, rows, column)
            run.column("trace", "distance")
        assert ("/trace/distance" in screen.getvalue()) == shown


class Screen(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True
