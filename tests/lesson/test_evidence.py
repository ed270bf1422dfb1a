"""After each lesson: does the evidence on the screen support the answer that the lesson says is right?"""

import re
from typing import Any

import numpy as np
import pytest

from rubnoise.arrays import Doubles
from tests.lesson.node import lessons
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened

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
SOUNDS = """([lesson, rate]) => {
  const { experiment } = rub.lessons.list[lesson];
  const before = [rub.run.distance, rub.run.rows.length];
  const made = rub.lessons.sounds.compare(experiment, rate);
  const velocities = experiment.runs.map((run) => rub.theory.exact({ ...rub.world, ...run.set }).velocityStd);
  const kept = String(before) === String([rub.run.distance, rub.run.rows.length]);
  return { samples: made.samples.map((each) => [...each]), factor: made.factor, velocities, kept };
}"""
RATE = 12_000
PEAK = 0.8


def laptop(samples: Doubles) -> float:
    """Return the level in dB re full scale between 200 and 4000 Hz."""
    power = np.abs(np.fft.rfft(samples * np.hanning(samples.size))) ** 2
    frequency = np.fft.rfftfreq(samples.size, 1 / RATE)
    band = (frequency >= 200) & (frequency <= 4000)
    return float(10 * np.log10(np.mean(samples**2) * power[band].sum() / power.sum()))


def test_a_laptop_plays_the_noisier_of_two_runs_louder(walk: Walk) -> None:
    """Few large against many small: levels differ as velocities do; each at its own peak they sound alike."""
    found = walk.page.evaluate(SOUNDS, [7, RATE])
    few, many = (np.array(each) for each in found["samples"])
    assert few.size == many.size > RATE
    assert found["kept"], "the run on the stage stays as it is"
    assert found["factor"] == 8
    wanted = 20 * np.log10(found["velocities"][0] / found["velocities"][1])
    assert laptop(few) - laptop(many) == pytest.approx(wanted, abs=2.5)
    assert wanted > 12
    assert min(laptop(few), laptop(many)) > -40, "both can be heard"
    own = [laptop(PEAK * each / np.abs(each).max()) for each in (few, many)]
    assert abs(own[0] - own[1]) < 4, "what one scale is for"


def test_a_run_is_heard_where_it_stands(walk: Walk) -> None:
    walk.open("8. Many small")
    walk.predict()
    assert walk.article.locator("[data-sound]").count() == 0
    walk.run(0)
    walk.page.evaluate("rub.run.pause()")
    before = walk.page.locator("#stage").bounding_box()
    walk.article.locator("[data-sound]").nth(1).click()
    assert "8 times faster" in walk.article.locator("#lesson-running").inner_text()
    assert walk.page.locator("#stage").bounding_box() == before
    walk.page.locator("#sound-play").click()
    assert walk.page.locator("#sound-play").inner_text() == "♪ listen"


def test_the_printed_file_has_every_page_of_the_sheet(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        pages = re.findall(rb"/Type\s*/Page\b(?!s)", page.pdf(format="A4"))
        assert 7 <= len(pages) <= 10
        assert page.locator("#sheet").count() == 0, "it is gone after the print"
        assert page.locator("[data-open]").count() >= len(TITLES)
