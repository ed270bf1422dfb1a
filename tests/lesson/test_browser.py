"""The page in a real browser: it opens, plays, is quick, fits, and makes no requests."""

from math import sqrt
from typing import Any

import pytest

import rubnoise
from rubnoise.theory.occupancy import mean_count_error
from rubnoise.theory.sampling import mean_area_error
from tests.lesson.opened import CALM, opened, until
from tests.lesson.worlds import scenario_of, world_with
from tests.verification.seeds import seed_of

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
MOST_IN_A_FRAME = 50_000
MOST_NOW_AND_THEN = 600_000
"""Calls of mathematics and of the canvas: until the page plays, in most frames, and where text is written anew.

Twice what there are; a call takes some ten to a hundred ns, so that most frames leave time of their sixtieth second.
"""


def test_it_opens_and_plays_by_itself_without_much_work(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=COUNTED) as page:
        assert 0 < page.evaluate("work") < MOST_AT_START
        assert page.evaluate("rub.run.distance") == 0
        page.evaluate("frames(2)")
        assert page.evaluate("rub.run.distance") > 0
        assert page.title() == "Figure 5: excitation force and vibration"
        assert page.locator("#play").inner_text() == "❚❚ pause"


def test_frames_are_light_with_two_hundred_junctions_and_stay_so(browser: Any, lesson_file: str) -> None:
    """Also where much has been seen: a frame that went through the whole run would have ever more to do."""
    with opened(browser, f"{lesson_file}#meanCount=200&meanArea=1000", init=COUNTED) as page:
        page.evaluate("rub.run.pace = 50")
        early = page.evaluate("frames(100)")
        assert page.evaluate("rub.run.living.length") > 150
        page.evaluate("rub.run.goTo(0.9 * rub.run.end); rub.run.play()")
        late = page.evaluate("frames(100)")
    assert max(sorted(frames)[len(frames) // 2] for frames in (early, late)) < MOST_IN_A_FRAME
    assert max(early + late[1:]) < MOST_NOW_AND_THEN


@pytest.mark.parametrize("births", ["poisson", "regular"])
def test_a_run_of_the_page_is_the_model(browser: Any, lesson_file: str, births: str) -> None:
    seed = seed_of(f"a run of the page, births {births}")
    model = rubnoise.exact(scenario_of(world_with(births=births), distance=20000.0)).model
    with opened(browser, f"{lesson_file}#seed={seed}&births={births}", **CALM) as page:
        page.evaluate("rub.run.goTo(rub.run.end)")
        assert page.evaluate("rub.run.end") == 20000.0
        seen, exact = page.evaluate("rub.run.moments()"), page.evaluate("rub.exact()")
    errors = {"areaMean": mean_area_error(model, 20000.0), "countMean": mean_count_error(model, 20000.0)}
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


def test_the_spectrum_so_far_is_the_exact_one(browser: Any, lesson_file: str) -> None:
    ratio = """(() => {
      rub.run.goTo(rub.run.end);
      const { wavenumber, density, segments } = rub.estimates.spectrum();
      const means = [];
      for (let i = 4; i < 204; i += 1) means.push(density[i] / rub.exact().spectrum(wavenumber[i]));
      return { segments, means };
    })()"""
    with opened(browser, f"{lesson_file}#spread=1&seed={seed_of('a spectrum of the page')}", **CALM) as page:
        found = page.evaluate(ratio)
    means = found["means"]
    # A bin of one Hann window has the spread of its mean, and each half of a window adds less than a whole one would.
    error = 1.5 / sqrt(found["segments"] * len(means) / 2)
    assert abs(sum(means) / len(means) - 1.0) < 4.0 * error + 0.01


def test_memory_ends_with_a_life(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, **CALM) as page:
        page.evaluate("rub.run.goTo(rub.run.end)")
        found = page.evaluate("rub.estimates.memory()")
        exact = page.evaluate("rub.estimates.memory().lag.map((lag) => rub.exact().autocovariance(lag))")
    assert found["value"][0] == 1.0
    assert max(abs(a - b / exact[0]) for a, b in zip(found["value"], exact, strict=True)) < 0.12
    assert exact[-1] == pytest.approx(0.0, abs=1e-9)


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


def test_who_wants_nothing_to_move_starts_it_himself(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, **CALM) as page:
        page.wait_for_timeout(200)
        assert page.evaluate("rub.run.distance") == 0
        page.locator("#play").click()
        until(page, "rub.run.distance > 0")


def test_every_control_has_a_name(browser: Any, lesson_file: str) -> None:
    nameless = """[...document.querySelectorAll('button, input, select, canvas:not([aria-hidden])')].filter((each) => {
      const label = each.labels?.length ? [...each.labels].map((l) => l.textContent).join('') : '';
      return !(label || each.getAttribute('aria-label') || each.textContent).trim();
    }).map((each) => each.id)"""
    with opened(browser, lesson_file, **CALM) as page:
        assert page.evaluate(nameless) == []
