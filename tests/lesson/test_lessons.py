"""The lessons in a real browser: what opens when, with the keyboard alone, and no answer early."""

from typing import Any

import pytest

from tests.lesson.node import lessons
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened

pytestmark = pytest.mark.slow

# The lessons in a real browser: what opens when, which answers are right, and what is kept.
LESSONS = lessons()
PHONE = {"viewport": {"width": 360, "height": 740}, "is_mobile": True, "has_touch": True}
NO_STORAGE = """
for (const name of ["localStorage", "sessionStorage", "indexedDB"]) {
  Object.defineProperty(window, name, { get() { throw new Error("off"); } });
}
"""

NAMELESS = """
[...document.querySelectorAll("#lessons input, #lessons button")].filter((each) => {
  const labels = each.labels?.length ? [...each.labels] : [each];
  return !labels.map((label) => label.textContent).join("").trim();
}).length
"""


def test_nothing_opens_before_its_time_and_the_answers_of_the_teachers_page_are_right(walk):
    for lesson in LESSONS:
        walk.open(lesson.title)
        assert walk.article.locator("[data-run]").count() == 0, lesson.title
        assert walk.forms.count() == 0, lesson.title
        walk.article.locator("#lesson-predict [type=submit]").click()
        assert "Choose first" in walk.article.locator("#lesson-predict").inner_text(), lesson.title
        walk.predict()
        assert walk.article.locator("[data-run]").count() > 0, lesson.title
        assert walk.article.locator("#lesson-why").count() == 0, lesson.title
        walk.page.evaluate("rub.run.pause()")
        walk.run()
        assert walk.page.evaluate("rub.run.playing"), lesson.title
        assert walk.article.locator("#lesson-why").count() == 0, lesson.title
        assert "What is right" not in walk.article.inner_text(), lesson.title
        assert walk.forms.count() == 0, lesson.title
        walk.look()
        assert walk.article.locator("#lesson-why").count() == 1, lesson.title
        walk.run()
        assert walk.forms.count() == len(lesson.rows) > 0, lesson.title
        for question, row in enumerate(lesson.rows):
            said = {text: walk.answer(question, text) for text in [*row.wrong, *row.right]}
            assert [text for text in row.wrong if said[text][0]] == [], lesson.title
            assert [text for text in row.right if not said[text][0]] == [], lesson.title
            assert all(len(said[text][1]) > len("Not yet. ") for text in row.wrong), "a refusal says why"
        assert "done" in walk.end, lesson.title
        assert walk.page.get_by_role("button", name=f"{lesson.title} ✓ done").count() == 1


def test_a_prediction_is_held_against_what_is_right(walk):
    walk.open("2. Births")
    walk.predict(1)
    walk.run()
    walk.look()
    assert "You expected: the shortest ones. So it is." in walk.article.inner_text()
    walk.article.get_by_role("button", name="Start this lesson again").click()
    walk.predict(0)
    walk.run()
    walk.look()
    assert "What is right: the shortest ones." in walk.article.inner_text()


def test_progress_is_kept_in_the_address_where_storage_is_off(browser, lesson_file):
    context = browser.new_context()
    context.add_init_script(NO_STORAGE + UNHURRIED)
    page = context.new_page()
    page.goto(lesson_file)
    walk = Walk(page)
    walk.open("4. Who is alive?")
    walk.predict(2)
    walk.run()
    walk.look()
    page.wait_for_url(lambda url: "spread=2" in url)
    address = page.url
    context.close()
    context = browser.new_context()
    page = context.new_page()
    page.goto(address)
    kept = Walk(page)
    assert kept.article.locator("h3").inner_text() == "4. Who is alive?"
    assert kept.article.locator("input:checked").get_attribute("value") == "smaller"
    assert kept.answer(0, "7.65 µm")[0]
    context.close()


def test_a_phone_shows_every_lesson_without_scrolling_sideways_and_names_its_controls(browser, lesson_file):
    context = browser.new_context(**PHONE)
    context.add_init_script(UNHURRIED)
    page = context.new_page()
    page.goto(lesson_file)
    walk = Walk(page)
    for lesson in LESSONS:
        walk.open(lesson.title)
        walk.to_the_checks()
        assert page.evaluate(NAMELESS) == 0, lesson.title
        for form in walk.forms.all():
            assert form.get_by_role("status").count() == 1, lesson.title
        walk.article.locator("summary").click()
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["viewport"]["width"], lesson.title
    context.close()


# A lesson with the keyboard alone, from the first control of the page to the last answer.
MOST_STOPS = 80


def go_to(page, selector):
    """Press Tab until an element has the focus."""
    for _ in range(MOST_STOPS):
        if page.evaluate("selector => document.activeElement.matches(selector)", selector):
            return
        page.keyboard.press("Tab")
    pytest.fail(f"Tab does not lead to {selector}")


def press(page, *keys):
    for key in keys:
        page.keyboard.press(key)


def focused(page):
    return page.evaluate("document.activeElement.id || document.activeElement.textContent")


def test_a_lesson_from_the_list_to_the_last_answer(walk):
    page = walk.page
    go_to(page, '[data-open="1"]')
    press(page, "Enter")
    assert focused(page) == "lesson-title"
    go_to(page, 'input[name="prediction"]')
    press(page, "Space", "ArrowDown", "Enter")
    assert focused(page) == "▶ Births at random"
    press(page, "Enter")
    assert page.evaluate("rub.run.playing")
    assert focused(page) == "▶ Births at random"
    go_to(page, '[data-act="ahead"]')
    press(page, "Enter")
    press(page, "Shift+Tab", "Enter")
    go_to(page, '[data-act="ahead"]')
    press(page, "Enter")
    assert "200 lives" in page.locator("#lesson-running").inner_text()
    go_to(page, 'input[name="observation"]')
    press(page, "Space", "ArrowDown", "Enter")
    assert focused(page) == "Show the law"
    press(page, "Enter")
    assert page.locator("#lesson-law-text").is_visible()
    go_to(page, "#check-longer")
    page.keyboard.type("1/e")
    press(page, "Enter")
    go_to(page, "#check-swing")
    page.keyboard.type("10")
    press(page, "Enter")
    assert walk.end == "Lesson done."
    go_to(page, '.lesson [data-open="2"]')
    press(page, "Space")
    assert page.locator("#lesson-title").inner_text() == "3. The live count"


# No answer of a lesson is on the page before its prediction: neither in its text nor in the lines of its pictures.
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
            page.evaluate("rub.select(rub.run.living[0]?.id ?? -1)")
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


# What stands before a prediction, and what can be played with.
