"""The lessons in a real browser: what opens when, with the keyboard alone, and no answer early."""

import math
import re
from typing import Any

import pytest

from tests.lesson.node import lessons
from tests.lesson.walk import CALM, UNFOLD, UNHURRIED, Walk, opened, painted, until

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


@pytest.mark.parametrize(("run", "answer"), [(1, "13.75 %"), (2, "6,15 %")])
def test_what_is_asked_follows_the_knobs(walk, run, answer):
    walk.open("5. The sum")
    walk.to_the_checks()
    walk.run(run)
    assert not walk.answer(0, "43.5 %")[0]
    assert walk.answer(0, answer)[0]


def test_an_answer_to_other_knobs_stands_no_more(walk):
    walk.open("5. The sum")
    walk.to_the_checks()
    walk.run(0)
    assert walk.answer(0, "43.5 %")[0]
    walk.run(1)
    assert walk.forms.nth(0).get_attribute("data-verdict") is None
    assert walk.forms.nth(0).get_by_role("status").inner_text() == ""


def test_a_question_is_not_judged_under_other_births(walk):
    walk.open("3. The live count")
    walk.to_the_checks()
    walk.page.evaluate(UNFOLD)
    walk.page.locator("#knob-births").select_option("regular")
    right, said = walk.answer(0, "120")
    assert not right
    assert "births" in said
    walk.run()
    assert walk.answer(0, "120")[0]


def test_a_teacher_may_skip_and_sees_the_law_at_once(walk):
    walk.open("2. Births")
    walk.article.get_by_role("button", name="Skip").click()
    walk.run()
    assert "the law" in walk.article.locator(".lesson-table").inner_text()
    assert "What is right: the shortest ones." in walk.article.inner_text()


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


def test_what_is_seen_is_asked_when_enough_has_been_seen(walk):
    walk.open("2. Births")
    walk.predict()
    walk.run()
    walk.page.evaluate("rub.run.pause()")
    assert "gone on for 40 lives" in walk.article.inner_text()
    assert walk.article.locator("#lesson-observe").count() == 0
    walk.slide_on()
    assert walk.article.locator("#lesson-observe").count() == 0, "the other run is not there"
    walk.run(1)
    walk.slide_on()
    walk.article.locator("#lesson-observe [type=submit]").click()
    assert "Choose first" in walk.article.locator("#lesson-observe").inner_text()
    assert "What is right" not in walk.article.inner_text()


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


def test_another_address_opens_another_lesson(walk, lesson_file):
    walk.open("1. One life")
    walk.predict()
    walk.page.goto(f"{lesson_file}#lesson=slider&progress=3c.0.0.0.0.0.1b.0")
    walk.article.get_by_role("heading", name="7. The slider").wait_for()
    assert walk.article.locator("input:checked").get_attribute("value") == "ring"
    assert walk.page.get_by_role("button", name="1. One life ✓ done").count() == 1


@pytest.mark.parametrize("address", ["#lesson=nothing&progress=9z.x", "#progress=3q.2a99.1", "#lesson=sum&progress=3"])
def test_an_address_that_says_nonsense_opens_what_it_can(browser, lesson_file, address):
    page = browser.new_page()
    failures = []
    page.on("pageerror", lambda error: failures.append(str(error)))
    page.add_init_script(UNHURRIED)
    page.goto(lesson_file + address)
    walk = Walk(page)
    assert walk.article.locator("h3").count() == 1
    assert walk.article.locator("[data-run]").count() == 0
    assert failures == []
    page.close()


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


def test_a_choice_is_made_with_the_arrows(walk):
    page = walk.page
    walk.open("5. The sum")
    walk.to_the_checks()
    go_to(page, 'input[name="check-bell"]')
    press(page, "Space", "Enter")
    assert "all diameters are equal" in page.locator("#check-bell-verdict").inner_text()
    press(page, "ArrowDown", "Enter")
    assert page.locator("#check-bell-verdict").inner_text() == "Right."


