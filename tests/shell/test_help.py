"""What the command line says about itself: help, completion, its version, and failures with --debug."""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import get_type_hints

import pytest

import rubnoise
from rubnoise.cli import ask, version
from rubnoise.cli.app import COMMANDS, EARLIER, INSTEAD, program
from rubnoise.cli.version import commit_of_checkout, version_line
from tests.architecture.sources import ROOT
from tests.shell.terminal import Answer, call, spawn

# What the command line says about itself.
# Newer versions of typer load pydantic themselves when they build a command.
HEAVY = "{'numpy', 'scipy', 'numba', 'h5py', 'simpy', 'matplotlib', 'mpmath', 'xarray', 'rubnoise.scenario'}"
LOADED = f"""
import sys
from rubnoise.cli.app import main
for command in {tuple(COMMANDS)}:
    sys.argv = ["rubnoise", command, "--help"]
    try:
        main()
    except SystemExit as left:
        assert not left.code, left.code
print("loaded:", *sorted({HEAVY} & set(sys.modules)))
"""


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command: str) -> None:
    answer = call(command, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Example: rubnoise {command}" in answer.out


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_its_texts_as_they_are_written(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    (registered,) = program([command]).registered_commands
    said = _words(call(command, "--help").out)
    hints = get_type_hints(registered.callback, include_extras=True)
    written = [about.help for hint in hints.values() for about in getattr(hint, "__metadata__", ())]
    for text in (*written, registered.callback.__doc__):
        assert _words(text) in said
    assert "<bool>" not in said
    assert "list[" not in said


def _words(text: str) -> str:
    """Return a text in one line, without the frames of help and what it adds at the end of a row."""
    return " ".join(re.sub(r"\[(required|default: .*?)\]", " ", text).split())


@pytest.mark.slow
def test_help_of_no_command_loads_anything_heavy() -> None:
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert set(re.findall(r"Example: rubnoise (\w+)", done.stdout)) == set(COMMANDS) - {"surface --synthesise"}
    assert done.stdout.splitlines()[-1] == "loaded:"


@pytest.mark.parametrize("command", INSTEAD)
def test_a_command_that_ended_says_what_to_call(command: str) -> None:
    for words in ((), ("x.h5", "--force", "-q")):
        answer = call(command, *words)
        assert (answer.code, answer.out, answer.err) == (2, "", f"rubnoise {command}: {INSTEAD[command]}\n")
    assert f" {command} " not in call("--help").out


def test_without_a_command_help_is_shown() -> None:
    answer = call()
    assert (answer.code, answer.err) == (0, "")
    shown = set(re.findall(r"^  (\w+) +\w", answer.out.partition("Begin and run:")[2], re.MULTILINE))
    assert shown == set(COMMANDS) - {"schema", "surface --synthesise"}
    assert len(answer.out.splitlines()) < 50


@pytest.mark.parametrize("word", EARLIER)
def test_a_word_of_an_earlier_version_is_the_command_that_it_became(word: str) -> None:
    assert call(word, "--help").out == call(EARLIER[word][0], "--help").out


def test_the_schema_is_the_one_that_is_kept_with_the_scenarios() -> None:
    answer = call("schema")
    assert (answer.code, answer.err) == (0, "")
    kept = (ROOT / "scenarios" / "scenario.schema.json").read_text(encoding="utf-8")
    assert answer.out == kept
    assert "interface" in json.loads(kept)["properties"]


# Shells complete commands and options; file names are left to them.
def _completed(shell: str, *words: str) -> Answer:
    """Return what a shell gets when it completes the last word."""
    line = " ".join(("rubnoise", *words))
    return spawn(
        _RUBNOISE_COMPLETE=f"complete_{shell}",
        COMP_WORDS=line,
        COMP_CWORD=str(len(words)),
        _TYPER_COMPLETE_ARGS=line,
        _TYPER_COMPLETE_FISH_ACTION="get-args",
    )


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
@pytest.mark.parametrize(("words", "offered"), [(("inf",), "info"), (("run", "--se"), "--seed")])
def test_commands_and_options_are_completed(here: Path, shell: str, words: tuple[str, ...], offered: str) -> None:
    answer = _completed(shell, *words)
    assert answer.code == 0, answer.err
    assert offered in answer.out
    assert "--force" not in answer.out


def test_file_names_are_left_to_the_shell(here: Path) -> None:
    (here / "mine.toml").touch()
    assert _completed("bash", "run", "mi").out.strip() == ""
    assert "complete -o default" in spawn(_RUBNOISE_COMPLETE="source_bash").out


# `rubnoise --version` names the commit of a checkout, as git does, or that of an installed package.
ONE = "1" * 40


def test_it_is_the_commit_that_git_names() -> None:
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("this is no checkout")
    git = ["git", "-C", str(ROOT), "rev-parse", "HEAD"]
    told = subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    assert commit_of_checkout(ROOT / "src" / "rubnoise") == told
    assert call("--version").out == f"rubnoise {rubnoise.__version__} (commit {told[:12]})\n"


@pytest.mark.parametrize(
    ("origin", "shown"),
    [
        (json.dumps({"url": "x", "vcs_info": {"vcs": "git", "commit_id": ONE}}), f" (commit {ONE[:12]})"),
        (json.dumps({"url": "file:///x", "dir_info": {}}), ""),
        (None, ""),
        ("{", ""),
    ],
)
def test_a_package_that_pip_made_of_a_commit_names_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, origin: str | None, shown: str
) -> None:
    installed = SimpleNamespace(read_text=lambda name: origin if name == "direct_url.json" else None)
    monkeypatch.setattr(version, "distribution", lambda _name: installed)
    monkeypatch.setattr(version, "PACKAGE", tmp_path / "site-packages" / "rubnoise")
    assert version_line() == f"rubnoise {rubnoise.__version__}{shown}"


# A traceback is shown only with --debug; an unexpected failure is one line, too.
LINE = "missing.h5: no such file or directory\n"


@pytest.mark.parametrize("words", [("--debug", "info", "missing.h5"), ("info", "missing.h5", "--debug")])
def test_debug_shows_where_before_the_command_and_after(here: Path, words: tuple[str, ...]) -> None:
    answer = call(*words)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("Traceback (most recent call last):\n")
    assert "reader.py" in answer.err
    assert answer.err.endswith(f"\n{LINE}")


def failing(problem: Exception) -> Callable[..., None]:
    def fail(*arguments: object) -> None:
        raise problem

    return fail


@pytest.mark.parametrize(
    ("problem", "line"),
    [
        (
            KeyError("of\x1b\nours"),
            "internal error, which should not be: KeyError: 'of\\x1b\\nours' (--debug shows where)",
        ),
        (RecursionError("deep"), "internal error, which should not be: RecursionError: deep (--debug shows where)"),
        (ValueError("two\nlines"), "internal error, which should not be: ValueError: two lines (--debug shows where)"),
        (MemoryError(), "out of memory; a shorter run, or a coarser output.tick, needs less"),
    ],
)
def test_what_nobody_foresaw_is_a_line_too(
    here: Path, monkeypatch: pytest.MonkeyPatch, problem: Exception, line: str
) -> None:
    assert call("run", "../given/contact.toml").code == 0
    monkeypatch.setattr(ask, "run_answer", failing(problem))
    answer = call("info", "contact.h5")
    assert (answer.code, answer.out, answer.err) == (1, "", f"{line}\n")
    assert "in fail" in call("info", "contact.h5", "--debug").err
