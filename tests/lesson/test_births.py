"""Junctions that the page draws, their life-lines and histogram, and runs that it plays again."""

from collections.abc import Iterator
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

import rubnoise
from rubnoise.lesson.page import page as page_text
from rubnoise.lesson.page import record_of
from tests.laws.scores import seed_of
from tests.lesson.node import answer, scenario_of, world_with
from tests.lesson.walk import CALM, UNHURRIED, opened

# What the page draws: junctions of a stationary contact, from a seed, as theory says that they are.
LARGEST_Z = 4.0
STARTS = 4000
MISSES = """
const births = new rub.model.Births(world);
const rows = [];
births.until(distance, rows);
const found = (list) => list.map((row) => [row.offset / row.diameter, row.death - row.birth, row.diameter]);
return [found(rows.filter((row) => row.birth <= 0)), found(rows.filter((row) => row.birth > 0))];
"""
MANY_STARTS = """
const found = { count: [], diameter: [], age: [], first: [] };
for (let i = 0; i < starts; i += 1) {
  const births = new rub.model.Births({ ...world, seed: seed + i });
  const rows = [];
  births.until(0, rows);
  found.count.push(rows.length);
  rows.forEach((row) => found.diameter.push(row.diameter) && found.age.push(-row.birth));
  found.first.push(births.next);
}
return found;
"""
ONE_RUN = """
const births = new rub.model.Births(world);
const rows = [];
births.until(distance, rows);
return rows.filter((row) => row.birth > 0).map((row) => [row.birth, row.diameter]);
"""


def z_score(values: list[float], mean: float, variance: float) -> float:
    return (float(np.mean(values)) - mean) / sqrt(variance / len(values))


@pytest.mark.slow
@pytest.mark.parametrize("births", ["poisson", "regular"])
def test_a_start_is_stationary(births: str) -> None:
    world = world_with(births=births, spread=1.5, meanCount=4.0)
    theory = rubnoise.exact(scenario_of(world))
    sizes = theory.model.sizes
    found = answer(MANY_STARTS, world=world, starts=STARTS, seed=seed_of(f"starts {births}") % 2**40)
    assert abs(z_score(found["count"], theory.count_mean, theory.count_variance)) < LARGEST_Z
    first, second, third = (sizes.moment(power) for power in (1, 2, 3))
    mean, square = second / first, third / first  # who is alive is met in proportion to the length of the life
    assert abs(z_score(found["diameter"], mean, square - mean**2)) < LARGEST_Z
    assert abs(z_score(found["diameter"], sizes.moment(1), square - mean**2)) > LARGEST_Z
    # Ages at one place of regular births tell of each other, all the less so the wider sizes are spread.
    mean, square = second / first, 4.0 / 3.0 * third / first  # uniform on a life of 2 d
    assert abs(z_score(found["age"], mean, square - mean**2)) < LARGEST_Z


def test_passes_miss_the_centre_line_as_theory_says() -> None:
    """At birth b/d is uniform; alive at the start it has the density (2/pi) sqrt(1 - (b/d)^2), of variance 1/4."""
    world = world_with(offset="uniform", calibration="exact", meanCount=400.0, seed=seed_of("passes of the page"))
    model = rubnoise.exact(scenario_of(world)).model
    alive, born = map(np.array, answer(MISSES, world=world, distance=200.0))
    part, life, diameter = born.T
    np.testing.assert_allclose(life, 2.0 * diameter * np.sqrt(1.0 - part**2), rtol=1e-9)
    assert abs(z_score(list(part), 0.0, 1.0 / 3.0)) < LARGEST_Z
    assert abs(z_score(list(part**2), 1.0 / 3.0, 1.0 / 5.0 - 1.0 / 9.0)) < LARGEST_Z
    assert abs(z_score(list(life / diameter), np.pi / 2.0, 8.0 / 3.0 - np.pi**2 / 4.0)) < LARGEST_Z
    assert abs(z_score(list(life / diameter), 2.0, 8.0 / 3.0 - np.pi**2 / 4.0)) > LARGEST_Z
    assert abs(z_score(list(alive[:, 0] ** 2), 1.0 / 4.0, 1.0 / 8.0 - 1.0 / 16.0)) < LARGEST_Z
    assert abs(z_score(list(alive[:, 0] ** 2), 1.0 / 3.0, 1.0 / 8.0 - 1.0 / 16.0)) > LARGEST_Z
    assert abs(len(alive) - model.mean_junction_count) < LARGEST_Z * sqrt(model.mean_junction_count)