def test_typing_an_answer_moves_nothing_else(walk):
    """Letters that are keys of the stage are letters in an answer."""
    page = walk.page
    walk.open("1. One life")
    walk.to_the_checks()
    before = page.evaluate("[rub.run.playing, rub.run.pace, rub.run.selected]")
    go_to(page, "#check-fraction")
    page.keyboard.type("ken0+-p")
    assert page.evaluate("[rub.run.playing, rub.run.pace, rub.run.selected]") == before
    assert page.locator("#check-fraction").input_value() == "ken0+-p"


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
    with opened(browser, lesson_file, **CALM) as page:
        Walk(page).open(lesson)
        page.locator("#unfold").click()
        painted(page)
        before = page.evaluate(inked)
        page.evaluate("rub.emit('veil')")
        painted(page)
        assert page.evaluate(inked) == before
        page.locator("#reveal").click()
        painted(page)
        assert page.evaluate(inked) != before


# What stands before a prediction, and what can be played with.
MOST_WORDS = 60
WORDS = """rub.lessons.list.flatMap(({ question, opening = '', further }) =>
  [question + opening, further?.question].filter(Boolean).map((html) => {
    const text = document.createElement('div');
    text.innerHTML = html;
    return text.textContent.trim().split(/\\s+/).length;
  }))"""


def test_little_is_to_be_read_before_a_prediction(walk):
    assert max(walk.page.evaluate(WORDS)) <= MOST_WORDS
    assert "knob" not in walk.page.inner_text("body").lower()


def test_controls_that_a_lesson_does_not_need_are_folded(walk):
    needed = walk.page.evaluate("rub.lessons.list.map((lesson) => lesson.controls)")
    for lesson, controls in enumerate(needed):
        walk.page.evaluate(f"rub.lessons.open({lesson})")
        shown = walk.page.locator("#side .knob:visible").evaluate_all(
            "all => all.map((each) => each.querySelector('label').htmlFor.replace('knob-', ''))"
        )
        assert sorted(shown) == sorted(controls)
        walk.page.locator("#more-controls summary").click()
        assert walk.page.locator("#side .knob:visible").count() == 14
        walk.page.locator("#more-controls summary").click()


@pytest.mark.parametrize(
    ("lesson", "key", "factor"),
    [(1, "diameter", 10.0), (4, "meanCount", 1.0), (4, "diameter", 10.0), (6, "speed", 10.0)],
)
def test_a_number_in_the_text_can_be_dragged(walk, lesson, key, factor):
    value = {"diameter": "rub.exact().diameter", "meanCount": "rub.world.meanCount", "speed": "rub.world.speed"}[key]
    walk.page.evaluate(f"rub.lessons.open({lesson})")
    walk.predict()
    walk.run(0)
    walk.page.evaluate("rub.run.pause()")
    number = walk.article.locator(f"[data-drag={key}]")
    number.scroll_into_view_if_needed()
    before, box = walk.page.evaluate(value), number.bounding_box()
    assert box["height"] >= 24
    if key == "meanCount":
        number.focus()
        walk.page.keyboard.press("ArrowRight")
        assert walk.page.evaluate(value) == before + 1
        return
    x, y = box["x"] + 3, box["y"] + 10
    walk.page.mouse.move(x, y)
    walk.page.mouse.down()
    walk.page.mouse.move(x + 80, y, steps=4)
    walk.page.mouse.up()
    assert walk.page.evaluate(value) == pytest.approx(before * factor**0.5, rel=0.02)
    assert number.get_attribute("aria-valuetext") == number.inner_text()


def test_a_click_lets_a_junction_be_born(walk):
    strip = walk.page.locator("#born")
    strip.click()
    strip.press("Enter")
    assert walk.page.evaluate("rub.born.lives.length") == 2
    until(walk.page, "rub.born.lives.length === 0")


def test_the_cursor_measures_ten_swings(walk):
    walk.open("7. The slider")
    walk.predict()
    walk.run(0)
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(6000)")
    walk.article.locator("[data-act=measure]").click()
    said = walk.article.locator("#lesson-running").inner_text()
    assert said.startswith("Ten swings over ")
    own = walk.page.evaluate("rub.exact().naturalFrequency")
    damping = walk.page.evaluate("rub.exact().dampingRatio")
    # Ten swings of a narrow band of half-width damping x frequency hold some 20 pi damping independent phases.
    measured = float(re.search(r": ([0-9.]+) a second", said)[1])
    assert abs(measured / own - 1) < 4 * (damping / (20 * math.pi)) ** 0.5
    box = walk.page.locator("#slider").bounding_box()
    walk.page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 40)
    walk.page.mouse.down()
    walk.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 40, steps=3)
    walk.page.mouse.up()
    assert " swings over " in walk.page.inner_text("#status")
