"""Every example on a page runs, and links, pictures and the first hour lead where they say."""

import doctest
import pkgutil
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from shlex import shlex, split
from textwrap import dedent
from typing import Any, Literal

import numpy as np
import pytest
from PIL import Image

import rubnoise
from tests.architecture.sources import ROOT
from tests.shell.terminal import Answer, call
from tools import build_site
from tools import generate_gallery as tool

# The examples on a page of Markdown: Python blocks and shell commands, in the order in which a reader meets them.
ELSEWHERE = {"docs/reading.md"}
"""Pages whose blocks need tools of their own and are run by the tests in tests/reading; their commands are run here."""
FIRST = ["docs/start.md", "docs/model.md", "docs/scenarios.md", "docs/reading.md", "docs/your-data.md"]
"""The five pages that nine readers in ten need, in their order; the first makes fig5.h5 for all others."""
BLOCK = re.compile(r"^```(\w*)\n((?:(?!^```$).*\n)*)^```$|^ {4}(\S.*)$", re.MULTILINE)
SHELLS = {"sh", "bash", "console"}


@dataclass(frozen=True, slots=True)
class Example:
    """One Python block or one shell command, and the line of the page on which it begins."""

    kind: Literal["python", "shell"]
    text: str
    line: int


def pages() -> list[str]:
    """Return the pages whose examples are run, relative to the root: the README, the five pages, then the others."""
    others = sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))
    return list(dict.fromkeys(["README.md", *FIRST, *others]))


def examples(page: str) -> Iterator[Example]:
    """Yield every ```python block, and every command after `$ ` or indented by four columns that calls rubnoise."""
    for found in BLOCK.finditer(page):
        line = page.count("\n", 0, found.start()) + 1
        language, block, indented = found.groups()
        if language == "python":
            yield Example("python", block, line + 1)
        elif block is not None and language in SHELLS:
            for offset, text in enumerate(block.splitlines(), start=1):
                yield from _command(text, line + offset)
        elif indented is not None:
            yield from _command(indented, line)


def _command(text: str, line: int) -> Iterator[Example]:
    prompted = text.startswith("$ ")
    command = text.removeprefix("$ ")
    if prompted or command.startswith("rubnoise "):
        yield Example("shell", command, line)


# Every example on a page runs, and links, pictures and the first hour lead where they say.
# Every example in the README, the docs and the docstrings does what it says, those of all pages in one folder.
PAGES = {
    name: [
        each
        for each in examples((ROOT / name).read_text(encoding="utf-8"))
        if name not in ELSEWHERE or each.text.startswith("rubnoise ")
    ]
    for name in pages()
}
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
WITHOUT_INPUT = {"new", "examples"}


@pytest.mark.slow
@pytest.mark.parametrize("page", FIRST)
def test_each_of_the_five_pages_can_be_followed_alone(workplace: Path, page: str) -> None:
    _follow(page)


@pytest.mark.slow
def test_the_other_pages_can_be_followed_in_one_folder(workplace: Path) -> None:
    for page in PAGES:
        if page not in FIRST:
            _follow(page)


def _follow(page: str) -> None:
    names: dict[str, Any] = {"__name__": "__main__"}
    if page == FIRST[0]:
        Path("fig5.h5").unlink()  # this page makes it, for all others
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
    there = {"fig5"}  # the first page makes it, and every page may begin there
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
            made |= {Path(first).stem} if command == "run" else set()
        assert read <= there, f"{page}:{example.line}: {example.text}"
        there |= made


@pytest.mark.slow("Run.plot", "SweepResult", "open_sweep", "sweeps.")
@pytest.mark.parametrize("test", DOCTESTS, ids=lambda test: test.name)
def test_a_docstring_holds_what_it_says(workplace: Path, test: doctest.DocTest) -> None:
    told: list[str] = []
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    doctest.DocTestRunner(optionflags=options).run(test, out=told.append, clear_globs=False)
    assert told == [], "".join(told)


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


# The gallery shows every picture with its command.
@pytest.mark.parametrize("page", tool.PAGES)
def test_its_pictures_are_there_and_small(page: str) -> None:
    files = {path.name: path.read_bytes() for path in (tool.PICTURES / page).iterdir()}
    drawn = [word for words in tool.commands(page) for word in words if word.endswith(".png")]
    assert sorted(files) == sorted(drawn)
    assert all(content.startswith(b"\x89PNG") for content in files.values())
    assert sum(map(len, files.values())) < 1_200_000


