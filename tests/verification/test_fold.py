"""A run is a fold over blocks: stopped anywhere and resumed, it is the same run."""

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.off_centre import OFF_CENTRE_LENS
from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.sink import Extent
from rubnoise.simulation import draws, ticks
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import finished, simulate
from rubnoise.simulation.state import State
from tests.models import UNEQUAL, contents, model, recorded, run_to_end

RUNS = {
    "figure 5": model(distance=2000.0, tick=0.5),
    "empty start": model(distance=1500.0, tick=0.7, start="empty"),
    "few": model(count=0.5, distance=400_000.0, tick=200.0),
    "many": model(count=5000.0, distance=20.0, tick=0.05),
    "wide sizes": model(count=8.0, spread=Spread(absolute=12.0), distance=9000.0, tick=2.7),
    "Rabinowicz": model(pulse=TRIANGLE, births="regular", spread=Spread(), distance=2000.0, tick=0.5),
    "unequal triangles": model(
        pulse=TRIANGLE, strength=UNEQUAL, spread=Spread(relative=0.4), distance=1500.0, tick=0.7
    ),
    "off the centre line": model(
        pulse=OFF_CENTRE_LENS, strength=UNEQUAL, spread=Spread(relative=0.4), distance=1500.0, tick=0.7
    ),
    "regular and wide": model(count=8.0, births="regular", spread=Spread(relative=2.0), distance=9000.0, tick=2.7),
}


@pytest.fixture
def each_block_alone(monkeypatch):
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)


@pytest.mark.usefixtures("each_block_alone")
@pytest.mark.parametrize("name", RUNS)
def test_a_run_cut_at_every_block_goes_on_to_the_same_bits(name):
    run = RUNS[name]
    whole = MemoryRecord(extent(run, 5))
    states: list[bytes] = []
    simulate(run, 5, whole, commit=lambda state: states.append(state.pack()))
    assert len(states) >= 3
    for cut in states[:-1]:
        first, again, later = State.unpack(cut), MemoryRecord(whole.extent), []
        simulate(run, 5, again, state=first, commit=lambda state, later=later: later.append(state.pack()))
        assert later == states[-len(later) :]
        for group, columns in again.groups.items():
            begin = {"junctions": first.junctions, "blocks": first.block}.get(group, first.ticks)
            for column, values in columns.items():
                assert values[begin:].tobytes() == whole[group][column][begin:].tobytes()


@pytest.mark.parametrize("pulse", [LENS, TRIANGLE, OFF_CENTRE_LENS], ids=lambda pulse: pulse.name)
@pytest.mark.parametrize(("size", "distance"), [(1, 20.0), (7, 60.0), (1000, 300.0)])
def test_panels_are_only_how_a_block_is_written(monkeypatch, size, distance, pulse):
    run = model(distance=distance, tick=0.05, pulse=pulse, strength=UNEQUAL)
    expected = contents(recorded(run))
    monkeypatch.setattr(ticks, "LARGEST_TICK_RANGE", size)
    assert contents(recorded(run)) == expected


@pytest.mark.usefixtures("each_block_alone")
def test_a_block_owns_exactly_its_births():
    run = model(distance=3000.0, tick=1.0)
    junctions = []
    simulate(run, 1, MemoryRecord(extent(run, 1)), commit=lambda state: junctions.append(state.junctions))
    assert set(np.diff(junctions)[:-1].tolist()) == {draws.births_per_block(run)}


def test_same_seed_same_bytes_other_seed_other_bytes():
    run = model(distance=200.0)
    assert contents(recorded(run, 3)) == contents(recorded(run, 3))
    assert contents(recorded(run, 3)) != contents(recorded(run, 4))


def test_the_extent_is_known_before_the_run():
    for run in RUNS.values():
        record, state = run_to_end(run, 2)
        assert record.extent.junctions == state.junctions == record["junctions"]["birth_distance"].size
        assert record.extent.ticks == state.ticks == run.tick_count + 1
        assert record.extent.blocks == state.block == record["blocks"]["block"].size
        assert finished(run, state)


def test_a_run_without_births_is_one_block():
    run = model(count=0.01, distance=1e-3, tick=1e-3, start="empty")
    record, state = run_to_end(run)
    assert record.extent == Extent(junctions=0, ticks=2, blocks=1, slider=2)
    assert record["blocks"]["birth_distance"][0] > run.distance
    assert state.block == 1


@pytest.mark.usefixtures("each_block_alone")
@pytest.mark.parametrize("name", RUNS)
def test_blocks_and_junctions_are_enough_to_make_every_state_again(name):
    run = RUNS[name]
    record, states = MemoryRecord(extent(run, 5)), [draws.start(run, 5)]
    simulate(run, 5, record, commit=states.append)
    blocks, junctions = record["blocks"], record["junctions"]
    for state in states[:-1]:
        row = {column: values[state.block] for column, values in blocks.items()}
        assert row["block"] == state.block
        assert (row["birth_distance"], row["first_junction"]) == (state.next_birth, state.junctions)
        assert (row["first_tick"], row["displacement"], row["velocity"]) == (
            state.ticks,
            state.displacement,
            state.velocity,
        )
        born = junctions["junction"] < row["first_junction"]
        carried = born & (junctions["death_distance"] > (row["first_tick"] - 1) * run.tick)
        for column, values in (("junction", state.live.junction), ("diameter", state.live.diameter)):
            assert junctions[column][carried].tobytes() == values.tobytes()


def test_a_short_run_is_the_beginning_of_a_long_one():
    short, long = recorded(model(distance=700.0)), recorded(model(distance=900.0))
    rows = short.extent.junctions
    assert np.array_equal(short["junctions"]["birth_distance"], long["junctions"]["birth_distance"][:rows])
    ticks = short.extent.ticks
    for group, column in (("trace", "real_contact_area"), ("slider", "velocity")):
        assert np.array_equal(short[group][column], long[group][column][:ticks])


def test_rows_are_written_once_and_in_order():
    run = model(distance=2000.0, tick=0.5)
    seen = {"junctions": 0, "trace": 0, "slider": 0, "blocks": 0}

    class Watchful:
        def write(self, group, first_row, columns):
            assert first_row == seen[group]
            seen[group] += next(iter(columns.values())).size

    simulate(run, 1, Watchful())
    rows, ticks = extent(run, 1), run.tick_count + 1
    assert seen == {"junctions": rows.junctions, "trace": ticks, "slider": ticks, "blocks": rows.blocks}
