"""Who is born, how large, and who is found alive: samples of runs against the laws they are drawn from.

The Kolmogorov-Smirnov distance D of n independent values from their own distribution has
P(D sqrt(n) > x) = 2 sum (-1)^(k-1) exp(-2 k^2 x^2); KS_BOUND makes that the probability of 4 standard deviations.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import Normal, Spread
from rubnoise.model import Model
from rubnoise.simulation import draws
from rubnoise.simulation.draws import birth_distances, draw_blocks, first_birth, start
from rubnoise.theory.occupancy import length_biased_mean_diameter, mean_count, mean_count_error
from tests.models import bare, recorded
from tests.verification.scores import BOUND, REJECTED
from tests.verification.seeds import seed_of

Doubles = NDArray[np.float64]
Distribution = Callable[[Doubles], Doubles]

KS_BOUND = 2.28
STARTS = 2000
LONG = bare(distance=20_000.0, tick=2.0)
WIDE = bare(spread=Spread(absolute=4.0), distance=20_000.0, tick=2.0)


def ks(values: Doubles, distribution: Distribution) -> float:
    """Return D sqrt(n) of a sample against a continuous distribution function."""
    n = values.size
    heights = distribution(np.sort(values))
    steps = np.arange(n + 1) / n
    return float(max(np.max(steps[1:] - heights), np.max(heights - steps[:-1])) * np.sqrt(n))


def exponential(mean: float) -> Distribution:
    return lambda gap: -np.expm1(-gap / mean)


def redrawn_normal(law: Normal) -> Distribution:
    """Return the distribution function of the normal law conditioned on d > 0."""
    below = ndtr(-law.centre / law.std)
    return lambda d: (ndtr((d - law.centre) / law.std) - below) / (1.0 - below)


def length_biased(law: Normal) -> Distribution:
    """Return int_0^d x f(x) dx / m_1, by parts: with P and p the normal's distribution and density functions,

    int x f = mean (P(z) - P(z0)) - std (p(z) - p(z0)), z = (d - mean)/std, z0 = -mean/std.
    """

    def so_far(d: Doubles) -> Doubles:
        z, z0 = (d - law.centre) / law.std, -law.centre / law.std
        height = (np.exp(-0.5 * z**2) - np.exp(-0.5 * z0**2)) / np.sqrt(2.0 * np.pi)
        return law.centre * (ndtr(z) - ndtr(z0)) - law.std * height

    return lambda d: so_far(d) / so_far(np.array(np.inf))


@cache
def rows(name: str, run: Model) -> dict[str, Doubles]:
    columns = recorded(run, seed_of(f"population/{name}"))["junctions"]
    return {column: np.asarray(values) for column, values in columns.items()}


def law_of(run: Model) -> Normal:
    assert isinstance(run.sizes, Normal)
    return run.sizes


# Births and sizes along a run.


def births(name: str) -> Doubles:
    birth = rows(name, WIDE)["birth_distance"]
    return birth[birth >= 0.0]


def test_gaps_are_exponential() -> None:
    gaps = np.diff(births("births"), prepend=0.0)
    assert gaps.size > 30_000
    assert ks(gaps, exponential(WIDE.mean_birth_spacing)) < KS_BOUND
    assert ks(gaps, exponential(1.06 * WIDE.mean_birth_spacing)) > KS_BOUND


def test_gaps_know_nothing_of_the_gap_before() -> None:
    gaps = np.diff(births("births"))
    assert abs(correlation(gaps[:-1], gaps[1:])) <= BOUND
    assert correlation(gaps[:-1] + gaps[1:], gaps[1:]) > REJECTED


def correlation(one: Doubles, other: Doubles) -> float:
    """Return the correlation coefficient times sqrt(n): a unit normal for independent values."""
    return float(np.corrcoef(one, other)[0, 1] * np.sqrt(one.size))


def test_diameters_are_those_of_the_redrawn_normal() -> None:
    columns = rows("births", WIDE)
    born = columns["diameter"][columns["birth_distance"] >= 0.0]
    law = law_of(WIDE)
    assert ks(born, redrawn_normal(law)) < KS_BOUND
    assert ks(born, lambda d: ndtr((d - law.centre) / law.std)) > KS_BOUND
    assert ks(born, length_biased(law)) > KS_BOUND


def test_births_diameters_and_their_neighbours_are_independent() -> None:
    columns = rows("births", WIDE)
    run = columns["birth_distance"] >= 0.0
    birth, diameter = columns["birth_distance"][run], columns["diameter"][run]
    assert abs(correlation(np.diff(birth), diameter[1:])) <= BOUND
    assert abs(correlation(np.diff(birth), diameter[:-1])) <= BOUND
    assert abs(correlation(diameter[:-1], diameter[1:])) <= BOUND


def test_blocks_are_drawn_anew() -> None:
    seed = seed_of("blocks")
    one, other = (birth_distances(WIDE, seed, block, 0.0)[1] for block in (0, 1))
    assert abs(correlation(one, other)) <= BOUND
    assert not np.isin(one, other).any()
    sizes = [draw_blocks(WIDE, seed, block, 0.0).diameter for block in (0, 1)]
    assert not np.isin(*sizes).any()


# The start, over many seeds.


@cache
def starts(run: Model) -> list[tuple[Doubles, Doubles]]:
    """Return births and diameters of the junctions alive at the start, for many seeds."""
    seeds = range(seed_of("starts"), seed_of("starts") + STARTS)
    return [(state.live.birth, state.live.diameter) for state in (start(run, seed) for seed in seeds)]


def dispersion(counts: Doubles) -> float:
    """Return the score of variance over mean of n Poisson counts: its variance is 2/(n - 1) (Fisher 1950)."""
    return float((counts.var(ddof=1) / counts.mean() - 1.0) / np.sqrt(2.0 / (counts.size - 1)))


def numbers(run: Model) -> Doubles:
    return np.array([birth.size for birth, _ in starts(run)], dtype=float)


@pytest.mark.parametrize("run", [LONG, WIDE, bare(count=0.3)], ids=["figure 5", "wide", "few"])
def test_the_number_at_the_start_is_poisson(run: Model) -> None:
    counts, mean = numbers(run), mean_count(run)
    assert abs(counts.mean() - mean) <= BOUND * np.sqrt(mean / STARTS)
    assert abs(dispersion(counts)) <= BOUND
    empty = np.exp(-mean)
    assert abs((counts == 0).mean() - empty) <= BOUND * np.sqrt(empty * (1.0 - empty) / STARTS) + 1.0 / STARTS


def test_a_fixed_number_at_the_start_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(draws, "_poisson", lambda seed, mean: round(mean))
    counts = np.array([start(LONG, seed).junctions for seed in range(STARTS)], dtype=float)
    assert dispersion(counts) < -REJECTED


def test_diameters_at_the_start_are_length_biased() -> None:
    diameters = np.concatenate([diameter for _, diameter in starts(WIDE)])
    law = law_of(WIDE)
    assert ks(diameters, length_biased(law)) < KS_BOUND
    assert ks(diameters, redrawn_normal(law)) > KS_BOUND
    error = np.sqrt(law.moment(3) / law.moment(1) - length_biased_mean_diameter(WIDE) ** 2)
    assert abs(diameters.mean() - length_biased_mean_diameter(WIDE)) <= BOUND * error / np.sqrt(diameters.size)


def test_ages_at_the_start_are_uniform_over_a_life() -> None:
    births = np.concatenate([birth for birth, _ in starts(WIDE)])
    diameters = np.concatenate([diameter for _, diameter in starts(WIDE)])
    ages = -births / (2.0 * diameters)
    assert ks(ages, lambda age: np.clip(age, 0.0, 1.0)) < KS_BOUND
    assert ks(0.98 * ages, lambda age: np.clip(age, 0.0, 1.0)) > KS_BOUND
    assert abs(correlation(ages, diameters)) <= BOUND


def test_the_first_birth_waits_an_exponential_gap() -> None:
    seeds = range(seed_of("first birth"), seed_of("first birth") + STARTS)
    first = np.array([first_birth(LONG, seed) for seed in seeds])
    assert ks(first, exponential(LONG.mean_birth_spacing)) < KS_BOUND
    assert abs(correlation(first, numbers(LONG))) <= BOUND


# What lives: Little's law and what a birth sees.


def test_births_times_life_are_the_number_alive() -> None:
    """Little's law: the mean of N over the run is births per um times the mean life, but for lives cut by its ends."""
    columns = recorded(LONG, seed_of("little"))
    record, trace = columns["junctions"], columns["trace"]
    lives = np.minimum(record["death_distance"], LONG.distance) - np.maximum(record["birth_distance"], 0.0)
    along = lives.sum() / LONG.distance
    assert abs(along - mean_count(LONG)) <= BOUND * mean_count_error(LONG, LONG.distance)
    # A tick more or less meets each life, at random: variance f (1 - f) <= 1/4 of a tick squared, f what is left over.
    ends = (trace["junction_count"][0] + trace["junction_count"][-1]) / 2.0
    seen = (trace["junction_count"].sum() - ends) / LONG.tick_count
    assert abs(seen - along) <= BOUND * LONG.tick / LONG.distance * np.sqrt(lives.size / 4.0)