@pytest.mark.slow
def test_its_pictures_are_what_its_commands_draw(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def called(_folder: Path, words: list[str]) -> None:
        assert call(*words).code == 0, words

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tool, "call", called)
    monkeypatch.setattr(tool, "FIGURES", ())
    tool.draw(tmp_path, tmp_path / "pictures", "gallery")
    for path in (tmp_path / "pictures" / "gallery").iterdir():
        with Image.open(path) as new, Image.open(tool.PICTURES / "gallery" / path.name) as old:
            assert new.size == old.size, path.name
            away = np.abs(np.asarray(new.convert("L"), dtype=int) - np.asarray(old.convert("L")))
        assert away.mean() < 1.0, path.name


# Every link between pages leads somewhere: to a file of the repository, to a heading, to a picture with a text.
FOLDERS = (".", "docs", "notebooks", "paper", "tools/site", "packaging", ".github")
SITE_ONLY = {"install.md", "lesson.md", "viewer.md", "README.md", "docs", "commands.md", "python.md"}
"""What the start page of the site links to: pages beside it there."""
FENCED = re.compile(r"^```.*?^```$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)
LINKED_PAGES = sorted(path for folder in FOLDERS for path in (ROOT / folder).glob("*.md"))


@cache
def anchors(path: Path) -> frozenset[str]:
    """Return the anchors of a page's headings, as GitHub makes them."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    plain = [re.sub(r"\]\([^)]*\)|[^\w\- ]", "", heading.strip().lower()) for heading in HEADING.findall(text)]
    return frozenset(each.replace(" ", "-") for each in plain)


def broken(path: Path, text: str) -> Iterator[str]:
    """Yield the links of a page that lead nowhere, and pictures without a text."""
    site = path.parent == ROOT / "tools" / "site"
    for picture, shown, target in LINK.findall(FENCED.sub("", text)):
        if picture and not shown:
            yield f"{target}: a picture without a text"
        if target.startswith(("https://", "http://", "mailto:")):
            continue
        name, _, anchor = target.partition("#")
        folder = ROOT if site else path.parent
        if site and name.partition("/")[0] in SITE_ONLY and not (ROOT / name).exists():
            name = f"tools/site/{name}" if (path.parent / name).exists() else ""
        found = (folder / name).resolve() if name else path
        if not found.exists() or ROOT not in (found, *found.parents):
            yield f"{target}: no such file"
        elif anchor and found.suffix == ".md" and anchor not in anchors(found):
            yield f"{target}: no such heading"


@pytest.mark.parametrize("page", LINKED_PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path) -> None:
    assert list(broken(page, page.read_text(encoding="utf-8"))) == []


def test_every_picture_is_shown() -> None:
    pages = " ".join(page.read_text(encoding="utf-8") for page in LINKED_PAGES)
    pictures = [path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs" / "pictures").rglob("*.*g")]
    assert [each for each in pictures if each.replace("-dark.svg", ".svg") not in pages] == []


def test_every_page_is_on_the_site() -> None:
    start = (ROOT / "tools" / "site" / "index.md").read_text(encoding="utf-8")
    nested = {name for below in build_site.NESTED.values() for name in below}
    names = [
        path.relative_to(ROOT).with_suffix("").as_posix()
        for path in LINKED_PAGES
        if path.parent in (ROOT, ROOT / "docs") and path.name != "README.md"
    ]
    assert [name for name in names if f"\n{name}\n" not in start and name not in nested] == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[a](nowhere.md)", "nowhere.md: no such file"),
        ("[a](model.md#nothing-here)", "model.md#nothing-here: no such heading"),
        ("[a](#nothing-here)", "#nothing-here: no such heading"),
        ("![](pictures/gallery/overview.png)", "pictures/gallery/overview.png: a picture without a text"),
        ("[a](../../etc)", "../../etc: no such file"),
    ],
)
def test_a_broken_link_is_found(text: str, said: str) -> None:
    assert list(broken(ROOT / "docs" / "theory.md", text)) == [said]
    assert list(broken(ROOT / "docs" / "theory.md", f"`{text}`\n```\n{text}\n```\n")) == []
