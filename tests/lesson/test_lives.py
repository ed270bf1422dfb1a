"""Life-lines and the histogram of the count: the lanes, the line of now, and Poisson's bars."""

from collections import Counter
from typing import Any

import numpy as np
import pytest
from scipy import stats

from tests.lesson.opened import CALM, UNHURRIED, opened

ROWS = "rub.run.rows.map((row, i) => [row.birth, row.death, rub.lives.lanes[i]])"
COUNTS = "Array.from(rub.lives.counts.seen, (count) => count ?? 0)"
DRAWN = "rub.lives.draw(), rub.lives.drawCounts()"


@pytest.fixture
def page(browser: Any, lesson_file: str) -> Any:
    """Return the page with all traces, 1000 um on."""
    with opened(browser, f"{lesson_file}#spread=1.5", init=UNHURRIED, **CALM) as found:
        found.locator("#unfold").click()
        found.evaluate("rub.run.goTo(1000)")
        found.evaluate(DRAWN)
        yield found


def test_no_two_lives_of_a_lane_overlap_and_each_has_one(page: Any) -> None:
    rows = page.evaluate(ROWS)
    ends: dict[int, float] = {}
    for birth, death, lane in rows:
        assert ends.get(lane, birth) <= birth
        ends[lane] = death
    assert len(rows) > 500
    assert len(ends) < 50, "a lane is used again"


def test_the_line_of_now_crosses_as_many_lives_as_are_alive(page: Any) -> None:
    rows = page.evaluate(ROWS)
    for place in (1000.0, 700.5, 33.3):
        page.evaluate(f"rub.run.goTo({place})")
        page.evaluate(DRAWN)
        crossed = [lane for birth, death, lane in rows if birth <= place < death]
        assert len(crossed) == page.evaluate("rub.run.living.length")
        assert len(set(crossed)) == len(crossed)


def test_the_histogram_counts_every_tick_once(page: Any) -> None:
    for place in (1000.0, 400.0, 1200.0):
        page.evaluate(f"rub.run.goTo({place})")
        page.evaluate(DRAWN)
        counts = page.evaluate("Array.from(rub.run.trace.count.subarray(0, rub.run.ticksSeen + 1))")
        expected = Counter(int(count) for count in counts)
        seen = {count: number for count, number in enumerate(page.evaluate(COUNTS)) if number}
        assert seen == expected


@pytest.mark.parametrize("mean", [0.5, 2.0, 20.0, 400.0])
def test_the_bars_are_those_of_poisson(page: Any, mean: float) -> None:
    found = np.array(page.evaluate(f"rub.lives.poisson({mean}, 600)"))
    np.testing.assert_allclose(found, stats.poisson.pmf(np.arange(601), mean), rtol=1e-10, atol=1e-15)
    assert np.abs(found - stats.norm.pdf(np.arange(601), mean, mean**0.5)).max() > 1e-4
