"""Contacts beside each other, sections, and a stage that stays in sight."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.lesson.walk import CALM, UNHURRIED, Walk, opened

# Contacts beside each other on equal axes, the trace over itself, thirty swings, and a picture without stripes.
SIDES = """(() => {
  rub.fitAll();
  rub.beside.picture.redraw();
  return rub.beside.sides.map((side) => side && {
    areas: Array.from({ length: 400 }, (_, i) => side.area(side.next - 400 + i)),
    first: side.next - 400, spacing: side.spacing, top: side.top, looks: side.looks,
    counts: [...side.counts], births: side.births,
  });
})()"""
MEMORY = """(lives) => {
  document.getElementById('lag').value = lives;
  document.getElementById('lag').dispatchEvent(new Event('input'));
  return { ticks: rub.shifted.ticks(), lag: rub.shifted.lag(), found: rub.shifted.correlation() };
}"""


@pytest.fixture
def walk(browser: Any, lesson_file: str) -> Iterator[Walk]:
    """Return a walk through a page that stands still until a run is pressed."""
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        yield Walk(page)


@pytest.mark.slow
def test_a_jump_far_ahead_shows_what_a_slow_run_does(walk: Walk) -> None:
    walk.open("8. Many small")
    walk.predict()
    walk.run(1)
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(2000)")
    there = walk.page.evaluate(SIDES)[1:]
    walk.page.evaluate("rub.run.goTo(0)")
    for place in range(100, 2001, 100):
        walk.page.evaluate(f"rub.run.goTo({place}), rub.beside.picture.redraw()")
    slowly = walk.page.evaluate(SIDES)[1:]
    assert slowly == there
    for side in slowly:
        assert side["looks"] == sum(side["counts"]) == int(2000 / side["spacing"]) // 8 + 1
    walk.page.evaluate("rub.run.goTo(1000)")
    assert walk.page.evaluate(SIDES)[1:] != there


@pytest.mark.slow
def test_a_run_stays_when_another_one_runs(walk: Walk) -> None:
    """Picture and column of a run stay; a control that is turned writes into a column of its own."""
    walk.open("5. The sum")
    walk.predict()
    column = "[...document.querySelectorAll(\"[data-seen^='%d.']\")].map((cell) => cell.textContent)"
    kept: list[Any] = []
    for run, count in enumerate((2, 20, 100)):
        walk.run(run)
        walk.page.evaluate("rub.run.pause()")
        walk.slide_on()
        sides = walk.page.evaluate(SIDES)
        assert [side is not None for side in sides] == [i <= run for i in range(3)], count
        assert sides[:run] == [side for side, _ in kept]
        assert [walk.page.evaluate(column % i) for i in range(run)] == [figures for _, figures in kept]
        kept.append((sides[run], walk.page.evaluate(column % run)))
    walk.page.evaluate("rub.set({ meanCount: 50 }), rub.run.goTo(500)")
    assert "controls as they are" in walk.article.locator(".lesson-table").inner_text()
    assert [walk.page.evaluate(column % i) for i in range(3)] == [figures for _, figures in kept]


@pytest.mark.slow
def test_the_correlation_at_a_lag_is_that_of_the_trace(walk: Walk) -> None:
    walk.open("6. Memory")
    walk.predict()
    walk.run()
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(2000)")
    area = np.array(walk.page.evaluate("[...rub.run.trace.area.slice(0, rub.run.ticksSeen + 1)]"))
    life, tick, mean = walk.page.evaluate("[rub.exact().lifeMean, rub.run.trace.tick, rub.exact().areaMean]")
    left = area - mean

    def correlation(ticks: int) -> float:
        return float(np.mean(left[ticks:] * left[: left.size - ticks]) / np.mean(left**2))

    for lives in (0.0, 0.25, 0.5, 1.0, 1.25):
        told = walk.page.evaluate(MEMORY, lives)
        assert told["ticks"] == pytest.approx(lives * life / tick, abs=0.5)
        assert told["lag"] == told["ticks"] * tick
        assert told["found"] == pytest.approx(correlation(told["ticks"]), abs=0.005)  # between two lags by a line
        if 0.0 < lives < 0.9:
            assert abs(correlation(told["ticks"] + 8) - told["found"]) > 0.01


# The surfaces from the side: hills of the circles that the dotted line cuts, which meet where the circles overlap.
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


@pytest.mark.slow("meanCount=60&offset=uniform")
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
