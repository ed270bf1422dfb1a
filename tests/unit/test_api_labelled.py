"""Results as xarray and pandas have them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import rubnoise
from tests.cli.terminal import WITH_SLIDER


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("labelled")
    (folder / "given.toml").write_text(WITH_SLIDER, encoding="utf-8")
    rubnoise.run(rubnoise.load(folder / "given.toml"), folder / "x.h5").close()
    return folder / "x.h5"


@pytest.fixture
def run(path: Path) -> Iterator[rubnoise.Run]:
    with rubnoise.open(path) as opened:
        yield opened


@pytest.mark.parametrize("index", [True, False])
def test_a_tree_holds_every_group_with_units(run: rubnoise.Run, index: bool) -> None:  # noqa: FBT001
    tree = run.to_xarray(index=index)
    assert set(tree.children) == {"junctions", "trace", "slider", "blocks", "life_curve"}
    assert tree.attrs == run.attributes
    for name, columns in run.groups().items():
        for column in columns:
            variable = tree[name][column]
            assert variable.attrs["units"] == columns[column].units
            assert variable.dtype == columns[column].dtype
            np.testing.assert_array_equal(variable.values, columns[column][:])
    assert ("distance" in tree["trace"].to_dataset().xindexes) == index


def test_it_is_what_xarray_finds_in_the_file_itself(run: rubnoise.Run, path: Path) -> None:
    for name, columns in run.groups().items():
        with xr.open_dataset(path, group=name, engine="h5netcdf") as theirs:
            xr.testing.assert_equal(columns.to_xarray(), theirs)


def test_rows_are_found_by_distance_and_by_number(run: rubnoise.Run) -> None:
    trace, junctions = run.trace.to_xarray(), run.junctions.to_xarray()
    near = trace["real_contact_area"].sel(distance=150.03, method="nearest")
    assert near.item() == run.trace["real_contact_area"][1500]
    stretch = trace.sel(distance=slice(10.0, 20.0))["friction_force"]
    np.testing.assert_array_equal(stretch.values, run.trace["friction_force"][100:201])
    assert junctions["diameter"].sel(junction=17).item() == run.junction(17).diameter
    chosen = junctions["diameter"].isel(junction=[5, 2, 2])
    np.testing.assert_array_equal(chosen.values, run.junctions["diameter"][[5, 2, 2]])
    every = junctions["diameter"][::-7]
    np.testing.assert_array_equal(every.values, run.junctions["diameter"][::-7])


def test_what_was_read_outlives_the_run(path: Path, tmp_path: Path) -> None:
    with rubnoise.open(path) as run:
        lazy = run.trace.to_xarray()
        kept = lazy.copy(deep=True).load()
        lazy.isel(distance=slice(9)).to_netcdf(tmp_path / "nine.nc")
        area = run.trace["real_contact_area"][:]
    np.testing.assert_array_equal(kept["real_contact_area"].values, area)
    with xr.open_dataset(tmp_path / "nine.nc") as nine:
        assert nine["real_contact_area"].attrs["units"] == "um^2"
    with rubnoise.open(path) as run:
        unread = run.trace.to_xarray()
    with pytest.raises(ValueError, match=r"x\.h5: the run file is closed"):
        unread["real_contact_area"].load()


def test_pandas_gets_a_frame_over_the_first_column(run: rubnoise.Run) -> None:
    frame = run.trace.to_pandas()
    assert isinstance(frame, pd.DataFrame)
    assert (frame.index.name, list(frame)) == ("distance", list(run.trace.names[1:]))
    assert frame.attrs["units"] == {name: run.trace[name].units for name in run.trace}
    np.testing.assert_array_equal(frame["real_contact_area"], run.trace["real_contact_area"])
    assert frame.loc[10.0:20.0].shape == (101, 3)
    assert {name: len(each) for name, each in run.to_pandas().items()} == {
        name: len(columns) for name, columns in run.groups().items()
    }


def test_pandas_gets_only_what_is_named(run: rubnoise.Run) -> None:
    frame = run.junctions.to_pandas(["diameter", "state"])
    assert list(frame) == ["diameter", "state"]
    assert frame["state"].dtype == np.uint8
    assert frame["diameter"][17] == run.junction(17).diameter
    with pytest.raises(KeyError, match="no column 'diametre'"):
        run.junctions.to_pandas(["diametre"])
