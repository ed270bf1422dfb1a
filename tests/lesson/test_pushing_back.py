"""The second half of the lesson on the slider, in a real browser: what it opens, shows and asks."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.lesson.page import page as page_text
from rubnoise.lesson.page import record_of
from rubnoise.lesson.settings import settings_of
from rubnoise.scenario import load
from tests.architecture.sources import ROOT
from tests.lesson.walk import CALM, Walk, opened

TWO_WAY = ROOT / "scenarios" / "paper" / "fig5_two_way.toml"
GIVEAWAYS = ("stick", "stuck", "slips", "friction would turn round")
TITLE = "7. The slider"
SEEN = "rub.run.moments()"


@pytest.fixture(scope="module")
def two_way_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the address of the page of the paper's Figure 5 with a slider that pushes back."""
    path = tmp_path_factory.mktemp("lesson") / "two-way.html"
    path.write_text(page_text("two-way", settings_of(load(TWO_WAY))), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def page(browser: Any, two_way_file: str) -> Iterator[Any]:
    """Return that page, standing still."""
    with opened(browser, two_way_file, **CALM) as found:
        yield found


def to_the_switch(walk: Walk) -> None:
    walk.open(TITLE)
    walk.to_the_checks()
    walk.article.locator("#further-predict").get_by_role("radio").nth(0).check()
    walk.article.locator("#further-predict [type=submit]").click()


def said(walk: Walk) -> str:
    return str(walk.article.inner_text()).lower()


@pytest.mark.slow
def test_nothing_is_given_away_before_the_prediction(walk: Walk) -> None:
    walk.open(TITLE)
    walk.to_the_checks()
    walk.article.locator("#lesson-why summary").click()
    assert walk.article.locator("#lesson-law-text").is_visible()
    assert [word for word in GIVEAWAYS if word in said(walk)] == []
    assert [walk.article.locator(each).count() for each in ("#further-switch", "#further-why")] == [0, 0]
    assert walk.page.locator("#number-stuck").is_hidden()
    assert walk.page.locator("#key-stuck").is_hidden()
    assert walk.forms.count() == 2
    walk.article.locator("#further-predict [type=submit]").click()
    assert "choose first" in said(walk)
    walk.article.locator("#further-predict").get_by_role("radio").nth(0).check()
    walk.article.locator("#further-predict [type=submit]").click()
    assert walk.article.locator("#further-why").count() == 0
    walk.article.get_by_label("The slider pushes back").check()
    walk.article.locator("#further-why summary").click()
    assert all(word in said(walk) for word in GIVEAWAYS)


@pytest.mark.slow
def test_the_switch_changes_the_coupling_and_not_the_contact(walk: Walk) -> None:
    to_the_switch(walk)
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(120)")
    before = walk.page.evaluate("[rub.run.rows.slice(0, 99), rub.run.distance, rub.run.trace.area[500]]")
    swings = walk.page.evaluate(SEEN)
    walk.article.get_by_label("The slider pushes back").check()
    assert walk.page.evaluate("[rub.run.rows.slice(0, 99), rub.run.distance, rub.run.trace.area[500]]") == before
    assert walk.page.locator("#knob-coupling").input_value() == "two-way"
    seen = walk.page.evaluate(SEEN)
    assert seen["stuckShare"] > 0.3 > swings["stuckShare"] == 0.0
    assert seen["velocityStd"] < 0.5 * swings["velocityStd"]
    assert walk.page.locator("#one-way-warning").is_hidden()
    walk.page.locator("#knob-coupling").select_option("one-way")
    assert walk.article.get_by_label("The drive\u2019s speed is constant").is_checked()
    assert walk.page.evaluate(SEEN) == swings


def test_a_two_way_run_is_replayed(browser: Any, tmp_path: Path) -> None:
    scenario = load(TWO_WAY, ["sliding.distance=60 um"])
    with rubnoise.run(scenario, tmp_path / "run.h5") as run:
        births = run.junctions["birth_distance"][:].tolist()
        motion = run.groups()["slider"]
        ends = float(motion["time"][-1]), float(motion["displacement"][-1])
        (tmp_path / "replay.html").write_text(page_text("a run", settings_of(run.scenario), record_of(run)))
    with opened(browser, (tmp_path / "replay.html").as_uri(), **CALM) as page:
        page.evaluate("rub.run.goTo(rub.run.end)")
        assert page.evaluate("rub.run.rows.map((row) => row.birth)") == births
        assert page.evaluate(f"rub.run.motion.at('displacement', {ends[0]!r})") == pytest.approx(ends[1], abs=0.05)
