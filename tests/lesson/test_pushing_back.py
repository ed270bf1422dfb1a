"""The lesson on a slider that pushes back, in a real browser: what it opens, shows and asks."""

from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.lesson.page import page as page_text
from rubnoise.lesson.page import record_of
from rubnoise.scenario import load
from tests.architecture.sources import ROOT
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened

TWO_WAY = ROOT / "scenarios" / "paper" / "fig5_two_way.toml"
GIVEAWAYS = ("stick", "stuck", "slips", "friction would turn round")
TITLE = "12. It pushes back"
SEEN = "rub.run.moments()"


@pytest.fixture(scope="module")
def two_way_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the address of the page of the paper's Figure 5 with a slider that pushes back."""
    path = tmp_path_factory.mktemp("lesson") / "two-way.html"
    path.write_text(page_text("two-way", load(TWO_WAY)), encoding="utf-8")
    return path.as_uri()


def said(walk: Walk) -> str:
    return str(walk.article.inner_text()).lower()


@pytest.mark.slow
def test_nothing_is_given_away_before_the_observation(browser: Any, two_way_file: str) -> None:
    with opened(browser, two_way_file, init=UNHURRIED, **CALM) as page:
        walk = Walk(page)
        assert walk.article.locator("h3").inner_text() == TITLE, "a scenario whose slider pushes back is about it"
        walk.predict()
        walk.run(1)
        assert [word for word in GIVEAWAYS if word in said(walk)] == []
        walk.slide_on()
        walk.run(0)
        walk.slide_on()
        walk.say()
        walk.article.locator("#lesson-why summary").click()
        assert all(word in said(walk) for word in GIVEAWAYS)


@pytest.mark.slow
def test_both_runs_have_one_contact(walk: Walk) -> None:
    walk.open(TITLE)
    walk.predict()
    walk.run(0)
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(120)")
    before = walk.page.evaluate("[rub.run.rows.slice(0, 99), rub.run.distance, rub.run.trace.area[500]]")
    swings = walk.page.evaluate(SEEN)
    assert walk.page.locator("#number-stuck").is_hidden()
    assert walk.page.locator("#key-stuck").is_hidden()
    walk.run(1)
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(120)")
    assert walk.page.evaluate("[rub.run.rows.slice(0, 99), rub.run.distance, rub.run.trace.area[500]]") == before
    assert walk.page.locator("#knob-coupling").input_value() == "two-way"
    seen = walk.page.evaluate(SEEN)
    assert seen["stuckShare"] > 0.3 > swings["stuckShare"] == 0.0
    assert seen["velocityStd"] < 0.5 * swings["velocityStd"]
    assert walk.page.locator("#one-way-warning").is_hidden()
    assert walk.article.locator('[data-seen="0.0"]').inner_text() != "\u2013", "what the first run showed stays"
    walk.page.locator("#knob-coupling").select_option("one-way")
    assert walk.page.evaluate(SEEN) == swings


def test_a_two_way_run_is_replayed(browser: Any, tmp_path: Path) -> None:
    scenario = load(TWO_WAY, ["sliding.distance=60 um"])
    with rubnoise.run(scenario, tmp_path / "run.h5") as run:
        births = run.junctions["birth_distance"][:].tolist()
        motion = run.groups()["slider"]
        ends = float(motion["time"][-1]), float(motion["displacement"][-1])
        (tmp_path / "replay.html").write_text(page_text("a run", run.scenario, record_of(run)))
    with opened(browser, (tmp_path / "replay.html").as_uri(), **CALM) as page:
        page.evaluate("rub.run.goTo(rub.run.end)")
        assert page.evaluate("rub.run.rows.map((row) => row.birth)") == births
        assert page.evaluate(f"rub.run.motion.at('displacement', {ends[0]!r})") == pytest.approx(ends[1], abs=0.05)
