"""Whatever stands in a file, or is its name, steers no terminal and adds no line to what is printed."""

import json
import os
import sys
from io import StringIO
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rubnoise.cli.commands import escaped, escaping
from rubnoise.storage.rows import REMEDY
from tests.cli.terminal import WITH_SLIDER, call, spawn

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


def test_a_name_that_is_no_text_is_escaped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(b"\xff\x1b.h5")
    Path(name).touch()
    answer = call("info", name)
    assert (answer.code, answer.err) == (2, f"\\udcff\\x1b.h5: is empty; {REMEDY}\n")


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
