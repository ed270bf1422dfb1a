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
from rubnoise.cli import export, info, listen, plot, version
from rubnoise.cli.app import COMMANDS as REGISTERED
from rubnoise.cli.app import EARLIER, program
from rubnoise.cli.ended import INSTEAD
from rubnoise.cli.options import ENGINES
from rubnoise.cli.version import commit_of_checkout, version_line
from rubnoise.scenario import json_schema
from tests.architecture.sources import ROOT
from tests.cli.terminal import Answer, call, spawn

# What the command line says about itself.
COMMANDS = [name for name in REGISTERED if name not in INSTEAD]

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


def test_brackets_in_help_are_no_styles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    assert "A file with a table [sweep], or one run's for --over." in call("sweep", "--help").out
    assert "For a file with a table [sweep], check and list every point" in call("check", "--help").out


@pytest.mark.parametrize(
    ("command", "option", "choices"),
    [
        ("run", "--engine", ENGINES),
        ("sweep", "--engine", ENGINES),
        ("export", "--to", tuple(export.ExportFormat)),
        ("export", "--group", tuple(export.ExportedGroup)),
        ("listen", "--what", tuple(listen.What)),
        ("listen", "--rate", tuple(listen.Rate)),
        ("plot", "WHAT", plot.PICTURES),
    ],
)
@pytest.mark.parametrize("columns", [60, 80])
def test_an_option_with_fixed_choices_names_them_all(
    command: str, option: str, choices: tuple[str, ...], columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    text = call(command, "--help").out
    start = re.search(rf"^  (-\w, )?{option}\b", text, re.MULTILINE)
    assert start
    row = re.split(r"\n  \S|\n\n", text[start.end() :])[0]
    assert set(choices) <= set(re.findall(r"[\w-]+", row))


def test_choices_are_those_of_scenarios_and_pictures() -> None:
    engine = json_schema()["$defs"]["Run"]["properties"]["engine"]
    assert set(ENGINES) == set(engine["enum"])


def test_help_of_no_command_loads_anything_heavy() -> None:
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert set(re.findall(r"Example: rubnoise (\w+)", done.stdout)) == set(COMMANDS)
    assert done.stdout.splitlines()[-1] == "loaded:"


def test_the_version_is_told() -> None:
    answer = call("--version")
    assert (answer.code, answer.out.partition(" (")[0].strip(), answer.err) == (
        0,
        f"rubnoise {rubnoise.__version__}",
        "",
    )


@pytest.mark.parametrize("command", INSTEAD)
def test_a_command_that_ended_says_what_to_call(command: str) -> None:
    for words in ((), ("x.h5", "--force", "-q")):
        answer = call(command, *words)
        assert (answer.code, answer.out, answer.err) == (2, "", f"rubnoise {command}: {INSTEAD[command]}\n")
    assert f" {command} " not in call("--help").out


def test_without_a_command_help_is_shown() -> None:
    answer = call()
    assert answer.code == 2
    assert set(COMMANDS) - {"schema"} == set(re.findall(r"^  (\w+) +\w", answer.out + answer.err, re.MULTILINE))
    assert len((answer.out + answer.err).splitlines()) < 50


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


@pytest.mark.parametrize("word", ["pa", "parq"])
def test_formats_are_completed(here: Path, word: str) -> None:
    assert _completed("bash", "export", "--to", word).out.split() == ["parquet"]


@pytest.mark.parametrize("words", [("run", "--engine", "ba"), ("sweep", "--engine", "ba")])
def test_engines_are_completed(here: Path, words: tuple[str, ...]) -> None:
    assert _completed("bash", *words).out.split() == ["batch"]


def test_file_names_are_left_to_the_shell(here: Path) -> None:
    (here / "mine.toml").touch()
    assert _completed("bash", "run", "mi").out.strip() == ""
    assert "complete -o default" in spawn(_RUBNOISE_COMPLETE="source_bash").out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_shell_has_a_script(here: Path, shell: str) -> None:
    answer = spawn(_RUBNOISE_COMPLETE=f"source_{shell}")
    assert answer.code == 0
    assert "_RUBNOISE_COMPLETE=complete_" in answer.out


# `rubnoise --version` names the commit of a checkout, however git keeps it, and starts no git for it.
ONE, OTHER = "1" * 40, "2a" * 32


def checkout(folder: Path, files: dict[str, str]) -> Path:
    """Make a checkout with some of git's own files, and return the package in it."""
    package = folder / "src" / "rubnoise"
    package.mkdir(parents=True)
    (folder / "pyproject.toml").touch()
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return package


@pytest.mark.parametrize(
    ("files", "commit"),
    [
        ({".git/HEAD": f"{ONE}\n"}, ONE),
        ({".git/HEAD": "ref: refs/heads/main\n", ".git/refs/heads/main": f"{OTHER}\n"}, OTHER),
        (
            {
                ".git/HEAD": "ref: refs/heads/a/b\n",
                ".git/packed-refs": f"# pack-refs with: peeled\n{OTHER} refs/heads/a\n{ONE} refs/heads/a/b\n^{OTHER}\n",
            },
            ONE,
        ),
        (
            {
                ".git": "gitdir: elsewhere/.git/worktrees/this\n",
                "elsewhere/.git/worktrees/this/HEAD": "ref: refs/heads/this\n",
                "elsewhere/.git/worktrees/this/commondir": "../..\n",
                "elsewhere/.git/refs/heads/this": f"{ONE}\n",
            },
            ONE,
        ),
        ({".git/HEAD": "ref: refs/heads/unborn\n"}, ""),
        ({".git/HEAD": "\x1b[2J\n"}, ""),
        ({}, ""),
    ],
    ids=["detached", "branch", "packed", "worktree", "unborn", "nonsense", "no git"],
)
def test_the_commit_is_read_from_files_of_git(tmp_path: Path, files: dict[str, str], commit: str) -> None:
    assert commit_of_checkout(checkout(tmp_path, files)) == commit


def test_it_is_the_commit_that_git_names() -> None:
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("this is no checkout")
    git = ["git", "-C", str(ROOT), "rev-parse", "HEAD"]
    told = subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    assert commit_of_checkout(ROOT / "src" / "rubnoise") == told
    assert call("--version").out == f"rubnoise {rubnoise.__version__} (commit {told[:12]})\n"


def test_a_package_inside_another_checkout_takes_no_commit_from_it(tmp_path: Path) -> None:
    checkout(tmp_path, {".git/HEAD": f"{ONE}\n"})
    for place in ("lib/site-packages/rubnoise", ".venv/lib/python3.11/site-packages/rubnoise"):
        (tmp_path / place).mkdir(parents=True)
        assert commit_of_checkout(tmp_path / place) == ""


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


def test_debug_says_nothing_where_nothing_fails(here: Path) -> None:
    plain, asked = call("check", "../given/contact.toml"), call("check", "../given/contact.toml", "--debug")
    assert (asked.code, asked.err) == (0, "")
    assert asked.out.splitlines()[:3] == plain.out.splitlines()[:3]


def test_behind_two_dashes_it_is_a_name(here: Path) -> None:
    assert call("info", "--", "--debug").err == "--debug: no such file or directory\n"


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
    monkeypatch.setattr(info, "run_as_json", failing(problem))
    answer = call("info", "contact.h5")
    assert (answer.code, answer.out, answer.err) == (1, "", f"{line}\n")
    assert "in fail" in call("info", "contact.h5", "--debug").err
