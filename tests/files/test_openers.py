"""A result file is opened by other tools unaided, and they see what it means."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pint
import pytest
import xarray

from rubnoise.contact.pulses import LENS
from rubnoise.storage.layout import stored_groups
from rubnoise.storage.life_curve import CURVE_ROWS
from rubnoise.storage.schema import GROUPS, Group
from tests.files.runs import EVERYTHING, describe, random_rows, write_run

NAMES = {
    "junctions": "junction birth_distance death_distance life_distance diameter max_area shear_strength birth_time"
    " death_time state",
    "trace": "distance real_contact_area junction_count friction_force",
    "slider": "time distance friction_force displacement velocity",
    "life_curve": "u area_fraction",
}
UNITS = {
    "birth_distance": "um",
    "max_area": "um^2",
    "shear_strength": "MPa",
    "death_time": "s",
    "friction_force": "uN",
    "real_contact_area": "um^2",
    "junction_count": "1",
    "displacement": "um",
    "velocity": "um/s",
}


@pytest.fixture(params=["none", "gzip"])
def path(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    description = describe(compression=request.param)
    write_run(tmp_path / "run.h5", description, random_rows(description))
    return tmp_path / "run.h5"


def texts(owner: h5py.HLObject) -> dict[str, Any]:
    return {
        name: value.decode() if isinstance(value, bytes) else value
        for name, value in owner.attrs.items()
        if name not in ("DIMENSION_LIST", "REFERENCE_LIST")
    }


def test_h5py_finds_the_columns_in_their_order(path: Path) -> None:
    with h5py.File(path) as file:
        assert sorted(file) == sorted([*NAMES, "summary", "provenance"])
        for group, names in NAMES.items():
            assert list(file[group]) == names.split()
        assert file["junctions/junction"].dtype == np.int64
        assert file["junctions/state"].dtype == np.uint8
        assert file["trace/junction_count"].dtype == np.uint32
        assert file["slider/velocity"].dtype == np.float64


def test_every_column_says_what_it_is(path: Path) -> None:
    with h5py.File(path) as file:
        for group in stored_groups(EVERYTHING):
            for column in group.columns:
                said = texts(file[group.name][column.name])
                assert (said["units"], said["symbol"], said["long_name"]) == (
                    column.units,
                    column.symbol,
                    column.long_name,
                )
        for name, units in UNITS.items():
            owner = next(group for group in ("junctions", "trace", "slider") if name in file[group])
            assert texts(file[owner][name])["units"] == units


def test_root_and_groups_say_how_to_plot_them(path: Path) -> None:
    with h5py.File(path) as file:
        root = texts(file)
        assert root["Conventions"] == "CF-1.11"
        assert (root["format"], root["format_version"]) == ("rubnoise-run", 2)
        assert (root["NX_class"], root["default"]) == ("NXroot", "trace")
        assert root["title"] == "a small run of µm"
        assert root["source"].startswith("rubnoise ")
        assert "acos" in root["junction_area_formula"]
        for group, signal, axis in (("trace", "real_contact_area", "distance"), ("slider", "displacement", "time")):
            assert texts(file[group])["NX_class"] == "NXdata"
            assert texts(file[group])["signal"] == signal
            assert file[group].attrs["axes"].tolist() == [axis.encode()]


def test_dimension_scales_are_attached(path: Path) -> None:
    with h5py.File(path) as file:
        for group, names in NAMES.items():
            scale, *others = names.split()
            assert file[group][scale].is_scale
            for name in others:
                assert list(file[group][name].dims[0].values()) == [file[group][scale]]


def test_nothing_in_the_file_has_a_variable_length(path: Path) -> None:
    """Only the dimension scales of HDF5 itself hold references."""
    with h5py.File(path) as file:
        owners = [file]
        file.visititems(lambda _, item: owners.append(item))
        for owner in owners:
            for name in owner.attrs:
                scale_only = name in ("DIMENSION_LIST", "REFERENCE_LIST")
                assert (owner.attrs.get_id(name).dtype.kind in "OV") == scale_only
            if isinstance(owner, h5py.Dataset):
                assert owner.dtype.kind in "fiu"
                assert owner.id.get_create_plist().get_external_count() == 0


def test_columns_are_contiguous_and_readable_without_hdf5(tmp_path: Path) -> None:
    description = describe(70, 110)
    rows = random_rows(description)
    write_run(tmp_path / "run.h5", description, rows)
    with h5py.File(tmp_path / "run.h5") as file:
        offsets = {(g, n): file[g][n].id.get_offset() for g, columns in rows.items() for n in columns}
        assert all(file[group][name].chunks is None for group, name in offsets)
    for (group, name), offset in offsets.items():
        values = rows[group][name]
        found = np.fromfile(tmp_path / "run.h5", dtype=values.dtype, offset=offset, count=len(values))
        assert found.tobytes() == values.tobytes()


def test_gzip_comes_in_chunks_of_65536_rows(tmp_path: Path) -> None:
    description = describe(3, 70_000, compression="gzip")
    rows = random_rows(description)
    rows["trace"]["distance"] = np.arange(70_000) * 0.05
    write_run(tmp_path / "run.h5", description, rows)
    with h5py.File(tmp_path / "run.h5") as file:
        assert file["trace/distance"].chunks == (65_536,)
        assert file["trace/distance"].compression == "gzip"
        assert file["trace/distance"].id.get_storage_size() < 0.7 * 8 * 70_000


@pytest.mark.parametrize("group", stored_groups(EVERYTHING)[:3], ids=lambda group: group.name)
def test_xarray_has_named_variables_with_units(path: Path, group: Group) -> None:
    expected = random_rows(describe())[group.name]
    scale = group.columns[0].name
    with xarray.open_dataset(path, group=group.name, engine="h5netcdf") as found:
        assert list(found.sizes) == [scale]
        assert set(found.variables) == {column.name for column in group.columns}
        for column in group.columns:
            variable = found[column.name]
            assert variable.dims == (scale,)
            assert variable.attrs["units"] == column.units
            assert variable.attrs["long_name"] == column.long_name
            assert np.array_equal(variable.values, expected[column.name])
        assert found.attrs["long_name"] == group.long_name


def test_xarray_opens_the_root_and_the_provenance(path: Path) -> None:
    with xarray.open_dataset(path, engine="h5netcdf") as root:
        assert root.attrs["format"] == "rubnoise-run"
    with xarray.open_dataset(path, group="provenance", engine="h5netcdf") as origin:
        assert origin.attrs["seed"] == 2**53 - 1
        assert json.loads(origin.attrs["scenario_resolved"])["title"] == "µm"


def h5dump(*arguments: str | Path) -> str:
    program = shutil.which("h5dump")
    if program is None:
        # A warning would end the run, as every warning does here; a skip with its reason is listed at the end.
        pytest.skip("h5dump is not installed: files were NOT opened with HDF5 1.10 (apt-get install hdf5-tools)")
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=True).stdout


def test_h5dump_shows_structure_and_values(path: Path) -> None:
    shown = h5dump("-A", path)
    for names in NAMES.values():
        assert all(f'DATASET "{name}"' in shown for name in names.split())
    count = random_rows(describe())["trace"]["junction_count"]
    values = h5dump("-d", "/trace/junction_count", "-y", "-w", "0", path).split("DATA {")[1].split("}")[0]
    assert np.array_equal(np.array(values.split(","), dtype=np.uint32), count)


@pytest.mark.slow
@pytest.mark.parametrize("units", sorted({column.units for group in GROUPS for column in group.columns}))
def test_pint_reads_every_unit(units: str) -> None:
    base = {"um": 1e-6, "um^2": 1e-12, "MPa": 1e6, "s": 1.0, "um/s": 1e-6, "uN": 1e-6, "1": 1.0}
    base |= {"um*s": 1e-6, "um^2*s": 1e-12, "um^2/s": 1e-12, "uN*um": 1e-12}
    assert pint.UnitRegistry().Quantity(1.0, units).to_base_units().magnitude == pytest.approx(base[units])


def test_life_curve_gives_any_area_by_plain_interpolation(path: Path) -> None:
    with h5py.File(path) as file:
        u, fraction = file["life_curve/u"][:], file["life_curve/area_fraction"][:]
    assert len(u) == CURVE_ROWS
    assert (u[0], u[-1], fraction[0], fraction[-1]) == (0.0, 2.0, 0.0, 0.0)
    assert np.all(np.diff(u) > 0)
    distance = np.linspace(0.0, 2 * 5.53, 100_003)
    error = np.interp(distance / 5.53, u, fraction) - LENS.area(distance, 5.53) / 5.53**2
    assert np.abs(error).max() < 1e-6
    assert np.abs(np.interp(distance / 5.53, u[::2], fraction[::2]) - LENS.area(distance, 5.53) / 5.53**2).max() > 1e-6
