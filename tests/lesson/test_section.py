"""The surfaces from the side: hills of the circles that the dotted line cuts, which meet where the circles overlap."""

from typing import Any

import numpy as np
import pytest

from tests.lesson.opened import CALM, UNHURRIED, opened
from tests.lesson.walk import Walk

SIDE = """(() => {
  const { stage, run } = rub;
  const rows = run.living.map((row) => [...stage.placeOf(row), row.diameter, run.distance - row.birth - row.diameter]);
  return { rows, cut: stage.cut(), scale: stage.scale, hills: rub.section.hills() };
})()"""


@pytest.mark.parametrize("count", [1, 20, 60])
def test_hills_touch_along_the_chords_that_two_circles_share(browser: Any, lesson_file: str, count: int) -> None:
    met = 0
    with opened(browser, f"{lesson_file}#meanCount={count}", init=UNHURRIED, **CALM) as page:
        assert page.locator("#section").is_visible()
        for place in (50.0, 77.7, 300.3):
            page.evaluate(f"rub.run.goTo({place})")
            side = page.evaluate(SIDE)
            rows = np.array(side["rows"]).reshape(-1, 4)
            x, y, diameter, offset = rows.T
            chord = np.sqrt(np.maximum(0.0, diameter**2 - 4.0 * (y - side["cut"]) ** 2))
            shared = np.sort((chord - np.abs(offset))[chord > np.abs(offset)]) * side["scale"]
            touching = [2 * hill["half"] - abs(hill["above"] - hill["below"]) for hill in side["hills"]]
            np.testing.assert_allclose(sorted(length for length in touching if length > 0), shared, rtol=1e-9)
            middles = {round(0.5 * (hill["above"] + hill["below"]), 6) for hill in side["hills"]}
            assert {round(each, 6) for each in (x * side["scale"])[chord > 0]} <= middles
            met += shared.size
    assert met > 0


def test_the_cut_goes_through_the_junction_that_is_chosen(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        page.evaluate("rub.run.goTo(60)")
        middle = page.evaluate("rub.stage.cut()")
        page.evaluate("rub.select(rub.run.living[2].id)")
        assert page.evaluate("rub.stage.cut()") == page.evaluate("rub.stage.placeOf(rub.run.living[2])[1]") != middle
        Walk(page).predict()
        Walk(page).open("2. Births")
        Walk(page).predict()
        Walk(page).run()
        assert page.locator("#section").is_hidden(), "a lesson's own picture takes its place"
