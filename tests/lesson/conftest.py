"""A real browser for the page of lessons; where there is none, its tests are skipped and say so."""

from collections.abc import Iterator
from typing import Any

import pytest

from rubnoise.lesson.page import page
from rubnoise.scenario import load
from tests.architecture.sources import ROOT
from tests.lesson.walk import UNHURRIED, Walk


@pytest.fixture(scope="session")
def lesson_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the address of the page of the paper's Figure 5."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.html"
    scenario = load(ROOT / "scenarios" / "paper" / "fig5.toml")
    path.write_text(page(scenario.title, scenario), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def walk(browser: Any, lesson_file: str) -> Iterator[Walk]:
    """Return a walk through a page that was just opened, on which nothing goes wrong."""
    page = browser.new_page(viewport={"width": 1400, "height": 900})
    failures: list[str] = []
    page.on("pageerror", lambda error: failures.append(str(error)))
    page.on("console", lambda message: failures.append(message.text) if message.type == "error" else None)
    page.add_init_script(UNHURRIED)
    page.goto(lesson_file)
    yield Walk(page)
    assert failures == []
    page.close()
