"""What is written is read back, of random rows and of a simulated run."""

import tracemalloc
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np
import pytest
import xxhash
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.model import Model
from rubnoise.record.rows import MemoryRecord, Tee
from rubnoise.simulation.draws import extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.layout import RunDescription, expected_bytes, features_of, row_count, stored_groups
from rubnoise.storage.life_curve import life_curve
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import HASH, JUNCTIONS, Feature
from rubnoise.storage.writer import RunWriter
from tests.files.runs import EVERYTHING, FEATURES, ORIGIN, Compression, Rows, describe, random_rows, write_run
from tests.frozen import examples
from tests.models import bare, model

# What is written is read back, to the bit, however it was cut into panels.
sizes = st.one_of(st.sampled_from((0, 1, 2)), st.integers(0, 3000))


def assert_holds(path: Path, rows: Rows) -> None:
    with open_run(path) as run:
        for group, columns in (rows | {"life_curve": life_curve("lens")}).items():
            assert run.columns[group] == tuple(columns)
            for name, values in columns.items():
                found = run.column(group, name)
                assert found.dtype == values.dtype
                assert found.tobytes() == values.tobytes()
        assert run.damaged() == {}


@pytest.mark.slow
@settings(max_examples=examples(20, 60), deadline=None)
@given(
    junctions=sizes,
    ticks=sizes.filter(bool),
    slider=sizes.filter(bool),
    features=st.sampled_from(FEATURES),
    compression=st.sampled_from(("none", "gzip")),
    borders=st.lists(st.integers(0, 3000), max_size=6).map(sorted),
)
def test_any_run_comes_back_whatever_its_panels(
    junctions: int,
    ticks: int,
    slider: int,
    features: frozenset[Feature],
    compression: Compression,
    borders: list[int],
) -> None:
    description = describe(junctions, ticks, slider=slider, features=features, compression=compression)
    rows = random_rows(description)
    with TemporaryDirectory() as folder:
        path = Path(folder, "run.h5")
        write_run(path, description, rows, borders=borders)
        assert_holds(path, rows)
        assert [entry.name for entry in Path(folder).iterdir()] == ["run.h5"]


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_hash_is_that_of_the_raw_bytes(tmp_path: Path, compression: Compression) -> None:
    description = describe(compression=compression)
    rows = random_rows(description)
    write_run(tmp_path / "run.h5", description, rows, borders=(2, 5))
    with h5py.File(tmp_path / "run.h5") as file:
        for group, columns in rows.items():
            for name, values in columns.items():
                expected = xxhash.xxh3_128(values.astype(values.dtype.newbyteorder("<")).tobytes()).hexdigest()
                assert file[group][name].attrs[HASH].decode() == expected


@pytest.mark.slow
@settings(max_examples=examples(12, 40), deadline=None)
@given(
    compression=st.sampled_from(("none", "gzip")),
    again=st.lists(st.tuples(st.integers(0, 49), st.integers(1, 10)), min_size=1, max_size=5),
    names=st.sampled_from(
        (
            ("death_distance", "life_distance", "state"),
            tuple(c.name for c in JUNCTIONS.columns if c.needs not in {"offset", "free"}),
        )
    ),
)
def test_rows_written_again_count_as_written_last(
    compression: Compression, again: list[tuple[int, int]], names: tuple[str, ...]
) -> None:
    description = describe(50, 60, compression=compression)
    rows = random_rows(description)
    junctions = rows["junctions"]
    with TemporaryDirectory() as folder:
        path = Path(folder, "run.h5")
        with RunWriter(path, description) as writer:
            for group, columns in rows.items():
                writer.write(group, 0, {name: values.copy() for name, values in columns.items()})
            for turn, (first, count) in enumerate(again):
                for name in names:
                    junctions[name][first : first + count] = turn + 3
                panel = {name: junctions[name][first : first + count] for name in names}
                writer.write("junctions", first, panel)
            writer.publish({})
        assert_holds(path, rows)


def test_rows_are_read_from_and_to_where_asked(tmp_path: Path) -> None:
    description = describe(20, 30)
    rows = random_rows(description)
    write_run(tmp_path / "run.h5", description, rows)
    with open_run(tmp_path / "run.h5") as run:
        expected = rows["trace"]["real_contact_area"]
        assert run.rows("trace") == 30
        assert np.array_equal(run.column("trace", "real_contact_area", 7, 12), expected[7:12])
        assert np.array_equal(run.column("trace", "real_contact_area", 28, 99), expected[28:])
        with pytest.raises(KeyError):
            run.column("trace", "temperature")


