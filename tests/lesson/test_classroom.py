"""The teacher's kit: larger for a projector, and a worksheet without answers where the page is printed."""

from typing import Any

import pytest

from tests.lesson.opened import CALM, UNHURRIED, opened, until
from tests.lesson.teaching import lessons
from tests.lesson.test_in_sight import IN_SIGHT, LEAST
from tests.lesson.test_no_answer_early import VERDICTS
from tests.lesson.walk import Walk

LESSONS = lessons()
SIZES = """(() => {
  const size = (selector) => parseFloat(getComputedStyle(document.querySelector(selector)).fontSize);
  const { ctx, scale } = rub.traces.pens.area;
  rub.traces.draw(rub.run.moments());
  return [size('.lesson-question'), size('#play'), parseFloat(ctx.font) * scale, ctx.lineWidth * scale];
})()"""
ANSWERS = """rub.lessons.list.map((lesson) => {
  const world = { ...rub.world, ...lesson.experiment.runs[0].set };
  const exact = rub.theory.exact(world);
  const laws = lesson.experiment.table.map((row) => row.exact(exact, world));
  const asked = lesson.checks.filter((check) => check.expected).flatMap((check) => check.expected(exact, world));
  const texts = (values) => values.map(rub.lessons.words.say).filter((text) => text.length > 3);
  return [texts([...laws, ...asked]), texts(asked)];
})"""
"""What a lesson's table and questions ask for, and what its questions alone do."""


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (1920, 1080)])
def test_a_projector_shows_larger_type_and_lines(browser: Any, lesson_file: str, width: int, height: int) -> None:
    screen = {"width": width, "height": height}
    with opened(browser, lesson_file, init=UNHURRIED, viewport=screen, **CALM) as page:
        walk = Walk(page)
        walk.open("5. The sum")
        walk.predict()
        walk.run()
        page.evaluate("rub.run.pause(), rub.show('area'), rub.fitAll()")
        before = page.evaluate(SIZES)
        page.keyboard.press("b")
        assert page.locator("#projector").get_attribute("aria-pressed") == "true"
        assert all(after > 1.15 * size for size, after in zip(before, page.evaluate(SIZES), strict=True))
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        walk.run(2)
        assert page.evaluate(IN_SIGHT) >= LEAST
        page.evaluate("rub.run.pause(), scrollTo(0, 0)")
        row = page.evaluate("rub.run.living[3]")
        x, y = page.evaluate("rub.stage.pointOf(rub.run.living[3])")
        page.locator("#stage").click(position={"x": x, "y": y})
        assert page.evaluate("rub.run.selected") == row["id"]
        page.evaluate("rub.run.goTo(0), rub.set(rub.lessons.list[4].experiment.runs[0].set), rub.show('area')")
        page.locator("#projector").click()
        page.evaluate("rub.fitAll()")
        assert page.evaluate(SIZES) == before


def test_a_print_is_a_worksheet_without_answers(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        assert page.locator("#sheet").count() == 0
        page.emulate_media(media="print")
        until(page, "document.getElementById('sheet') !== null")
        sheet = page.locator("#sheet")
        text = sheet.inner_text()
        assert page.inner_text("body").strip() == text.strip(), "nothing else is printed"
        for lesson in LESSONS:
            assert text.count(lesson.title) == 2, "once to play, once afterwards"
        blanks = page.locator("#sheet .sheet-blank").count()
        boxes = page.locator("#sheet .sheet-boxes li").count()
        questions = sum(len(lesson.rows) for lesson in LESSONS)
        assert (blanks > 3 * len(LESSONS), boxes > 4 * len(LESSONS)) == (True, True)
        assert page.locator("#sheet > section").count() == 2 * len(LESSONS)
        assert page.locator("#sheet h1.sheet-after ~ section > p").count() >= questions
        assert page.locator("#sheet input, #sheet button").count() == 0
        assert page.locator("#sheet td").all_inner_texts() == [""] * page.locator("#sheet td").count()
        assert [each for each in (*VERDICTS, "Show the law") if each in text] == []
        for lesson, answers in zip(LESSONS, page.evaluate(ANSWERS), strict=True):
            parts = page.locator("#sheet > section", has_text=lesson.title).all_inner_texts()
            for part, forbidden in zip(parts, answers, strict=True):
                assert [answer for answer in forbidden if answer in part] == [], lesson.title
        assert page.pdf(format="A4")[:5] == b"%PDF-"
        page.emulate_media(media="screen")
        until(page, "document.getElementById('sheet') === null")
        assert page.locator("#lessons").is_visible()
