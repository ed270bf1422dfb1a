"""Columns of a result: arrays to look at, read as far as they are looked at."""

import sys
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import signal

import rubnoise
from rubnoise import arrays
from rubnoise.api import columns as module
from rubnoise.errors import ExtraMissing
from rubnoise.storage.schema import TRACE, Dataset
from tests.format.runs import describe, random_rows, write_run

AREA = TRACE.columns[1]
ROWS = 1000
STOPS = (None, 0, 9, -1, -2000, 1000, 5000)
STEPS = (None, 1, 2, 63, 64, 65, 700, -1, -3, -100)
VALUES = np.random.default_rng(1).normal(size=ROWS)


class Source:
    """Rows that remember how many of them were read."""

    def __init__(self, values: NDArray[Any] = VALUES) -> None:
        self.values = values
        self.read = 0
        self.most = 0

    def __call__(self, start: int, stop: int) -> NDArray[Any]:
        assert 0 <= start <= stop <= self.values.size
        self.read += stop - start
        self.most = max(self.most, stop - start)
        return self.values[start:stop].copy()


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    for place in (module, arrays):
        monkeypatch.setattr(place, "CHUNK_ROWS", 64)
    monkeypatch.setattr(module.Column.chunks, "__defaults__", (64,))


@pytest.fixture
def source() -> Source:
    return Source()


@pytest.fixture
def column(source: Source) -> rubnoise.Column:
    return rubnoise.Column(AREA, ROWS, source)


@pytest.mark.parametrize("start", [None, 0, 7, -3, -1001, 999, 1000, 5000])
def test_slices_are_those_of_an_array(column: rubnoise.Column, start: int | None) -> None:
    for stop, step in product(STOPS, STEPS):
        where = slice(start, stop, step)
        found, wanted = column[where], VALUES[where]
        assert found.dtype == wanted.dtype
        np.testing.assert_array_equal(found, wanted, err_msg=str(where))


@pytest.mark.parametrize(
    ("where", "rows"),
    [
        (slice(100), 100),
        (slice(-5, None), 5),
        (17, 1),
        (-1, 1),
        (np.int64(3), 1),
        (slice(None, None, 500), 2),
        (slice(None, 64, 9), 64),
        ([4, -996, 4, 8], 5),
        (slice(5, 5), 0),
        ([], 0),
        ((), ROWS),
    ],
)
def test_no_more_is_read_than_holds_what_was_asked_for(
    column: rubnoise.Column, source: Source, where: Any, rows: int
) -> None:
    np.testing.assert_array_equal(column[where], VALUES[where])
    assert source.read == rows


def test_a_mask_picks_rows(column: rubnoise.Column) -> None:
    np.testing.assert_array_equal(column[column > 1.0], VALUES[VALUES > 1.0])


@pytest.mark.parametrize("where", [1000, -1001, [0, 1000], [-1001]])
def test_rows_there_are_none_of_are_refused(column: rubnoise.Column, where: Any) -> None:
    with pytest.raises(IndexError, match="real_contact_area has 1000 rows"):
        column[where]


@pytest.mark.parametrize("where", ["0", 1.5, [0.0]])
def test_what_is_no_row_number_is_refused(column: rubnoise.Column, where: Any) -> None:
    with pytest.raises(IndexError, match="numbered 0 to 999"):
        column[where]


def test_chosen_rows_are_read_panel_by_panel(column: rubnoise.Column, source: Source) -> None:
    rows = np.array([3, 5, 200, 201, 999])
    taken = column.taken(rows)
    assert source.read == 0
    np.testing.assert_array_equal(taken[:], VALUES[rows])
    np.testing.assert_array_equal(taken[1:4], VALUES[rows[1:4]])
    assert source.most <= 64
    assert column.taken(rows[:0])[:].size == 0


@pytest.mark.parametrize(
    "where",
    [
        (slice(3),),
        (slice(None), None),
        (None, slice(None, None, -2)),
        None,
        ...,
        (..., None),
        (3, None),
        (None, 3),
        (VALUES > 1.0, None),
        (..., slice(5, 1, -1)),
        (None, ..., None),
        np.array([[1, 2], [3, -4]]),
        VALUES > 2.0,
        [True] * 3 + [False] * (ROWS - 3),
    ],
    ids=str,
)
def test_tuples_none_and_masks_are_those_of_an_array(column: rubnoise.Column, where: Any) -> None:
    assert column[where].shape == VALUES[where].shape
    np.testing.assert_array_equal(column[where], VALUES[where])


@pytest.mark.parametrize("where", [(0, 0), (slice(None), slice(None)), (..., ...), np.ones(7, dtype=bool)])
def test_what_an_array_refuses_is_refused(column: rubnoise.Column, where: Any) -> None:
    with pytest.raises(IndexError):
        VALUES[where]
    with pytest.raises(IndexError):
        column[where]


def test_reductions_of_numpy_hold_no_whole_column(column: rubnoise.Column, source: Source) -> None:
    for function, options in (
        (np.sum, {}),
        (np.mean, {}),
        (np.var, {"ddof": 1}),
        (np.std, {}),
        (np.min, {}),
        (np.max, {}),
    ):
        assert function(column, **options) == pytest.approx(function(VALUES, **options), rel=1e-12)
    assert source.most == 64
    assert np.mean(column, axis=0) == pytest.approx(VALUES.mean(), rel=1e-12)
    assert source.most == ROWS  # an option that a column does not have reads all of it