def test_gaps_are_exponential_and_sizes_normal() -> None:
    world = world_with(spread=2.0, seed=seed_of("a run of the page"))
    model = rubnoise.exact(scenario_of(world)).model
    rows = np.array(answer(ONE_RUN, world=world, distance=20000.0))
    gaps = np.diff(rows[:, 0]) / model.mean_birth_spacing
    assert gaps.size > 30000
    for power, (mean, variance) in {1: (1.0, 1.0), 2: (2.0, 20.0), 3: (6.0, 684.0)}.items():
        assert abs(z_score(list(gaps**power), mean, variance)) < LARGEST_Z, power
    for power in (1, 2, 3):
        mean = model.sizes.moment(power)
        variance = model.sizes.moment(2 * power) - mean**2
        assert abs(z_score(list(rows[:, 1] ** power), mean, variance)) < LARGEST_Z, power
    together = (gaps[1:] - 1.0) * (gaps[:-1] - 1.0)
    assert abs(z_score(list(together), 0.0, 1.0)) < LARGEST_Z


@pytest.mark.slow
def test_regular_births_keep_their_spacing_for_ever() -> None:
    world = world_with(births="regular", meanCount=7.0)
    spacing = rubnoise.exact(scenario_of(world)).model.mean_birth_spacing
    birth = np.array(answer(ONE_RUN, world=world, distance=20000.0))[:, 0]
    np.testing.assert_allclose(birth - birth[0], spacing * np.arange(birth.size), rtol=0.0, atol=1e-10)


@pytest.mark.slow
def test_a_seed_repeats_and_another_does_not() -> None:
    def drawn(seed: int) -> Any:
        return answer(ONE_RUN, world=world_with(seed=seed), distance=50.0)

    assert drawn(3) == drawn(3)
    assert drawn(3) != drawn(4)
    assert drawn(3) != drawn(3 + 2**32)


# Life-lines and the histogram of the count: the lanes, the line of now, and Poisson's bars.
ROWS = "rub.run.rows.map((row, i) => [row.birth, row.death, rub.lives.lanes[i]])"
DRAWN = "rub.lives.pictures.forEach((each) => each.redraw())"


@pytest.fixture
def page(browser: Any, lesson_file: str) -> Any:
    """Return the page with all traces, 1000 um on."""
    with opened(browser, f"{lesson_file}#spread=1.5", init=UNHURRIED, **CALM) as found:
        found.locator("#unfold").click()
        found.evaluate("rub.run.goTo(1000)")
        found.evaluate(DRAWN)
        yield found


@pytest.mark.slow
def test_no_two_lives_of_a_lane_overlap_and_each_has_one(page: Any) -> None:
    rows = page.evaluate(ROWS)
    ends: dict[int, float] = {}
    for birth, death, lane in rows:
        assert ends.get(lane, birth) <= birth
        ends[lane] = death
    assert len(rows) > 500
    assert len(ends) < 50, "a lane is used again"


@pytest.mark.slow
@pytest.mark.parametrize("mean", [0.5, 2.0, 20.0, 400.0])
def test_the_bars_are_those_of_poisson(page: Any, mean: float) -> None:
    found = np.array(page.evaluate(f"rub.lives.poisson({mean}, 600)"))
    np.testing.assert_allclose(found, stats.poisson.pmf(np.arange(601), mean), rtol=1e-10, atol=1e-15)
    assert np.abs(found - stats.norm.pdf(np.arange(601), mean, mean**0.5)).max() > 1e-4


# A run on the page: its own rows, its own slider, until a knob of the contact leaves it.
@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[rubnoise.Run]:
    """Return a short run with a slider."""
    path = tmp_path_factory.mktemp("run") / "short <i>run.h5"
    with rubnoise.run(scenario_of(world_with(seed=11), distance=300.0), path) as found:
        yield found


@pytest.fixture
def replaying(browser: Any, run: rubnoise.Run, tmp_path: Path) -> Iterator[Any]:
    """Return the page that replays the run, standing still."""
    file = tmp_path / "replay.html"
    file.write_text(page_text("a run", run.scenario, record_of(run)), encoding="utf-8")
    with opened(browser, file.as_uri(), **CALM) as found:
        yield found


@pytest.mark.slow
def test_it_is_the_run(replaying: Any, run: rubnoise.Run) -> None:
    replaying.evaluate("rub.run.goTo(rub.run.end)")
    assert replaying.evaluate("rub.run.end") == 300.0
    assert replaying.evaluate("rub.run.rows.map((row) => row.birth)") == run.junctions["birth_distance"][:].tolist()
    area = replaying.evaluate("[...rub.run.trace.area.subarray(0, rub.run.trace.ready)]")
    assert max(abs(run.trace["real_contact_area"][:] - area)) < 1e-9
    told = replaying.locator("#replaying").inner_text()
    assert told.startswith("This is short <i>run.h5, seed 11: its junctions, row by row.")
