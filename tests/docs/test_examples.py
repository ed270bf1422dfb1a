"""Every example in the README, the docs and the docstrings does what it says, those of all pages in one folder."""

import doctest
import pkgutil
import re
import subprocess
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from shlex import shlex, split
from textwrap import dedent
from typing import Any

import pytest

import rubnoise
from tests.architecture.sources import ROOT
from tests.cli.terminal import Answer, call
from tests.docs.pages import ELSEWHERE, Example, examples, pages

PAGES = {name: list(examples((ROOT / name).read_text(encoding="utf-8"))) for name in pages()}
MODULES = [module.name for module in pkgutil.walk_packages(rubnoise.__path__, "rubnoise.")]
DOCTESTS = [
    test
    for name in MODULES
    if not name.endswith("__main__")
    for test in doctest.DocTestFinder(exclude_empty=True).find(import_module(name))
    if test.examples
]
OPENED = re.compile(r'\b(?:open|open_sweep|File)\("(\w+)')
"""Results and sweeps that an example in Python reads."""
SAVED = re.compile(r'\.save\("(\w+)')
"""Results that an example in Python makes."""
WITHOUT_INPUT = {"new", "figures", "claims", "examples"}


def test_the_readme_can_be_followed(workplace: Path) -> None:
    _follow("README.md")


def test_all_pages_can_be_followed_in_one_folder(workplace: Path) -> None:
    for page in PAGES:
        _follow(page)


def _follow(page: str) -> None:
    names: dict[str, Any] = {"__name__": "__main__"}
    if page == "README.md":
        Path("fig5.h5").unlink()  # the README makes it, for all other pages
    for example in PAGES[page]:
        _play(example, page, names)


def _play(example: Example, page: str, names: dict[str, Any]) -> None:
    if example.kind == "python":
        # Blank lines in front, so that a traceback names the line of the page.
        exec(compile("\n" * (example.line - 1) + example.text, str(ROOT / page), "exec"), names)  # noqa: S102
        return
    words = list(shlex(example.text, posix=True, punctuation_chars=True))
    if any(word[0] in "|<>&;()" for word in words) or words[0] != "rubnoise":
        done = subprocess.run(["sh", "-c", example.text], capture_output=True, text=True, check=False)
        answer = Answer(code=done.returncode, out=done.stdout, err=done.stderr)
    else:
        answer = call(*split(example.text)[1:])
    assert answer.code == 0, f"{page}:{example.line}: {example.text}\n{answer.err}"


@pytest.mark.parametrize("page", [name for name, found in PAGES.items() if found])
def test_a_page_reads_nothing_that_only_another_page_makes(page: str) -> None:
    there = {"fig5"}  # the README makes it, and every page may begin there
    for example in PAGES[page]:
        if example.kind == "python":
            made = set(SAVED.findall(example.text))
            read = set(OPENED.findall(example.text)) - made
        else:
            words = split(example.text)
            command, first = words[1], words[2] if len(words) > 2 else "-"
            shipped = first in rubnoise.examples() or first.startswith(("-", "scenarios/"))
            read = set() if command in WITHOUT_INPUT or shipped else {Path(first).stem}
            made = {Path(name).stem for option, name in pairwise(words) if option in ("-o", "new")} | read
        assert read <= there, f"{page}:{example.line}: {example.text}"
        there |= made


@pytest.mark.parametrize("test", DOCTESTS, ids=lambda test: test.name)
def test_a_docstring_holds_what_it_says(workplace: Path, test: doctest.DocTest) -> None:
    told: list[str] = []
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    doctest.DocTestRunner(optionflags=options).run(test, out=told.append, clear_globs=False)
    assert told == [], "".join(told)


def test_every_page_is_in_the_table_of_the_readme() -> None:
    docs = {f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md") if path.name not in ELSEWHERE}
    assert set(pages()) == {"README.md"} | docs


def test_there_are_examples() -> None:
    assert {"README.md", "docs/json.md", "docs/api.md", "docs/export.md"} <= {
        name for name, found in PAGES.items() if found
    }
    assert "rubnoise.api.result.Run" in {test.name for test in DOCTESTS}


def test_examples_are_found_on_a_page() -> None:
    page = dedent("""\
        Text, with `rubnoise inline`.

            $ rubnoise first | cat
            rubnoise second FILE
            A formula, no command

        ```python
        x = 1

            rubnoise not a command, it is in a block
        ```

        ```console
        $ echo third
        what it says
        ```

        ```toml
        $ no shell
        ```
        """)
    found = [(each.kind, each.text.splitlines()[0], each.line) for each in examples(page)]
    assert found == [
        ("shell", "rubnoise first | cat", 3),
        ("shell", "rubnoise second FILE", 4),
        ("python", "x = 1", 8),
        ("shell", "echo third", 14),
    ]


def test_a_wrong_docstring_is_noticed() -> None:
    told: list[str] = []
    wrong = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, 0)
    doctest.DocTestRunner().run(wrong, out=told.append)
    assert "Expected:\n    3" in "".join(told)
