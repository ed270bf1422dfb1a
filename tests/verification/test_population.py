"""Who is born and found alive, in contacts of every width, and counts of whole runs."""

import numpy as np

from rubnoise.record.rows import JunctionState
from tests.models import bare, model, recorded

# Contacts that are thin, dense, short, empty or of the widest sizes.


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
