"""What the pages point to is there: other pages, files of the project, the layers of the package."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
LINK = re.compile(r"\]\((?!https?://|#|mailto:)([^)#\s]+)")
PATH = re.compile(r"`((?:src|tests|tools|docs|scenarios)/[\w./-]*\w/?)`")


def missing(page: Path, text: str) -> list[str]:
    """Return the links and paths in the text of a page that lead nowhere."""
    links = [link for link in LINK.findall(text) if not (page.parent / link).exists()]
    return links + [path for path in PATH.findall(text) if not (ROOT / path).exists()]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_paths_lead_somewhere(page: Path) -> None:
    assert missing(page, page.read_text(encoding="utf-8")) == []


def test_a_dead_link_is_found() -> None:
    text = "[a](nowhere.md) [b](model.md) [c](https://example.org) `src/rubnoise/nowhere.py` `src/rubnoise/model.py`"
    assert missing(ROOT / "docs" / "model.md", text) == ["nowhere.md", "src/rubnoise/nowhere.py"]


def test_every_place_of_the_design_page_exists() -> None:
    text = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    table = text.partition("\n## ")[2].partition("\n## ")[0]
    places = re.findall(r"`([a-z_]+(?:/[a-z_]+\.py|/|\.py))`", table)
    assert len(places) > 15
    assert [place for place in places if not (ROOT / "src" / "rubnoise" / place).exists()] == []


def test_the_design_page_shows_the_layers_of_the_contract() -> None:
    text = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^    (cli > .*)$", text, re.MULTILINE)
    contract = (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("layers = [")[2].partition("]")[0]
    layers = [set(re.findall(r"\w+", line)) for line in contract.splitlines() if line.strip()]
    told = [set(layer.split(", ")) for layer in shown.split(" > ")]
    assert set().union(*told) >= {name for layer in layers for name in layer if exists(name)}
    assert told == [kept for layer in layers if (kept := layer & set().union(*told))]


def exists(name: str) -> bool:
    """Return whether a layer has a module or package."""
    package = ROOT / "src" / "rubnoise"
    return (package / name).is_dir() or (package / f"{name}.py").is_file()
