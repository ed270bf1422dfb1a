"""The stage stays in sight while a lesson is played, on projectors, desks and phones."""

from collections.abc import Callable
from typing import Any

import pytest

from tests.lesson.opened import CALM, UNHURRIED, opened
from tests.lesson.teaching import lessons
from tests.lesson.walk import Walk

SCREENS = {1024: 768, 1366: 768, 1440: 900, 1920: 1080, 390: 844}
LEAST = 0.6  # of the stage
TITLES = tuple(lesson.title for lesson in lessons())
IN_SIGHT = """(() => {
  const stage = document.getElementById('stage');
  const box = stage.getBoundingClientRect();
  const rows = Array.from({ length: 20 }, (_, i) => box.top + ((i + 0.5) / 20) * box.height);
  const columns = Array.from({ length: 5 }, (_, i) => box.left + ((i + 0.5) / 5) * box.width);
  const seen = rows.flatMap((y) => columns.map((x) => document.elementFromPoint(x, y) === stage));
  return seen.filter(Boolean).length / seen.length;
})()"""
"""Share of the stage that the window shows and that nothing else covers."""


def play(page: Any, titles: tuple[str, ...] = TITLES) -> dict[str, float]:
    """Play every lesson to its checks; return the share of the stage in sight after each press."""
    walk = Walk(page)
    found = {}
    for opened_title in titles:

        def press(name: str, act: Callable[[], object], title: str = opened_title) -> None:
            act()
            found[f"{title}: {name}"] = page.evaluate(IN_SIGHT)

        press("open", lambda title=opened_title: walk.open(title))
        press("predict", walk.predict)
        for run in range(walk.article.locator("[data-run]").count()):
            press(f"run {run}", lambda run=run: walk.run(run))
            press(f"ahead {run}", walk.slide_on)
        press("look", walk.say)
        press("law", walk.article.locator("#lesson-why summary").click)
        for question in range(walk.forms.count()):
            press(f"check {question}", walk.forms.nth(question).get_by_role("button", name="Check").click)
    return found


@pytest.mark.parametrize("width", SCREENS)
def test_the_stage_is_in_sight_after_every_press(browser: Any, lesson_file: str, width: int) -> None:
    screen = {"width": width, "height": SCREENS[width]}
    with opened(browser, lesson_file, init=UNHURRIED, viewport=screen, **CALM) as page:
        shares = play(page)
        assert len(shares) > 7 * len(TITLES)
        assert {run: share for run, share in shares.items() if share < LEAST} == {}


def test_a_stage_that_is_scrolled_away_would_be_noticed(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, viewport={"width": 390, "height": 844}, **CALM) as page:
        page.evaluate("document.getElementById('pictures').style.position = 'static'")
        page.evaluate("Element.prototype.scrollIntoView = () => {}")
        assert min(play(page, TITLES[1:3]).values()) < LEAST


def test_all_traces_unfold_under_the_stage(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, viewport={"width": 1366, "height": 768}, **CALM) as page:
        walk = Walk(page)
        walk.to_the_checks()
        assert page.locator("#force").is_hidden()
        page.locator("#unfold").click()
        for name in ("area", "count", "force", "slider", "panel-canvas"):
            page.locator(f"#{name}").scroll_into_view_if_needed()
            assert page.evaluate(IN_SIGHT) >= LEAST, name
        ends = "['area', 'count', 'force'].map((id) => document.getElementById(id).getBoundingClientRect().right)"
        assert len({round(end) for end in page.evaluate(ends)}) == 1, "a bump in area stands over its bump in force"


def test_a_phone_has_the_lesson_on_its_first_screen(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, viewport={"width": 390, "height": 844}, **CALM) as page:
        top = page.locator(".lesson-question").bounding_box()["y"]
        assert top < 0.6 * 844
        assert page.locator("#knobs").bounding_box()["y"] > top
