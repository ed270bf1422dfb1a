"""Pages are in plain words, and say what the code says."""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from rubnoise.cli.app import program
from rubnoise.scenario.reading import loads
from rubnoise.storage.schema import GROUPS
from tests.architecture.sources import ROOT
from tools import generate_docs

# Pages, messages and help are in plain words: no private idioms, and on pages no long sentence.
AVOID = tomllib.loads(Path(__file__).with_name("plain_words.toml").read_text(encoding="utf-8"))
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
    """Yield the sentences of a page; code, a formula and the address of a link count as one word or none."""
    for paragraph in paragraphs(page):
        plain = re.sub(r"\$\$?[^$]*\$\$?|`[^`]*`", "`x`", re.sub(r"\]\([^)]*\)", "]", paragraph))
        yield from re.split(r"(?<=[.!?:])\**\s+", plain)


def length(sentence: str) -> int:
    """Return the number of words of a sentence."""
    return sum(bool(re.search(r"\w", word)) for word in sentence.split())


def idioms(text: str) -> list[str]:
    """Return the phrases of a text that are to be avoided."""
    return [found[0] for found in IDIOM.finditer(" ".join(text.split()))]


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


def test_help_has_no_idioms() -> None:
    assert [(where, phrase) for where, text in helps() for phrase in idioms(text)] == []


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


# What the pages point to is there: other pages, files of the project, the layers of the package.
PROJECT = Path(__file__).parents[2]
LINKED_PAGES = sorted([*PROJECT.glob("*.md"), *(PROJECT / "docs").glob("*.md")])
PATH = re.compile(r"`((?:src|tests|tools|docs|scenarios)/[\w./-]*\w/?)`")


def missing(text: str) -> list[str]:
    """Return the paths in the text of a page that lead nowhere; links are those of test_examples."""
    return [path for path in PATH.findall(text) if not (PROJECT / path).exists()]


@pytest.mark.parametrize("page", LINKED_PAGES, ids=lambda page: page.name)
def test_paths_lead_somewhere(page: Path) -> None:
    assert missing(page.read_text(encoding="utf-8")) == []
    assert missing("`src/rubnoise/nowhere.py` `src/rubnoise/model.py`") == ["src/rubnoise/nowhere.py"]


# The reference pages say what the code says.


@pytest.mark.slow("design.md")
@pytest.mark.parametrize("page", generate_docs.PAGES)
def test_generated_parts_are_those_of_the_code(page: str) -> None:
    text = generate_docs.read(page)
    assert "<!-- generated: " in text
    assert generate_docs.generated(text) == text, "python tools/generate_docs.py"


def test_every_column_is_listed_under_its_group() -> None:
    text = generate_docs.read("data-format.md")
    for group in GROUPS:
        section = text.partition(f"### /{group.name}\n")[2].partition("\n##")[0]
        assert re.findall(r"^- `(\w+)`", section, re.MULTILINE) == [column.name for column in group.columns]


def test_the_smallest_scenario_is_one() -> None:
    page = generate_docs.read("scenarios.md")
    text, sweep, sizes = re.findall(r"^```toml\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert "[sweep]" in sweep
    assert 'law = "empirical"' in sizes
    assert loads(text).resolved()["sliding"]["distance"] == "2000 um"
    for key in ("mean_junction_count", "mean", "distance"):
        assert key in text
