"""Every link between pages leads somewhere: to a file of the repository, to a heading, to a picture with a text."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT

FOLDERS = (".", "docs", "notebooks", "paper", "tools/site", "packaging", ".github")
SITE_ONLY = {"install.md", "lesson.md", "viewer.md", "outputs.md", "README.md", "docs", "commands.md", "python.md"}
"""What the start page of the site links to: pages beside it there."""
FENCED = re.compile(r"^```.*?^```$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)
PAGES = sorted(path for folder in FOLDERS for path in (ROOT / folder).glob("*.md"))


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


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path) -> None:
    assert list(broken(page, page.read_text(encoding="utf-8"))) == []


def test_every_picture_is_shown() -> None:
    pages = " ".join(page.read_text(encoding="utf-8") for page in PAGES)
    pictures = [path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs" / "pictures").rglob("*.png")]
    assert [each for each in pictures if each not in pages] == []


def test_every_page_is_on_the_site() -> None:
    start = (ROOT / "tools" / "site" / "index.md").read_text(encoding="utf-8")
    names = [
        path.relative_to(ROOT).with_suffix("").as_posix() for path in PAGES if path.parent in (ROOT, ROOT / "docs")
    ]
    assert [name for name in names if f"\n{name}\n" not in start] == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[a](nowhere.md)", "nowhere.md: no such file"),
        ("[a](model.md#nothing-here)", "model.md#nothing-here: no such heading"),
        ("[a](#nothing-here)", "#nothing-here: no such heading"),
        ("![](pictures/fig5.png)", "pictures/fig5.png: a picture without a text"),
        ("[a](../../etc)", "../../etc: no such file"),
    ],
)
def test_a_broken_link_is_found(text: str, said: str) -> None:
    assert list(broken(ROOT / "docs" / "theory.md", text)) == [said]
    assert list(broken(ROOT / "docs" / "theory.md", f"`{text}`\n```\n{text}\n```\n")) == []
