"""The lesson on reading a size: three ways beside `infer` and exact theory, and the truth that comes last."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import rubnoise
from rubnoise.analysis.covariance import autocovariance as sample_autocovariance
from rubnoise.inference.signal import half_width_of
from rubnoise.lesson.readings import LAWS, half_lag, readings
from rubnoise.scenario.reading import load
from rubnoise.scenario.shipped import shipped
from tests.lesson.node import answer
from tests.lesson.opened import CALM, UNHURRIED, opened
from tests.lesson.walk import Walk
from tests.lesson.worlds import scenario_of, world_with

PAGE = """
rub.lesson = { readings };
return readings.map(({ law }) => {
  const { forces, half, lag } = rub.reading.of(law);
  return { forces, half, off: rub.reading.byLag(lag), heavy: rub.reading.heavy(rub.reading.of(law)) };
});
"""
OFF = {"normal": 1.2, "lognormal": 2.6, "exponential": 5.3}
"""Rabinowicz's diameter over the mean one, as docs/inference.md prints it."""


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


@pytest.mark.parametrize("law", LAWS)
def test_rabinowicz_is_off_as_theory_says(law: str, page: Any) -> None:
    equal = rubnoise.exact(scenario_of(world_with(spread=0.0)))
    theory = exact(law)
    off = half_lag(theory) / theory.mean_diameter / (half_lag(equal) / equal.mean_diameter)
    assert page[law]["off"] / given(law)["diameter"] == pytest.approx(off, rel=1e-7)
    assert off == pytest.approx(OFF[law], abs=0.051)
    assert given(law)["diameter"] == theory.mean_diameter


@pytest.mark.parametrize("law", LAWS)
def test_half_of_the_noise_comes_from_those_above(law: str, page: Any) -> None:
    sizes, heavy = exact(law).model.sizes, page[law]["heavy"]
    density = lambda d: float(sizes.density(np.array([d]))[0])  # noqa: E731
    weight = quad(lambda d: d**5 * density(d), heavy["above"], 200.0, limit=200)[0] / sizes.moment(5)
    assert weight == pytest.approx(0.5, abs=0.005)
    assert heavy["share"] == pytest.approx(quad(density, heavy["above"], 200.0, limit=200)[0], rel=0.02)


CELLS = "[...document.querySelectorAll('[data-read]')].map((each) => each.textContent).join(' ')"


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


def test_a_teacher_who_skips_sees_all_readings(walk: Walk) -> None:
    walk.open("9. Read the size")
    walk.article.get_by_role("button", name="Skip").click()
    walk.run(2)
    assert walk.article.locator('[data-read$="truth"]').all_inner_texts() == ["8", "4", "2"]
    assert walk.article.locator("#reading-form").count() == 0