FAR = bare(count=3.0, distance=60_000.0, tick=500.0)


def found_by_births() -> Doubles:
    """Return how many junctions each birth of a run finds alive."""
    columns = rows("found", FAR)
    birth, deaths = columns["birth_distance"], np.sort(columns["death_distance"])
    new = np.flatnonzero(birth >= 0.0)
    return (new - np.searchsorted(deaths, birth[new], side="right")).astype(float)


def test_births_see_what_all_distances_see() -> None:
    """Births see averages over distance (PASTA): the mean of what they find is that of N.

    Its error over n births counts pairs (a birth, one alive then). A pair-sum's variance in a Poisson process has a
    part in each point's mean number of partners, less the mean here: lam 2d, and one in the pairs themselves; so
    Var n = (lam 2)^2 m_2 + mean (Last and Penrose 2017, Lectures on the Poisson Process, chapter 12).
    """
    found, mean = found_by_births(), mean_count(FAR)
    error = np.sqrt(((2.0 * FAR.birth_rate) ** 2 * FAR.sizes.moment(2) + mean) / found.size)
    assert abs(found.mean() - mean) <= BOUND * error
    assert found.mean() + 1.0 - mean > REJECTED * error


def test_another_rate_would_be_seen() -> None:
    slower = replace(LONG, births=PoissonBirths(mean_spacing=1.06 * LONG.births.mean))
    gaps = np.diff(rows("slower", slower)["birth_distance"])
    assert ks(gaps[gaps > 0.0], exponential(LONG.mean_birth_spacing)) > KS_BOUND
