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
from tests.lesson.node import pushing_back
from tests.lesson.walk import CALM, Walk, opened, painted, until

TWO_WAY = ROOT / "scenarios" / "paper" / "fig5_two_way.toml"
GIVEAWAYS = ("stick", "stuck", "slips", "friction would turn round")
TITLE = "7. The slider"
SEEN = "rub.run.moments()"
SHADED = """(name) => {
  const { canvas } = rub.traces.pens[name];
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const wanted = getComputedStyle(document.documentElement).getPropertyValue('--stuck').trim();
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(wanted.slice(at, at + 2), 16));
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  let found = 0;
  for (let i = 0; i < data.length; i += 4) found += data[i] === r && data[i + 1] === g && data[i + 2] === b;
  return found / (canvas.width * canvas.height);
}"""
"""The share of a trace that is shaded as stuck."""


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


def test_the_second_half_waits_for_the_first(walk: Walk) -> None:
    walk.open(TITLE)
    assert walk.article.locator("#further-predict").count() == 0
    walk.predict()
    assert walk.article.locator("#further-predict").count() == 0
    walk.run()
    assert walk.article.locator("#further-predict").count() == 0
    walk.look()
    assert walk.article.locator("#further-predict").count() == 1


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


def test_its_answers_are_right_and_the_mistakes_are_not(walk: Walk) -> None:
    to_the_switch(walk)
    walk.article.locator('[data-further="run"]').click()
    assert walk.page.evaluate("rub.run.playing && rub.world.coupling === 'two-way'")
    assert "what is right: smaller: it rides" in said(walk)
    assert walk.forms.count() == 2 + len(pushing_back())
    for question, row in enumerate(pushing_back(), start=2):
        answers = {text: walk.answer(question, text) for text in [*row.wrong, *row.right]}
        assert [text for text in row.wrong if answers[text][0]] == []
        assert [text for text in row.right if not answers[text][0]] == []
        assert all(len(answers[text][1]) > len("Not yet. ") for text in row.wrong), "a refusal says why"


def test_the_address_keeps_it(walk: Walk, browser: Any) -> None:
    to_the_switch(walk)
    assert "2aA" in walk.page.url
    walk.article.locator('[data-further="run"]').click()
    until(walk.page, "location.hash.includes('two-way')")
    with opened(browser, walk.page.url, **CALM) as other:
        assert other.locator("#further-predict input:checked").get_attribute("value") == "same"
        assert other.locator("#further-why").count() == 1
        assert other.get_by_label("The slider pushes back").is_checked()
        assert other.evaluate("rub.run.motion !== null")


def test_other_experiments_turn_the_switch_back(walk: Walk) -> None:
    to_the_switch(walk)
    walk.article.locator('[data-further="run"]').click()
    walk.run(1)
    assert walk.page.evaluate("[rub.world.coupling, rub.world.damping]") == ["one-way", 0.5]
    assert walk.article.get_by_label("The drive\u2019s speed is constant").is_checked()


def test_a_two_way_scenario_opens_with_the_switch_turned(page: Any) -> None:
    assert page.locator("#knob-coupling").input_value() == "two-way"
    assert page.locator("article.lesson h3").inner_text() == TITLE
    assert page.evaluate("rub.run.motion !== null && rub.given.coupling") == "two-way"
    page.evaluate("rub.set({ coupling: 'one-way' })")
    page.locator("#reset").click()
    assert page.evaluate("rub.run.motion !== null")


def test_sticks_are_shaded_and_the_velocity_is_clipped(page: Any) -> None:
    page.locator("#unfold").click()
    page.locator("#reveal").click()
    page.evaluate("rub.run.goTo(300)")
    until(page, "rub.run.goal < 0")
    painted(page)
    for name in ("force", "slider", "velocity"):
        assert page.evaluate(SHADED, name) > 0.1, name
        page.evaluate("rub.set({ coupling: 'one-way' }, { restart: false })")
        painted(page)
        assert page.evaluate(SHADED, name) == 0.0, name
        page.evaluate("rub.set({ coupling: 'two-way' }, { restart: false })")
        painted(page)
    assert page.evaluate("rub.run.motion.range.velocity[1]") == page.evaluate("rub.world.speed")
    assert page.locator("#key-stuck").is_visible()
    assert page.locator("#number-stuck td").nth(1).inner_text() != ""
    assert page.locator("#number-displacement-std td").first.inner_text() == "\u2013"


def test_back_and_forth_the_same_is_seen(page: Any) -> None:
    there = page.evaluate("rub.run.goTo(200), [rub.run.time, rub.run.distance, rub.run.moments()]")
    page.evaluate("rub.run.goTo(400), rub.run.goTo(0), rub.run.goTo(200)")
    assert page.evaluate("[rub.run.time, rub.run.distance, rub.run.moments()]") == there
    for _ in range(6):
        before = page.evaluate("rub.run.distance")
        page.locator("#step").click()
        assert page.evaluate("rub.run.distance") > before


def test_a_jump_too_far_for_one_frame_continues_in_the_next(page: Any) -> None:
    page.evaluate("rub.run.goTo(rub.run.end)")
    assert page.evaluate("rub.run.goal") == page.evaluate("rub.run.end")
    assert 0.0 < page.evaluate("rub.run.distance") < page.evaluate("rub.run.end")
    first = page.evaluate("rub.run.distance")
    until(page, f"rub.run.distance > {first!r} + 20")
    page.evaluate("rub.run.goTo(10)")
    assert page.evaluate("[rub.run.goal, rub.run.distance]") == [-1, 10]


def test_births_and_deaths_are_told_once_where_the_slider_turns_back(page: Any) -> None:
    page.evaluate("""() => {
      rub.set({ meanCount: 5, speed: 20000, damping: 0.001, mass: 0.05 });
      window.told = [];
      rub.on('birth', (row) => told.push(['birth', row.id]));
      rub.on('death', (row) => told.push(['death', row.id]));
      rub.run.play();
      for (let i = 0; i < 4000 && rub.run.reached < 200; i += 1) rub.run.advance(0.05);
      rub.run.pause();
    }""")
    told = page.evaluate("told")
    assert len(told) > 10
    assert len(set(map(tuple, told))) == len(told)
    assert page.evaluate("rub.run.reached") >= 200


@pytest.mark.parametrize("what", ["velocity", "force"])
def test_it_can_be_heard(page: Any, what: str) -> None:
    page.locator("#sound-what").select_option(what)
    page.locator("#sound-speed").select_option("0.25")
    made = page.evaluate("(() => { const s = rub.sound.samples(8000); return { ...s, samples: [...s.samples] }; })()")
    assert made["factor"] == 0.25
    assert len(made["samples"]) == pytest.approx(4 * 8000, abs=2)
    assert max(map(abs, made["samples"])) == pytest.approx(0.8, rel=1e-6)
    middle = page.evaluate(f"rub.run.motion.at('{what}', {1000 * 0.25 / 8000!r})")
    assert made["samples"][1000] == pytest.approx(0.8 * (middle - made["mean"]) / made["peak"], abs=1e-6)


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


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1024, 1440])
def test_it_fits_and_says_nothing(browser: Any, two_way_file: str, width: int, scheme: str) -> None:
    address = f"{two_way_file}#lesson=slider&progress=0.0.0.0.0.0.2bCr.0"
    with opened(browser, address, viewport={"width": width, "height": 900}, color_scheme=scheme) as page:
        until(page, "rub.run.time > 0")
        page.locator("#further-why summary").click()
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator("#mass").bounding_box()["width"] > 0.4 * min(width, 800)
