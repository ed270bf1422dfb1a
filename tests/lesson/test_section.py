"""The surfaces from the side: hills of the circles that the dotted line cuts, which meet where the circles overlap."""

from typing import Any

import numpy as np
import pytest

from tests.lesson.opened import CALM, UNHURRIED, opened
from tests.lesson.walk import Walk

SIDE = """(() => {
  const { stage, run } = rub;
  const along = (row) => run.distance - 0.5 * (row.birth + row.death);
  const rows = run.living.map((row) => [...stage.placeOf(row), row.diameter, along(row), row.offset]);
  return { rows, cut: stage.cut(), scale: stage.scale, hills: rub.section.hills() };
})()"""


def touching(hill: dict[str, float]) -> float:
    """Return the length along which the tops of a pair of hills meet, in pixels."""
    if not (hill["halfBelow"] and hill["halfAbove"]):
        return 0.0
    left = max(hill["below"] - hill["halfBelow"], hill["above"] - hill["halfAbove"])
    return max(0.0, min(hill["below"] + hill["halfBelow"], hill["above"] + hill["halfAbove"]) - left)


@pytest.mark.parametrize("knobs", ["meanCount=1", "meanCount=20", "meanCount=60", "meanCount=60&offset=uniform"])
def test_hills_touch_along_the_chords_that_two_circles_share(browser: Any, lesson_file: str, knobs: str) -> None:
    met = 0
    with opened(browser, f"{lesson_file}#{knobs}", init=UNHURRIED, **CALM) as page:
        assert page.locator("#section").is_visible()
        for place in (50.0, 77.7, 300.3):
            page.evaluate(f"rub.run.goTo({place})")
            side = page.evaluate(SIDE)
            x, y, diameter, along, across = np.array(side["rows"]).reshape(-1, 5).T
            # The lower circle lies half of both distances back and up, the upper one as far on and down.
            ends = []
            for way in (-0.5, 0.5):
                half = 0.5 * np.sqrt(np.maximum(0.0, diameter**2 - 4.0 * (y + way * across - side["cut"]) ** 2))
                ends.append((x + way * along - half, x + way * along + half, half))
            (left, right, below), (from_left, to_right, above) = ends
            length = np.minimum(right, to_right) - np.maximum(left, from_left)
            met_here = (length > 0) & (below > 0) & (above > 0)
            shared = np.sort(length[met_here]) * side["scale"]
            found = sorted(part for part in map(touching, side["hills"]) if part > 0)
            np.testing.assert_allclose(found, shared, rtol=1e-9)
            middles = {round(0.5 * (hill["above"] + hill["below"]), 6) for hill in side["hills"]}
            assert {round(each, 6) for each in (x * side["scale"])[(below > 0) | (above > 0)]} <= middles
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