def test_polars_takes_a_column_as_it_stands(column: rubnoise.Column) -> None:
    pl = pytest.importorskip("polars")
    assert pl.DataFrame({"area": column})["area"].to_list() == VALUES.tolist()
    assert pl.Series("area", column).dtype == pl.Float64


def test_libraries_take_a_column_as_it_stands(column: rubnoise.Column) -> None:
    frame = pd.DataFrame({"area": column})
    assert frame["area"].to_numpy().tolist() == VALUES.tolist()
    density = signal.welch(VALUES, nperseg=100)[1]
    np.testing.assert_allclose(signal.welch(column, nperseg=100)[1], density, rtol=1e-12)
    figure = Figure()
    (line,) = figure.subplots().plot(column, 2.0 * column)
    np.testing.assert_array_equal(line.get_xdata(), VALUES)
    np.testing.assert_array_equal(xr.DataArray(column, dims="row"), VALUES)
    assert column.tolist() == column.values.tolist() == column.to_numpy().tolist()
    assert column.astype(np.float32).dtype == np.float32


def test_whole_column_figures_are_those_of_the_array_in_chunks(column: rubnoise.Column, source: Source) -> None:
    assert column.mean() == pytest.approx(VALUES.mean(), rel=1e-12)
    assert column.std() == pytest.approx(VALUES.std(), rel=1e-12)
    assert (column.min(), column.max()) == (VALUES.min(), VALUES.max())
    assert list(column) == VALUES.tolist()
    assert source.most == 64


def test_without_rows_there_is_no_mean(source: Source) -> None:
    empty = rubnoise.Column(AREA, 0, Source(VALUES[:0]))
    assert np.isnan([empty.mean(), empty.std()]).all()
    assert (len(empty), empty[:].size, list(empty)) == (0, 0, [])
    with pytest.raises(ValueError, match="empty"):
        empty.max()


def test_numpy_takes_a_column_for_an_array(column: rubnoise.Column) -> None:
    assert (column.shape, column.size, column.ndim, column.dtype) == ((ROWS,), ROWS, 1, VALUES.dtype)
    np.testing.assert_array_equal(np.asarray(column), VALUES)
    assert np.asarray(column, dtype=np.float32).dtype == np.float32
    np.testing.assert_array_equal(2.0 * column - column / 4.0, 2.0 * VALUES - VALUES / 4.0)
    np.testing.assert_array_equal(np.concatenate([column, column]), np.tile(VALUES, 2))
    assert np.mean(column) == pytest.approx(VALUES.mean(), rel=1e-12)
    assert np.interp(0.5, np.arange(2), column[:2]) == VALUES[:2].mean()
    assert (column == VALUES).all()
    with pytest.raises(ValueError, match="no array to share"):
        np.asarray(column, copy=False)
    with pytest.raises(TypeError):
        np.add(VALUES, VALUES, out=column)


def test_looking_at_a_column_reads_four_rows(column: rubnoise.Column, source: Source) -> None:
    shown = repr(column)
    assert shown.startswith("<real_contact_area (um^2), 1,000 rows of float64: 0.345584 0.821618 0.330437 ... ")
    assert source.read == 4


def test_a_short_column_is_shown_whole() -> None:
    assert repr(rubnoise.Column(AREA, 2, Source(np.array([1.0, 2.5])))).endswith("2 rows of float64: 1 2.5>")
    words = np.array(["done", "failed", "x" * 99])
    states = rubnoise.Column(Dataset(name="state", units="", long_name="", symbol="", dtype="<U99"), 3, Source(words))
    assert repr(states) == f"<state, 3 rows of text: done failed {'x' * 40}>"


def test_groups_show_names_units_and_meaning(tmp_path: Path) -> None:
    description = describe()
    write_run(tmp_path / "x.h5", description, random_rows(description))
    with rubnoise.open(tmp_path / "x.h5") as run:
        assert "/trace: the contact at every tick of sliding distance, 11 rows" in repr(run.trace)
        assert "  real_contact_area  um^2   real contact area" in repr(run.trace)
        assert repr(run).startswith(f"{tmp_path / 'x.h5'}: a small run of µm\n  .junctions ")
        assert (next(iter(run.trace)), len(run.trace), "nonsense" in run.trace) == ("distance", 11, False)
        assert set(dict(run.trace)) == set(run.trace.names)
        area = run.trace["real_contact_area"]
    assert repr(run).endswith("x.h5: a run, closed")
    assert repr(area).endswith("closed>")


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
    assert "slider" in dir(rubnoise.Run)
    with rubnoise.open(tmp_path / "x.h5") as run:
        assert list(run) == [*record, "life_curve"]
        for each in (run, record):
            for group in each:
                assert f".{group} " in repr(each)
                assert group in each
                assert group in dir(each)
                column = getattr(each, group)[getattr(each, group).names[-1]]
                assert column.units == getattr(run, group)[column.name].units


@pytest.mark.parametrize(("library", "method"), [("xarray", "to_xarray"), ("pandas", "to_pandas")])
def test_a_missing_library_is_named_with_its_extra(
    column: rubnoise.Column, monkeypatch: pytest.MonkeyPatch, library: str, method: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    monkeypatch.delitem(sys.modules, "rubnoise.api.labelled", raising=False)
    monkeypatch.delattr("rubnoise.api.labelled", raising=False)
    with pytest.raises(ExtraMissing, match=rf"{method} needs {library}: python3 .*tools/dev.py sync$"):
        getattr(rubnoise.Columns(TRACE, {AREA.name: column}), method)()
