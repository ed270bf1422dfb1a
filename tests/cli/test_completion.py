"""Shells complete commands and options; file names are left to them."""

from pathlib import Path

import pytest

from tests.cli.terminal import Answer, spawn


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


def test_pictures_are_completed(here: Path) -> None:
    assert _completed("bash", "plot", "x.h5", "hi").out.split() == ["histogram"]


def test_file_names_are_left_to_the_shell(here: Path) -> None:
    (here / "mine.toml").touch()
    assert _completed("bash", "run", "mi").out.strip() == ""
    assert "complete -o default" in spawn(_RUBNOISE_COMPLETE="source_bash").out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_shell_has_a_script(here: Path, shell: str) -> None:
    answer = spawn(_RUBNOISE_COMPLETE=f"source_{shell}")
    assert answer.code == 0
    assert "_RUBNOISE_COMPLETE=complete_" in answer.out
