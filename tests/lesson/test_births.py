"""What the page draws: junctions of a stationary contact, from a seed, as theory says that they are."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

import rubnoise
from tests.lesson.node import answer
from tests.lesson.worlds import scenario_of, world_with
from tests.verification.seeds import seed_of

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


def test_regular_births_keep_their_spacing_for_ever() -> None:
    world = world_with(births="regular", meanCount=7.0)
    spacing = rubnoise.exact(scenario_of(world)).model.mean_birth_spacing
    birth = np.array(answer(ONE_RUN, world=world, distance=20000.0))[:, 0]
    np.testing.assert_allclose(birth - birth[0], spacing * np.arange(birth.size), rtol=0.0, atol=1e-10)


def test_a_seed_repeats_and_another_does_not() -> None:
    def drawn(seed: int) -> Any:
        return answer(ONE_RUN, world=world_with(seed=seed), distance=50.0)

    assert drawn(3) == drawn(3)
    assert drawn(3) != drawn(4)
    assert drawn(3) != drawn(3 + 2**32)


def test_uniform_numbers_are_uniform() -> None:
    body = "const r = new rub.Random(seed, 1); return Array.from({ length: 100000 }, () => r.uniform());"
    values = np.array(answer(body, seed=seed_of("uniform numbers of the page")))
    counts = np.bincount((values * 100).astype(int), minlength=100)
    squares = float(((counts - 1000.0) ** 2 / 1000.0).sum())
    assert abs(squares - 99.0) / sqrt(2.0 * 99.0) < LARGEST_Z
    assert 0.0 < values.min() < values.max() < 1.0
