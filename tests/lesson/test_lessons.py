"""The lessons in a real browser: what opens when, which answers are right, and what is kept."""

import pytest

from tests.lesson.opened import UNHURRIED
from tests.lesson.teaching import lessons
from tests.lesson.walk import Walk

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


def test_the_answers_of_the_teachers_page_are_right_and_the_mistakes_are_not(walk):
    for lesson in LESSONS:
        walk.open(lesson.title)
        walk.to_the_checks()
        assert walk.forms.count() == len(lesson.rows), lesson.title
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
    assert walk.answer(0, "43.5 %")[0]
    walk.run(1)
    assert walk.forms.nth(0).get_attribute("data-verdict") is None
    assert walk.forms.nth(0).get_by_role("status").inner_text() == ""


def test_a_question_is_not_judged_under_other_births(walk):
    walk.open("3. The live count")
    walk.to_the_checks()
    walk.page.locator("#knob-births").select_option("regular")
    right, said = walk.answer(0, "120")
    assert not right
    assert "births" in said
    walk.run()
    assert walk.answer(0, "120")[0]


def test_nothing_opens_before_its_time(walk):
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
        assert walk.forms.count() > 0, lesson.title


def test_a_teacher_may_skip_and_sees_the_law_at_once(walk):
    walk.open("2. Births")
    walk.article.get_by_role("button", name="Skip").click()
    walk.run()
    assert "the law" in walk.article.locator("thead").inner_text()
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
    assert "gone on for 10 lives" in walk.article.inner_text()
    assert walk.article.locator("#lesson-observe").count() == 0
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


def test_a_phone_shows_every_lesson_without_scrolling_sideways(browser, lesson_file):
    context = browser.new_context(**PHONE)
    context.add_init_script(UNHURRIED)
    page = context.new_page()
    page.goto(lesson_file)
    walk = Walk(page)
    for lesson in LESSONS:
        walk.open(lesson.title)
        walk.to_the_checks()
        walk.article.locator("summary").click()
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["viewport"]["width"], lesson.title
    context.close()


def test_controls_have_names_and_verdicts_are_announced(walk):
    for lesson in LESSONS:
        walk.open(lesson.title)
        walk.to_the_checks()
        assert walk.page.evaluate(NAMELESS) == 0, lesson.title
        for form in walk.forms.all():
            assert form.get_by_role("status").count() == 1, lesson.title
