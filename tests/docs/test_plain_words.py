"""Pages, messages and help are in plain words: no private idioms, and on pages no long sentence."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from rubnoise.cli.app import program
from tests.architecture.sources import ROOT

AVOID = {
    r"whoever": "a user who, the process that",
    r"nobody": "no one, no user; or the passive",
    r"everybody": "all users",
    r"somebody": "a user, another program",
    r"(is|are|was|were|be|being) told": "gets, reads",
    r"tells? of": "shows, reports",
    r"that which": "what",
    r"turned down": "rejected",
    r"asked (for|of)": "requested, specified",
    r"a word of": "part of",
    r"(go|goes|going|went|gone) on with": "resume, continue",
    r"goes on": "resumes, continues",
    r"go on where": "resume",
    r"foretold|foretells?|foresight": "forecast",
    r"(hold|holds|held|holding) (\w+ ){0,3}against": "compare with",
    r"seen onto": "flushed to disk (fsync)",
    r"anew": "again",
    r"torn": "truncated",
    r"is none": "does not exist, is not valid",
    r"holds other things": "is not a sweep folder",
    r"that did not finish": "unfinished",
    r"as far as nothing": "if it cannot be recovered",
    r"where no one chose|chose a stretch": "default",
    r"goes with itself": "is correlated with itself",
    r"looks at the living": "samples of live junctions",
    r"cannot be defended": "cannot be estimated",
    r"worked out": "computed",
    r"as good as not": "ignored",
    r"is silent": "gives no value",
    r"in the end": "at the end",
}
"""What is not to be read by a user (a regular expression between word boundaries), and what to write instead."""
IDIOM = re.compile(rf"\b(?:{'|'.join(AVOID)})\b", re.IGNORECASE)
PAGES = sorted(
    ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", *(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))]
)
MOST_WORDS = 40
"""A reader whose first language is not English reads a sentence once; most have half of this."""
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
NO_PROSE = re.compile(r"\s*(\||#|!\[|<!--)")
ITEM = re.compile(r"\s*([-*]|\d+\.)\s")
COMMENT = re.compile(r"/\*.*?\*/|(?<!:)//[^\n]*|<!--.*?-->", re.DOTALL)
LESSON = sorted(path for path in (ROOT / "src" / "rubnoise" / "lesson" / "parts").iterdir() if path.is_file())
SOURCES = sorted((ROOT / "src" / "rubnoise").rglob("*.py"))


def paragraphs(page: str) -> Iterator[str]:
    """Yield the paragraphs and list items of a page, each in one line, without code, tables and headings."""
    lines: list[str] = []
    for line in [*FENCED.sub("", page).splitlines(), ""]:
        code = line.startswith("    ") and not lines
        if lines and (not line.strip() or ITEM.match(line) or NO_PROSE.match(line)):
            yield " ".join(lines)
            lines = []
        if line.strip() and not code and not NO_PROSE.match(line):
            lines.append(line.strip())


def sentences(page: str) -> Iterator[str]:
    """Yield the sentences of a page; code in backticks and the address of a link count as no words."""
    for paragraph in paragraphs(page):
        plain = re.sub(r"`[^`]*`", "`x`", re.sub(r"\]\([^)]*\)", "]", paragraph))
        yield from re.split(r"(?<=[.!?:])\**\s+", plain)


def length(sentence: str) -> int:
    """Return the number of words of a sentence."""
    return sum(bool(re.search(r"\w", word)) for word in sentence.split())


def idioms(text: str) -> list[str]:
    """Return the phrases of a text that are to be avoided."""
    return [found[0] for found in IDIOM.finditer(" ".join(text.split()))]


@cache
def messages(path: Path) -> tuple[tuple[int, str], ...]:
    """Return the texts of a module that are no docstrings, an f-string in one piece, with their lines."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    joined = [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]
    inside = {id(value) for node in joined for value in node.values}
    found = [(node.lineno, "".join(map(_constant, node.values))) for node in joined]
    found += [
        (node.lineno, node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in bare | inside
    ]
    return tuple(each for each in found if " " in each[1])  # a single word is a name


def _constant(part: ast.expr) -> str:
    return str(part.value) if isinstance(part, ast.Constant) else "{}"


def helps() -> Iterator[tuple[str, str]]:
    """Yield the help of every command, and of each of its arguments and options."""
    group: Any = get_command(program())
    for name, command in group.commands.items():
        yield name, command.help or ""
        yield from ((f"{name} {each.name}", getattr(each, "help", None) or "") for each in command.params)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_has_no_idioms(page: str) -> None:
    assert idioms((ROOT / page).read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("page", PAGES)
def test_a_page_has_no_long_sentence(page: str) -> None:
    longest = max(sentences((ROOT / page).read_text(encoding="utf-8")), key=length)
    assert length(longest) <= MOST_WORDS, longest


def test_messages_have_no_idioms() -> None:
    wrong = [
        f"{path.relative_to(ROOT)}:{line}: {phrase}"
        for path in SOURCES
        for line, text in messages(path)
        for phrase in idioms(text)
    ]
    assert wrong == []


def test_help_has_no_idioms() -> None:
    assert [(where, phrase) for where, text in helps() for phrase in idioms(text)] == []


@pytest.mark.parametrize("part", LESSON, ids=lambda part: part.name)
def test_the_lesson_has_no_idioms(part: Path) -> None:
    assert idioms(COMMENT.sub("", part.read_text(encoding="utf-8"))) == []


def test_an_idiom_is_found_across_lines() -> None:
    assert idioms("A run is gone on\nwith. Turned down: it is held exactly\nagainst that.") == [
        "gone on with",
        "Turned down",
        "held exactly against",
    ]
    assert idioms("A torn page, but a tornado and a plain anewly.") == ["torn"]


def test_sentences_leave_out_code_and_tables() -> None:
    page = (
        "# A title\n\nOne `two three` four. Five\nsix.\n\n    code here\n\n| a table |\n- an item\n  of two lines\n\n"
        "```sh\nno prose\n```\n"
    )
    found = list(sentences(page))
    assert found == ["One `x` four.", "Five six.", "- an item of two lines"]
    assert [length(each) for each in found] == [3, 2, 5]


def test_messages_are_found_in_pieces(tmp_path: Path) -> None:
    source = tmp_path / "module.py"
    source.write_text('"""A docstring of nobody."""\nx = 1\nprint(f"is {x} " "goes on")\nprint("torn")\n')
    assert [text for _, text in messages(source)] == ["is {} goes on"]
