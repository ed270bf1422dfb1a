"""No answer of a lesson is on the page before its prediction: neither in its text nor in the lines of its pictures."""

from typing import Any

import pytest

from tests.lesson.opened import CALM, UNHURRIED, opened
from tests.lesson.teaching import lessons
from tests.lesson.walk import Walk

LESSONS = lessons()
EXACT = """(() => {
  const e = rub.exact();
  const mean = e.areaStd / e.areaMean;
  const met = e.contact.sizes.std > 0 ? e.lengthBiasedMean : NaN;
  const values = [e.countStd, e.areaStd, mean, 100 * mean, e.skewness, met, e.displacementStd, e.oneWay,
    e.naturalFrequency, e.forceStd * 1e-3, e.lifeAreaMean];
  return [4, 6].flatMap((digits) => values.map((value) => rub.plot.said(value, digits)));
})()"""
"""What the lessons ask for, of the contact on the stage, as the page would write it."""
CELLS = "[...document.querySelectorAll('#numbers td:not(:last-child)')].map((cell) => cell.textContent).join('')"
VERDICTS = ("What is right", "So it is", "of its mean, that", "chips!")


def leaked(page: Any) -> list[str]:
    """Return the answers that stand in the text of the page."""
    text = page.inner_text("body")
    numbers = [value for value in page.evaluate(EXACT) if len(value) > 3]
    return [each for each in (*numbers, *VERDICTS) if each in text]


def test_no_answer_is_in_the_text_before_its_prediction(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        walk = Walk(page)
        for lesson in LESSONS:
            walk.open(lesson.title)
            page.evaluate("rub.run.goTo(500)")
            page.evaluate("rub.select(rub.run.living[0].id)")
            assert leaked(page) == [], lesson.title
            assert page.evaluate(CELLS) == "", lesson.title
            assert page.evaluate("rub.readout.veiled()"), lesson.title
            walk.predict()
            walk.run()
            page.evaluate("rub.run.pause()")
            assert [each for each in VERDICTS if each in page.inner_text("body")] == [], lesson.title
            assert page.evaluate(CELLS) != "", lesson.title
            walk.look()
            assert page.inner_text("#number-count td") != "", lesson.title


def test_an_answer_that_leaks_would_be_noticed(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        page.locator("#reveal").click()
        assert len(leaked(page)) > 5
        assert page.locator("#numbers-hint").is_hidden()
        Walk(page).open("3. The live count")
        assert leaked(page) == []


@pytest.mark.parametrize("lesson", ["3. The live count", "5. The sum"])
def test_the_lines_of_the_law_wait_for_the_prediction(browser: Any, lesson_file: str, lesson: str) -> None:
    inked = "document.getElementById('count').toDataURL()"
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        Walk(page).open(lesson)
        page.locator("#unfold").click()
        page.wait_for_timeout(300)
        before = page.evaluate(inked)
        page.evaluate("rub.emit('veil')")
        page.wait_for_timeout(300)
        assert page.evaluate(inked) == before
        page.locator("#reveal").click()
        page.wait_for_timeout(300)
        assert page.evaluate(inked) != before
