"""A simulated run in its file: the rows are those in memory, and the file explains itself by its own rows."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.sink import Tee
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import Feature
from rubnoise.storage.writer import RunWriter
from tests.format.runs import EVERYTHING, ORIGIN, Compression
from tests.models import bare, model

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
        scenario_toml="",
        scenario_resolved={},
        provenance=ORIGIN,
    )
    record = MemoryRecord(rows)
    with RunWriter(path, description) as writer:
        simulate(run, 1, Tee((writer, record)))
        writer.publish({})
    return record


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_the_file_holds_the_rows_of_the_run(tmp_path: Path, name: str, compression: Compression) -> None:
    record = simulated(tmp_path / "run.h5", RUNS[name], compression)
    with open_run(tmp_path / "run.h5") as run:
        assert run.extent == record.extent
        assert run.damaged() == ()
        for group, columns in record.groups.items():
            for column, values in columns.items():
                assert run.column(group, column).tobytes() == values.tobytes()


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


@pytest.mark.parametrize(
    ("changed", "features"),
    [
        (RUNS["figure 5"], EVERYTHING),
        (replace(RUNS["figure 5"], slider=None), EVERYTHING - {"slider"}),
        (bare(), frozenset()),
        (replace(bare(), sliding_speed=1000.0), frozenset({"speed"})),
    ],
)
def test_features_follow_the_model(changed: Model, features: frozenset[Feature]) -> None:
    assert features_of(changed) == features
