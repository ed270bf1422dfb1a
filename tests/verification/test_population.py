"""Who is born and found alive, in contacts of every width, and counts of whole runs."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr

from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.laws import Normal, Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.simulation import draws
from rubnoise.simulation.draws import birth_distances, draw_block, start
from rubnoise.simulation.observer import Observer
from rubnoise.theory.second_order import count_noise
from tests.models import bare, model, recorded, run_to_end
from tests.verification.scores import BOUND, REJECTED, seed_of

# Who is born, how large, and who is found alive: samples of runs against the laws they are drawn from.
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
    one, other = (np.diff(birth_distances(WIDE, seed, block, 0.0)) for block in (0, 1))
    assert abs(correlation(one, other)) <= BOUND
    assert not np.isin(one, other).any()
    sizes = [draw_block(WIDE, seed, block, 0.0, 0)[0].diameter for block in (0, 1)]
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
    counts, mean = numbers(run), run.mean_live_junctions
    assert abs(counts.mean() - mean) <= BOUND * np.sqrt(mean / STARTS)
    assert abs(dispersion(counts)) <= BOUND
    empty = np.exp(-mean)
    assert abs((counts == 0).mean() - empty) <= BOUND * np.sqrt(empty * (1.0 - empty) / STARTS) + 1.0 / STARTS


def test_a_fixed_number_at_the_start_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    regular, past = RegularBirths(mean_spacing=LONG.births.mean), draws.past
    monkeypatch.setattr(draws, "past", lambda run, *where: past(replace(run, births=regular), *where))
    counts = np.array([start(LONG, seed).junctions for seed in range(STARTS)], dtype=float)
    assert dispersion(counts) < -REJECTED


def test_diameters_at_the_start_are_length_biased() -> None:
    diameters = np.concatenate([diameter for _, diameter in starts(WIDE)])
    law = law_of(WIDE)
    assert ks(diameters, length_biased(law)) < KS_BOUND
    assert ks(diameters, redrawn_normal(law)) > KS_BOUND
    error = np.sqrt((law.moment(3) / law.moment(1) - (law.moment(2) / law.moment(1)) ** 2) / diameters.size)
    assert abs(diameters.mean() - law.moment(2) / law.moment(1)) <= BOUND * error


def test_ages_at_the_start_are_uniform_over_a_life() -> None:
    births = np.concatenate([birth for birth, _ in starts(WIDE)])
    diameters = np.concatenate([diameter for _, diameter in starts(WIDE)])
    ages = -births / (2.0 * diameters)
    assert ks(ages, lambda age: np.clip(age, 0.0, 1.0)) < KS_BOUND
    assert ks(0.98 * ages, lambda age: np.clip(age, 0.0, 1.0)) > KS_BOUND
    assert abs(correlation(ages, diameters)) <= BOUND


def test_the_first_birth_waits_an_exponential_gap() -> None:
    seeds = range(seed_of("first birth"), seed_of("first birth") + STARTS)
    first = np.array([start(LONG, seed).next_birth for seed in seeds])
    assert ks(first, exponential(LONG.mean_birth_spacing)) < KS_BOUND
    assert abs(correlation(first, numbers(LONG))) <= BOUND


# What lives: Little's law and what a birth sees.


def test_births_times_life_are_the_number_alive() -> None:
    """Little's law: the mean of N over the run is births per um times the mean life, but for lives cut by its ends."""
    columns = recorded(LONG, seed_of("little"))
    record, trace = columns["junctions"], columns["trace"]
    lives = np.minimum(record["death_distance"], LONG.distance) - np.maximum(record["birth_distance"], 0.0)
    along = lives.sum() / LONG.distance
    assert abs(along - LONG.mean_live_junctions) <= BOUND * count_noise(LONG).error_of_mean(LONG.distance)
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
    found, mean = found_by_births(), FAR.mean_live_junctions
    error = np.sqrt(((2.0 * FAR.birth_rate) ** 2 * FAR.sizes.moment(2) + mean) / found.size)
    assert abs(found.mean() - mean) <= BOUND * error
    assert found.mean() + 1.0 - mean > REJECTED * error


def test_another_rate_would_be_seen() -> None:
    slower = replace(LONG, births=PoissonBirths(mean_spacing=1.06 * LONG.births.mean))
    gaps = np.diff(rows("slower", slower)["birth_distance"])
    assert ks(gaps[gaps > 0.0], exponential(LONG.mean_birth_spacing)) > KS_BOUND


# Contacts that are thin, dense, short, empty or of the widest sizes.
NONE = Spread()


