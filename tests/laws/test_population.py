"""Who is alive, in contacts of every width, and counts of whole runs; sentinels and `compare` know who is born."""

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.record.rows import JunctionState
from rubnoise.simulation import draws
from rubnoise.simulation.observer import Observer
from rubnoise.theory.second_order import count_noise
from tests.laws.scores import BOUND, REJECTED, seed_of
from tests.models import bare, model, recorded, run_to_end

LONG = bare(distance=20_000.0, tick=2.0)


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


def found_by_births() -> np.ndarray:
    """Return how many junctions each birth of a run finds alive."""
    columns = recorded(FAR, seed_of("population/found"))["junctions"]
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
    assert record.extent["junctions"] == 0
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
@pytest.mark.slow("dense")
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
