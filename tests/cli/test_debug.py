"""A traceback is shown only with --debug; an unexpected failure is one line, too."""

from collections.abc import Callable
from pathlib import Path

import pytest

from rubnoise.cli import info
from tests.cli.terminal import call

LINE = "missing.h5: no such file or directory\n"


def test_a_refusal_is_a_line(here: Path) -> None:
    assert call("info", "missing.h5").err == LINE


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
