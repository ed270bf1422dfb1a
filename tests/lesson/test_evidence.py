"""After each lesson: does the evidence on the screen support the answer that the lesson says is right?"""

from typing import Any

import pytest

from tests.lesson.node import lessons
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened

pytestmark = pytest.mark.slow

TITLES = [lesson.title for lesson in lessons()]
SEEDS = (1, 2)
FIGURES = """() => {
  const { list, state, kept } = rub.lessons;
  const lesson = list[state.open];
  const known = state.lessons[state.open];
  const { run, row } = lesson.evidence;
  const text = (name) => document.querySelector(`[data-${name}="${run}.${row}"]`).textContent;
  const cell = (name) => Number(text(name).split(' ')[0].replace('\u2212', '-'));
  return { spoken: kept.spoken(lesson, known).right ?? false, seen: cell('seen'), law: cell('exact') };
}"""
ALIKE = 1.0 + 5.0 * 0.2**2
"""Lives count with d^5 in R, so the lag reads E[d^6]/E[d^5] at most, 1 + 5 cv^2 means where sizes spread by cv = 0.2.

What is read as more must be beyond that once more: chosen.
"""
LARGER = """() => rub.lesson.readings.map(({ diameter, lag }) => rub.reading.byLag(lag) / diameter)"""


@pytest.mark.parametrize("title", TITLES)
def test_the_evidence_on_the_screen_supports_the_answer(browser: Any, lesson_file: str, title: str) -> None:
    """When the lesson asks, with several seeds; an observation is answered with what the table shows."""
    for seed in SEEDS:
        with opened(browser, f"{lesson_file}#seed={seed}", init=UNHURRIED, **CALM) as page:
            walk = Walk(page)
            walk.open(title)
            walk.predict()
            if title.startswith("9"):
                normal, *others = page.evaluate(LARGER)
                assert normal < ALIKE
                assert min(others) > ALIKE**2
                return
            for run in range(walk.article.locator("[data-run]").count()):
                assert walk.article.locator("#lesson-observe").count() == 0, "it asks when all runs are there"
                walk.run(run)
                page.evaluate("rub.run.pause()")
                lives = page.evaluate("rub.lessons.lives(rub.lessons.list[rub.lessons.state.open])")
                page.evaluate(f"rub.run.goTo({lives} * rub.exact().lifeMean), rub.lessons.refresh()")
            walk.say(0)
            found = page.evaluate(FIGURES)
            assert found["spoken"], (seed, found)
            said = walk.article.locator(".lesson-look").inner_text()
            assert str(found["seen"])[:4].replace("-", "\u2212") in said


# Sounds of runs that are compared, and the sheet that is printed.
