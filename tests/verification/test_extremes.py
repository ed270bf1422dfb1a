"""Contacts that are thin, dense, short, empty or of the widest sizes."""

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.record.rows import JunctionState
from tests.models import bare, model, recorded

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