def peak_bytes(path: Path, blocks: int, compression: Compression) -> int:
    """Return the peak of traced memory of a run that is written block by block."""
    description = describe(2000 * blocks, 20_000 * blocks, 21_000 * blocks, compression=compression)
    block = random_rows(describe(2000, 20_000, 21_000))
    tracemalloc.start()
    with RunWriter(path, description) as writer:
        for k in range(blocks):
            for group, columns in block.items():
                writer.write(group, k * len(next(iter(columns.values()))), columns)
        writer.publish({})
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


@pytest.mark.slow
@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_memory_does_not_grow_with_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: Compression
) -> None:
    # A compressed file is read back in pieces, which ten blocks do not fill.
    few, many = (40, 80) if compression == "gzip" else (10, 40)
    peak_bytes(tmp_path / "warm.h5", 1, compression)
    short = peak_bytes(tmp_path / "short.h5", few, compression)
    long = peak_bytes(tmp_path / "long.h5", many, compression)
    # What the interpreter keeps of its own between two runs is within 64 KiB; a byte kept per row would be 1.3 MB.
    assert long < 1.1 * short + 2**16
    assert long < 0.2 * expected_bytes(describe(many * 2000, many * 20_000, slider=many * 21_000).extent, EVERYTHING)


def test_everything_besides_columns_comes_back(tmp_path: Path) -> None:
    summary = {"area_mean": 204.5, "junctions": 7, "note": "µ", "area_std_exact": 56.42936} | {
        f"mean_{9 - i}": float(i) for i in range(10)
    }
    toml = "# " + "µ" * 32_767  # 65 536 bytes, the most a scenario may have
    description = describe(scenario_toml=toml)
    write_run(tmp_path / "run.h5", description, random_rows(description), summary=summary)
    with open_run(tmp_path / "run.h5") as run:
        assert run.features == EVERYTHING
        assert all(run.rows(each.name) == row_count(each, description.extent) for each in stored_groups(EVERYTHING))
        assert run.attributes["title"] == description.title
        assert list(run.summary.items()) == list(summary.items())
        assert {name: type(value) for name, value in run.summary.items()} == {
            name: type(value) for name, value in summary.items()
        }
        found = run.provenance
        assert len(toml.encode()) == 2**16
        assert found["scenario_toml"] == toml
        assert {name: found[name] for name in description.provenance} == description.provenance
        assert found["started"] < found["finished"]


# A simulated run in its file: the rows are those in memory, and the file explains itself by its own rows.
RUNS = {
    "figure 5": model(distance=300.0),
    "bare": bare(distance=300.0),
    "thin": bare(count=0.01, distance=900.0, start="empty"),
    "no tick": model(distance=0.05),
}


def simulated(path: Path, run: Model, compression: Compression) -> MemoryRecord:
    """Write a run into a file and return what went through."""
    rows = extent(run, 1)
    description = RunDescription(
        title="",
        extent=rows,
        features=features_of(run),
        compression=compression,
        pulse=run.pulse,
        provenance={"scenario_toml": "", "scenario_resolved": "{}", **ORIGIN},
    )
    record = MemoryRecord(rows)
    with RunWriter(path, description) as writer:
        simulate(run, 1, Tee((writer, record)))
        writer.publish({})
    return record


def test_area_and_count_follow_from_rows_and_life_curve(tmp_path: Path) -> None:
    simulated(tmp_path / "run.h5", RUNS["figure 5"], "none")
    with open_run(tmp_path / "run.h5") as run:
        s, area, count = (run.column("trace", n) for n in ("distance", "real_contact_area", "junction_count"))
        birth, death, diameter = (run.column("junctions", n) for n in ("birth_distance", "death_distance", "diameter"))
        curve = run.column("life_curve", "u"), run.column("life_curve", "area_fraction")
    since_birth = s[:, None] - birth
    alive = (since_birth >= 0.0) & (s[:, None] < death)
    fraction = np.where(alive, np.interp(since_birth / diameter, *curve), 0.0)
    assert np.array_equal(alive.sum(axis=1), count)
    bound = 1e-6 * (alive * diameter**2).sum(axis=1) + 1e-9
    assert np.all(np.abs((diameter**2 * fraction).sum(axis=1) - area) <= bound)
