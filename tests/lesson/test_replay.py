"""A run on the page: its own rows, its own slider, until a knob of the contact leaves it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.lesson.page import page as page_text
from rubnoise.lesson.replay import record_of
from rubnoise.lesson.settings import settings_of
from tests.lesson.opened import CALM, opened
from tests.lesson.worlds import scenario_of, world_with


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[rubnoise.api.Run]:
    """Return a short run with a slider."""
    path = tmp_path_factory.mktemp("run") / "short <i>run.h5"
    with rubnoise.run(scenario_of(world_with(seed=11), distance=300.0), path) as found:
        yield found


@pytest.fixture
def page(browser: Any, run: rubnoise.api.Run, tmp_path: Path) -> Iterator[Any]:
    """Return the page that replays the run, standing still."""
    file = tmp_path / "replay.html"
    file.write_text(page_text("a run", settings_of(run.scenario), record_of(run)), encoding="utf-8")
    with opened(browser, file.as_uri(), **CALM) as found:
        yield found


def test_it_is_the_run(page: Any, run: rubnoise.api.Run) -> None:
    page.evaluate("rub.run.goTo(rub.run.end)")
    assert page.evaluate("rub.run.end") == 300.0
    assert page.evaluate("rub.run.rows.map((row) => row.birth)") == run.junctions["birth_distance"][:].tolist()
    area = page.evaluate("[...rub.run.trace.area.subarray(0, rub.run.trace.ready)]")
    assert max(abs(run.trace["real_contact_area"][:] - area)) < 1e-9
    told = page.locator("#replaying").inner_text()
    assert told.startswith("This is short <i>run.h5, seed 11: its junctions, row by row.")


def test_the_slider_may_change_and_the_run_stays(page: Any) -> None:
    page.evaluate("rub.run.goTo(100)")
    rows = page.evaluate("rub.run.rows[40]")
    page.evaluate("rub.set({ damping: 1, strength: 500 }, { restart: false })")
    assert page.evaluate("rub.replaying") is True
    assert page.evaluate("rub.run.distance") == 100
    assert page.evaluate("rub.run.rows[40]") == rows | {"strength": 500}
    page.evaluate("rub.run.goTo(300)")
    assert set(page.evaluate("rub.run.rows.map((row) => row.strength)")) == {500}


def test_a_knob_of_the_contact_leaves_the_run_and_reset_returns(page: Any, run: rubnoise.api.Run) -> None:
    first = run.junctions["birth_distance"][0]
    page.evaluate("rub.set({ meanCount: 30 })")
    assert page.evaluate("rub.replaying") is False
    assert page.locator("#replaying").is_hidden()
    assert page.evaluate("rub.run.rows[0].birth") != first
    page.locator("#reset").click()
    assert page.locator("#replaying").is_visible()
    assert page.evaluate("rub.run.rows[0].birth") == first
