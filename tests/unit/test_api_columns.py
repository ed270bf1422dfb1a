"""Columns of a result: arrays with a unit, which is kept by choosing, sorting and copying rows, and by nothing else."""

import pickle
from collections.abc import Callable
from copy import copy, deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import rubnoise
from rubnoise.storage import reader
from rubnoise.storage.schema import TRACE
from tests.files.runs import Compression, describe, random_rows, write_run

PLACE, AREA = TRACE.columns[:2]
ROWS = 1000
VALUES = np.random.default_rng(1).normal(size=ROWS)
PLACES = np.arange(ROWS) / 10.0


@pytest.fixture
def column() -> rubnoise.Column:
    return rubnoise.Column(VALUES.copy(), AREA, lambda: rubnoise.Column(PLACES.copy(), PLACE))


KEEPS: dict[str, Callable[[rubnoise.Column], Any]] = {
    "slice": lambda column: column[3:900:7],
    "backwards": lambda column: column[::-1],
    "mask": lambda column: column[column > 1.0],
    "rows": lambda column: column[[4, -996, 4, 8]],
    "axis": lambda column: column[:, None],
    "sorted": np.sort,
    "copy": lambda column: column.copy(),
    "copied": copy,
    "deep copy": deepcopy,
    "pickle": lambda column: pickle.loads(pickle.dumps(column)),  # noqa: S301  (made here)
    "pickle of now": lambda column: pickle.loads(pickle.dumps(column, protocol=5)),  # noqa: S301  (made here)
    "twice": lambda column: column[10:][column[10:] > 0.0].copy(),
    "chunk": lambda column: next(column.chunks(64)),
}
LOSES: dict[str, Callable[[rubnoise.Column], Any]] = {
    "argsort": lambda column: column.argsort(),
    "astype": lambda column: column.astype(int),
    "same type": lambda column: column.astype(float),
    "product": lambda column: 2.0 * column,
    "difference": lambda column: column - column.mean(),
    "function": np.sqrt,
    "sums": np.cumsum,
    "steps": np.diff,
    "comparison": lambda column: column > 1.0,
    "shape": lambda column: column.reshape(10, -1),
    "flat": np.ravel,
    "joined": lambda column: np.concatenate([column, column]),
    "where": lambda column: np.where(column > 0.0, column, 0.0),
    "interpolated": lambda column: np.interp([0.5], np.arange(column.size), column),
    "values": lambda column: column.values,
    "asarray": np.asarray,
    "to_numpy": lambda column: column.to_numpy(),
    "of something computed": lambda column: (2.0 * column)[:5],
    "of a view": lambda column: column.ravel()[:5].copy(),
}


@pytest.mark.parametrize("way", KEEPS)
def test_a_unit_stays_with_rows(column: rubnoise.Column, way: str) -> None:
    found, wanted = KEEPS[way](column), KEEPS[way](column).values
    assert isinstance(found, rubnoise.Column)
    assert (found.name, found.units, found.long_name, found.symbol) == (AREA.name, "um^2", AREA.long_name, "A_r")
    np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("way", LOSES)
def test_a_unit_is_lost_by_anything_else(column: rubnoise.Column, way: str) -> None:
    with np.errstate(invalid="ignore"):
        found = LOSES[way](column)
    assert not hasattr(found, "units")
    assert repr(found) == repr(np.asarray(found))
    again = pickle.loads(pickle.dumps(found))  # noqa: S301  (made here)
    np.testing.assert_array_equal(again, found)


def test_rows_keep_their_places(column: rubnoise.Column) -> None:
    for rows in (slice(3, 900, 7), VALUES > 1.0, [5, 3]):
        chosen = column[rows]
        assert chosen.beside is not None
        np.testing.assert_array_equal(chosen.beside, PLACES[rows])
        assert chosen.copy().beside.units == "um"
    assert np.sort(column).beside is None
    assert isinstance(column[:9].plot(), Figure)
    assert isinstance(np.sort(column).plot(), Figure)


# An open run shows the rows that it had when it was opened, or refuses.
@pytest.fixture(params=["none", "gzip"])
def compression(request: pytest.FixtureRequest) -> Compression:
    found: Compression = request.param
    return found


