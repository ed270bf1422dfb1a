"""axe-core, the common judge of accessible pages, objects to nothing, in light and dark, on desks and phones."""

from typing import Any

import pytest

from tests.lesson.opened import CALM, UNHURRIED, opened
from tests.lesson.teaching import lessons
from tests.lesson.walk import Walk

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


def test_axe_would_notice_a_control_without_a_name(browser: Any, lesson_file: str, judge: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        page.evaluate("document.querySelector('label[for=pace]').remove()")
        assert any(each.startswith("label") for each in objections(page, judge))
