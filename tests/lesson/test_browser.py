"""The page in a real browser: quick, readable, accessible, and without requests."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.inference.signal import autocovariance as sample_autocovariance
from rubnoise.inference.signal import half_width_of
from rubnoise.lesson.page import LAWS, readings
from rubnoise.scenario.layers import shipped
from rubnoise.scenario.reading import load
from rubnoise.theory.second_order import area_noise, count_noise
from tests.laws.scores import seed_of
from tests.lesson.node import answer, lessons, scenario_of, world_with
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened

# The page in a real browser: it opens, plays, is quick, fits, and makes no requests.
COUNTED = """
let due = null;
let now = 0;
window.requestAnimationFrame = (f) => { due = f; };
window.work = 0;
for (const tools of [Math, CanvasRenderingContext2D.prototype]) {
  for (const [name, { value }] of Object.entries(Object.getOwnPropertyDescriptors(tools))) {
    if (typeof value !== 'function' || name === 'constructor') continue;
    tools[name] = function (...given) {
      window.work += 1;
      return value.apply(this, given);
    };
  }
}
window.frames = (count) => Array.from({ length: count }, () => {
  window.work = 0;
  now += 1000 / 60;
  due(now);
  return window.work;
});
"""
"""Frames come by call, a sixtieth of a second apart, and what is computed and drawn in each is counted in calls."""

MOST_AT_START = 400_000


def test_it_opens_and_plays_by_itself_without_much_work(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=COUNTED) as page:
        assert 0 < page.evaluate("work") < MOST_AT_START
        assert page.evaluate("rub.run.distance") == 0
        page.evaluate("frames(2)")
        assert page.evaluate("rub.run.distance") > 0
        assert page.title() == "Lessons on rubbing noise: Figure 5: excitation force and vibration"
        assert page.locator("#play").inner_text() == "❚❚ pause"


@pytest.mark.slow
@pytest.mark.parametrize("births", ["poisson", "regular"])
def test_a_run_of_the_page_is_the_model(browser: Any, lesson_file: str, births: str) -> None:
    seed = seed_of(f"a run of the page, births {births}")
    model = rubnoise.exact(scenario_of(world_with(births=births), distance=20000.0)).model
    with opened(browser, f"{lesson_file}#seed={seed}&births={births}", **CALM) as page:
        page.evaluate("rub.run.goTo(rub.run.end)")
        assert page.evaluate("rub.run.end") == 20000.0
        seen, exact = page.evaluate("rub.run.moments()"), page.evaluate("rub.exact()")
    errors = {
        "areaMean": area_noise(model).error_of_mean(20000.0),
        "countMean": count_noise(model).error_of_mean(20000.0),
    }
    for name, error in errors.items():
        assert abs(seen[name] - exact[name]) < 4.0 * error, name
        assert abs(seen[name] - 1.05 * exact[name]) > 4.0 * error, name
    # Some 1800 lives, no two of which tell of each other: a spread is known to some two parts in a hundred.
    assert seen["areaStd"] == pytest.approx(exact["areaStd"], rel=4.0 * 1.5 / sqrt(1800.0))


def test_the_page_draws_the_same_areas_as_the_package(browser: Any, lesson_file: str) -> None:
    source = rubnoise.exact(scenario_of(world_with())).model
    with opened(browser, lesson_file, **CALM) as page:
        page.evaluate("rub.run.goTo(100)")
        rows = page.evaluate("rub.run.living.map((row) => [row.birth, row.diameter])")
        total = page.evaluate("rub.run.areaAt(100)")
    areas = [float(source.pulse.area(100.0 - birth, diameter)) for birth, diameter in rows]
    assert abs(sum(areas) - total) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits(browser: Any, lesson_file: str, scheme: str) -> None:
    with opened(browser, lesson_file, viewport={"width": 360, "height": 740}, color_scheme=scheme, **CALM) as page:
        for width, height in ((360, 740), (820, 1180), (1400, 900), (1920, 1080)):
            page.set_viewport_size({"width": width, "height": height})
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            stage = page.locator("#stage").bounding_box()
            assert stage["width"] > 0.4 * min(width, 800), width
            assert page.locator("#play").bounding_box()["y"] < height, height
            inks = page.evaluate("[rub.plot.ink.ink, rub.plot.ink.ground]")
            assert inks == (["#1c1f24", "#fbfaf7"] if scheme == "light" else ["#e8eaed", "#14171b"])


def test_every_control_has_a_name(browser: Any, lesson_file: str) -> None:
    nameless = """[...document.querySelectorAll('button, input, select, canvas:not([aria-hidden])')].filter((each) => {
      const label = each.labels?.length ? [...each.labels].map((l) => l.textContent).join('') : '';
      return !(label || each.getAttribute('aria-label') || each.textContent).trim();
    }).map((each) => each.id)"""
    with opened(browser, lesson_file, **CALM) as page:
        assert page.evaluate(nameless) == []


# The lesson on reading a size: three ways beside `infer` and exact theory, and the truth that comes last.
PAGE = """
rub.lesson = { readings };
return readings.map(({ law }) => {
  const { forces, half, lag } = rub.reading.of(law);
  return { forces, half, off: rub.reading.byLag(lag), heavy: rub.reading.heavy(rub.reading.of(law)) };
});
"""


@pytest.fixture(scope="module")
def page() -> dict[str, dict[str, Any]]:
    """Return what the page makes of each trace."""
    return dict(zip(LAWS, answer(PAGE, readings=readings()), strict=True))


def given(law: str) -> dict[str, Any]:
    return next(each for each in readings() if each["law"] == law)


def exact(law: str) -> Any:
    return rubnoise.exact(load(shipped(f"lessons/read_{law}.toml")))


@pytest.mark.parametrize("law", LAWS)
def test_the_page_has_the_run_of_its_scenario_to_half_a_step_of_the_sensor(law: str, page: Any) -> None:
    run = rubnoise.simulate(load(shipped(f"lessons/read_{law}.toml")))
    off = np.abs(np.array(page[law]["forces"]) - run.trace["friction_force"][:])
    assert off.max() <= 0.501 * given(law)["step"]
    assert off.max() > 0.4 * given(law)["step"]


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_ours_is_what_infer_finds_in_the_trace_on_the_page(law: str, page: Any) -> None:
    forces, told = np.array(page[law]["forces"]), given(law)["found"]
    rate = 1000.0 / given(law)["tick"]
    found = rubnoise.infer(forces, rate=f"{rate} Hz", speed="1 mm/s", unit="uN", zero="known", law=law).estimates[
        "diameter"
    ]
    assert [told["diameter"], *told["interval"]] == pytest.approx([found.value, *found.interval], rel=1e-5)
    low, high = told["interval"]
    assert low < exact(law).mean_diameter < high
    assert not low < forces.mean() / forces.std() * found.value < high, "another number would be noticed"


@pytest.mark.parametrize("law", LAWS)
def test_the_lag_is_that_of_the_trace(law: str, page: Any) -> None:
    forces, tick = np.array(page[law]["forces"]), given(law)["tick"]
    shared = sample_autocovariance(forces, 50)
    after = int(np.argmax(shared < 0.5 * shared[0]))
    lag = np.interp(-0.5 * shared[0], -shared[after - 1 : after + 1], [after - 1, after]) * tick
    assert page[law]["half"] == pytest.approx(lag, rel=1e-9)
    assert abs(page[law]["half"] - tick * half_width_of(forces)) <= tick
    assert min(abs(page[law]["half"] - page[other]["half"]) for other in LAWS if other != law) > 1e-3


CELLS = "[...document.querySelectorAll('[data-read]')].map((each) => each.textContent).join(' ')"


@pytest.mark.slow
def test_each_trace_is_read_by_eye_first_and_the_truth_comes_last(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        walk = Walk(page)
        walk.open("9. Read the size")
        assert page.locator("#reading").is_hidden()
        walk.predict()
        walk.run(1)
        assert page.locator("#reading").is_visible()
        assert page.locator("#half").is_hidden()
        walk.article.locator("#reading-form [type=submit]").click()
        assert "Stretch the bar first" in walk.article.inner_text()
        # The bar in the middle of a picture of 120 um: an end is taken and drawn out by 5 um.
        box = page.locator("#reading").bounding_box()
        scale = (box["width"] - 54) / 120
        middle, y = box["x"] + 46 + 60 * scale, box["y"] + 0.5 * box["height"]
        page.mouse.move(middle + 2, y)
        page.mouse.down()
        page.mouse.move(middle + 5 * scale, y)
        page.mouse.up()
        assert page.evaluate("rub.reading.byEye()") == pytest.approx(5.0, abs=0.05)
        page.locator("#reading-length").focus()
        page.keyboard.press("ArrowRight")
        assert page.evaluate("rub.reading.byEye()") == pytest.approx(5.2, abs=0.21)
        assert page.evaluate(CELLS).split() == ["\u2013"] * 9
        walk.article.locator("#reading-form [type=submit]").click()
        found = given("lognormal")["found"]["diameter"]
        assert f"{found:.3g}" in page.evaluate(CELLS)
        assert page.evaluate(CELLS).count("\u2013") == 6, "the other two wait for their own readings"
        assert page.locator("#half").is_visible()
        assert page.evaluate("document.activeElement.dataset.run") == "0"
        walk.run(0)
        walk.read(18)
        assert walk.article.locator("#lesson-observe").count() == 0
        walk.run(2)
        walk.read(24)
        assert walk.article.locator('[data-read$="truth"]').count() == 0
        walk.say(1)
        assert walk.article.locator('[data-read$="truth"]').all_inner_texts() == ["8", "4", "2"]
        assert page.evaluate("rub.reading.level === rub.reading.LEVELS.truth")


# axe-core, the common judge of accessible pages, objects to nothing, in light and dark, on desks and phones.
SCREENS = [(1366, "light"), (390, "dark"), (1366, "dark"), (390, "light")]
FOUND = """async () => {
  const { violations } = await axe.run();
  return violations.flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target} ${node.failureSummary}`));
}"""


@pytest.fixture(scope="module")
def judge() -> str:
    """Return the script of axe-core."""
    base = pytest.importorskip(
        "axe_playwright_python.base", reason="NO AXE-CORE FOUND: run `python3 tools/dev.py sync all` to install it"
    )
    return str(base.AXE_SCRIPT)


def objections(page: Any, judge: str) -> list[str]:
    """Return what axe-core objects to on the page as it is."""
    page.evaluate(judge)
    return list(page.evaluate(FOUND))


@pytest.mark.slow
@pytest.mark.parametrize("screen", range(4), ids=str)
def test_axe_has_no_objection_to_any_lesson(browser: Any, lesson_file: str, judge: str, screen: int) -> None:
    """Each screen is judged with two lessons, which between them are all."""
    width, scheme = SCREENS[screen]
    look = {"viewport": {"width": width, "height": 768}, "color_scheme": scheme}
    with opened(browser, lesson_file, init=UNHURRIED, **look, **CALM) as page:
        walk = Walk(page)
        assert objections(page, judge) == []
        for lesson in lessons()[screen :: len(SCREENS)]:
            walk.open(lesson.title)
            walk.to_the_checks()
            page.evaluate("rub.run.pause()")
            walk.article.locator("#lesson-why summary").click()
            assert objections(page, judge) == [], lesson.title
        page.locator("#unfold").click()
        assert objections(page, judge) == []


@pytest.mark.slow
def test_axe_would_notice_a_control_without_a_name(browser: Any, lesson_file: str, judge: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        page.evaluate("document.querySelector('label[for=pace]').remove()")
        assert any(each.startswith("label") for each in objections(page, judge))