@pytest.mark.parametrize("read_bytes", [reader.READ_BYTES, 16], ids=["read", "mapped"])
def test_an_open_run_has_its_rows_after_another_took_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: Compression, read_bytes: int
) -> None:
    monkeypatch.setattr(reader, "READ_BYTES", read_bytes)
    first, second = (describe(700, n, compression=compression, scenario_toml=f"# {n}") for n in (5000, 9000))
    rows = random_rows(first)
    write_run(tmp_path / "x.h5", first, rows)
    with rubnoise.open(tmp_path / "x.h5") as run:
        held = run.trace["distance"]
        write_run(tmp_path / "y.h5", second, random_rows(second))
        (tmp_path / "y.h5").replace(tmp_path / "x.h5")
        np.testing.assert_array_equal(held, rows["trace"]["distance"])
        np.testing.assert_array_equal(run.trace["real_contact_area"], rows["trace"]["real_contact_area"])
        np.testing.assert_array_equal(run.junctions["diameter"][5:9], rows["junctions"]["diameter"][5:9])
        with pytest.raises(rubnoise.Refused, match="has changed since it was opened"):
            pickle.loads(pickle.dumps(run))  # noqa: S301  (made here)
    with rubnoise.open(tmp_path / "x.h5") as run:
        assert len(run.trace) == len(run.trace["distance"]) == 9000


@pytest.mark.parametrize("read_bytes", [reader.READ_BYTES, 16], ids=["read", "mapped"])
def test_a_column_outlives_its_run_and_changes_in_memory_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, read_bytes: int
) -> None:
    monkeypatch.setattr(reader, "READ_BYTES", read_bytes)
    description = describe(700, 5000)
    rows = random_rows(description)
    write_run(tmp_path / "x.h5", description, rows)
    content = (tmp_path / "x.h5").read_bytes()
    with rubnoise.open(tmp_path / "x.h5") as run:
        area, other = run.trace["real_contact_area"], run.trace["real_contact_area"]
        area[:] = 7.0
        np.testing.assert_array_equal(other, run.trace["real_contact_area"])
    (tmp_path / "x.h5").unlink()
    np.testing.assert_array_equal(other, rows["trace"]["real_contact_area"])
    assert (area == 7.0).all()
    (tmp_path / "x.h5").write_bytes(content)
    with rubnoise.open(tmp_path / "x.h5") as run:
        np.testing.assert_array_equal(run.trace["real_contact_area"], other)


def test_groups_show_names_units_and_meaning(tmp_path: Path) -> None:
    description = describe()
    write_run(tmp_path / "x.h5", description, random_rows(description))
    with rubnoise.open(tmp_path / "x.h5") as run:
        assert "/trace: the contact at every tick of sliding distance, 11 rows" in repr(run.trace)
        assert "  real_contact_area  um^2  real contact area" in repr(run.trace)
        assert repr(run).startswith(f"{tmp_path / 'x.h5'}: a small run of µm\n  .junctions ")
        assert (next(iter(run.trace)), len(run.trace), "nonsense" in run.trace) == ("distance", 11, False)
        assert set(dict(run.trace)) == set(run.trace.names)
        area = run.trace["real_contact_area"]
    assert repr(run).endswith("x.h5: a run, closed")
    assert repr(area).startswith("<real_contact_area (um^2), 11 rows of float64: ")


def test_a_record_in_memory_has_the_same_face(tmp_path: Path) -> None:
    scenario = rubnoise.build(
        {
            "format": 1,
            "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
            "sliding": {"distance": 50.0},
        }
    )
    record = rubnoise.simulate(scenario)
    with rubnoise.run(scenario, tmp_path / "x.h5") as run:
        assert repr(record.trace) == repr(run.trace)
        assert record.junction(3) == run.junction(3)
        assert record.to_pandas()["trace"].equals(run.trace.to_pandas())
    np.testing.assert_array_equal(record.trace["distance"], record["trace"]["distance"])
    assert repr(record).startswith("a run in memory\n  .junctions ")
    for missing in (KeyError, AttributeError):
        with pytest.raises(missing, match=r"^the run has no slider; it has junctions, trace"):
            _ = record.slider
    assert not hasattr(record, "slider")
    assert "slider" not in record
    assert "slider" not in dir(record)
    assert "slider" in rubnoise.Run.__annotations__
    with rubnoise.open(tmp_path / "x.h5") as run:
        assert list(run) == [*record, "life_curve"]
        for each in (run, record):
            for group in each:
                assert f".{group} " in repr(each)
                assert group in each
                assert group in dir(each)
                column = getattr(each, group)[getattr(each, group).names[-1]]
                assert column.units == getattr(run, group)[column.name].units