@pytest.mark.parametrize(
    "run",
    [
        bare(count=0.01, distance=200_000.0, tick=100.0),
        bare(count=0.01, distance=50.0, tick=1.0),
        bare(count=5000.0, distance=3.0, tick=0.01),
        bare(distance=0.5, tick=0.1),
        bare(spread=NONE, distance=100.0),
        bare(count=1.0, area=3.0, spread=Spread(absolute=8.0), distance=500.0),
        bare(count=0.01, distance=5.0, tick=0.1, start="empty"),
    ],
    ids=["thin", "thin and short", "dense", "shorter than a life", "one size", "spread above the mean", "no birth"],
)
def test_every_row_and_tick_is_sound(run):
    record = recorded(run)
    rows, trace = record["junctions"], record["trace"]
    assert np.all(np.diff(rows["birth_distance"]) >= 0)
    assert np.all(rows["diameter"] > 0)
    assert np.array_equal(rows["death_distance"], rows["birth_distance"] + 2 * rows["diameter"])
    assert np.array_equal(rows["junction"], np.arange(rows["junction"].size))
    s = trace["distance"]
    assert np.array_equal(s, np.arange(run.tick_count + 1) * run.tick)
    alive = [(rows["birth_distance"] <= x) & (x < rows["death_distance"]) for x in s]
    assert [int(row.sum()) for row in alive] == trace["junction_count"].tolist()
    assert np.array_equal(trace["real_contact_area"] > 0, trace["junction_count"] > 0)


def test_no_birth_at_all_is_a_run():
    record = recorded(bare(count=0.01, distance=5.0, tick=0.1, start="empty"))
    assert record.extent.junctions == 0
    assert not record["trace"]["real_contact_area"].any()


def test_an_empty_start_begins_with_nothing():
    record = recorded(bare(start="empty", distance=100.0))
    assert record["trace"]["junction_count"][0] == 0
    assert not np.any(record["junctions"]["state"] & JunctionState.ALIVE_AT_START)


def test_states_tell_who_was_alive_at_the_ends():
    run = bare(distance=100.0)
    rows = recorded(run)["junctions"]
    state = rows["state"]
    assert np.array_equal((state & JunctionState.ALIVE_AT_START) > 0, rows["birth_distance"] < 0)
    assert np.array_equal((state & JunctionState.ALIVE_AT_END) > 0, rows["death_distance"] > run.distance)
    assert np.any(state == JunctionState.COMPLETE)


def test_a_life_longer_than_the_run_is_alive_at_both_ends():
    state = recorded(bare(distance=0.5))["junctions"]["state"]
    assert np.any(state == JunctionState.ALIVE_AT_START | JunctionState.ALIVE_AT_END)


def test_without_speed_no_times_and_without_strength_no_force():
    record = recorded(bare())
    assert "slider" not in record.groups
    assert not {"birth_time", "death_time", "shear_strength"} & set(record["junctions"])
    assert "friction_force" not in record["trace"]


def test_times_are_distances_over_the_speed():
    run = model(distance=50.0)
    record = recorded(run)
    for name in ("birth", "death"):
        assert np.array_equal(record["junctions"][f"{name}_time"], record["junctions"][f"{name}_distance"] / 1000.0)
    assert np.array_equal(record["slider"]["time"], record["trace"]["distance"] / 1000.0)


# Blocks and junctions of whole runs: a golden that needs no tolerance.
GOLDEN = {
    "figure 5, 20 mm": (model(distance=20_000.0, tick=0.1), (37, 36543)),
    "no slider": (bare(distance=2000.0, tick=0.5), (4, 3718)),
    "dense": (bare(count=5000.0, distance=20.0, tick=0.1), (3, 148383)),
    "thin": (bare(count=0.01, distance=100_000.0, tick=50.0), (1, 4)),
    "triangles born regularly": (
        model(births="regular", pulse=TRIANGLE, distance=2000.0, tick=0.5),
        (4, 3984),
    ),
    "one size, from empty": (bare(spread=Spread(), start="empty", distance=2000.0, tick=0.5), (4, 3700)),
}


@pytest.fixture
def each_block_alone(monkeypatch):
    """Blocks that are played together are fewer."""
    monkeypatch.setattr(draws, "BLOCK", 1000)


@pytest.mark.usefixtures("each_block_alone")
@pytest.mark.parametrize("name", GOLDEN)
def test_how_many_blocks_and_junctions_there_are(name):
    run, expected = GOLDEN[name]
    _, state = run_to_end(run)
    assert (state.block, state.junctions) == expected


@pytest.mark.usefixtures("each_block_alone")
@pytest.mark.parametrize("name", GOLDEN)
def test_an_observer_hears_of_each_birth_mid_life_and_death_within_the_run(name):
    run, _ = GOLDEN[name]
    told = {"birth": [], "mid_life": [], "death": []}
    record, _ = run_to_end(
        run, observe=Observer(**{name: lambda *what, to=to: to.append(what) for name, to in told.items()})
    )
    lives = record["junctions"]
    birth, death = lives["birth_distance"][:], lives["death_distance"][:]
    middle = 0.5 * (birth + death)
    for heard, place in ((told["birth"], birth), (told["mid_life"], middle), (told["death"], death)):
        within = np.flatnonzero((place > 0.0) & (place <= run.distance))
        assert sorted(number for number, _ in heard) == within.tolist()
