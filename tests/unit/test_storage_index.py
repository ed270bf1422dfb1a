"""The index of a sweep: it says what it was given, and what is no index is refused."""

import errno
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise.api.sweep_result import open_sweep
from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.index import Filled, Index, Stack, write_index
from rubnoise.storage.index_file import open_index
from rubnoise.storage.reader import TooNew, open_run
from rubnoise.storage.schema import Dataset, Feature
from rubnoise.sweep.index import figure, text, whole

# An index says what it was given; one that is none of ours, or leads elsewhere, is refused with the reason.
COUNT = 5


def _index(*more: Filled) -> Index:
    return Index(
        title="swept \u00b5",
        command="rubnoise sweep s.toml",
        scenario_toml="format = 1\n",
        scenario_resolved={"format": 1},
        grid=("output.tick",),
        side_by_side=(),
        points=[text("values", "", ['{"output.tick": "1 um"}'])],
        runs=[
            text("run_id", "name of the run", [f"{n:016x}" for n in range(COUNT)]),
            whole("point", "number of the point", [0] * COUNT),
            text("reason", "why it failed", ["", "no room: \u00b5", "", "", ""]),
            figure("real_contact_area_std", np.array([1.5, np.nan, 0.1, 0.2, 0.3])),
            *more,
        ],
        stacks=[
            Stack(
                rows=[0, 2],
                files=["runs/a.h5", "runs/b.h5"],
                features=frozenset({"speed", "strength"}),
                ticks=3,
                slider=0,
            )
        ],
        arrays_of_runs=[(2, {"spectrum": np.arange(4.0)}), (0, {"spectrum": -np.arange(4.0)})],
        arrays_of_points=[(0, {"spectrum_place": np.arange(4.0)})],
    )


def _written(path: Path, index: Index) -> Path:
    path.touch()
    write_index(path, index)
    return path


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return _written(tmp_path / "index.h5", _index())


def test_what_was_written_is_read(path: Path) -> None:
    with open_index(path) as index:
        assert index.attributes["title"] == "swept \u00b5"
        assert [about.name for about in index.columns("runs")] == [
            "run", "run_id", "point", "reason", "real_contact_area_std"
        ]  # fmt: skip
        assert index.read("runs", "run").tolist() == list(range(COUNT))
        assert index.read("runs", "reason").tolist() == ["", "no room: \u00b5", "", "", ""]
        assert index.read("runs", "run_id", 1, 3).tolist() == [f"{1:016x}", f"{2:016x}"]
        assert np.array_equal(index.read("runs", "real_contact_area_std"), [1.5, np.nan, 0.1, 0.2, 0.3], equal_nan=True)
        [std] = (about for about in index.columns("runs") if about.name == "real_contact_area_std")
        assert std == Dataset(
            name="real_contact_area_std", units="um^2", long_name="real contact area std", symbol="", dtype="<f8"
        )
        spectrum = index.read("summaries", "spectrum")
        assert spectrum.shape == (COUNT, 4)
        assert spectrum[2].tolist() == [0.0, 1.0, 2.0, 3.0]
        assert np.isnan(spectrum[1]).all()
        assert index.read("summaries", "spectrum_place").shape == (1, 4)
    with pytest.raises(ValueError, match="closed"):
        index.read("runs", "run")


@pytest.mark.parametrize("room", [0, 5_000, 12_000])
def test_a_disk_that_fills_up_is_raised_and_hdf5_ends_nothing(
    tmp_path: Path, room: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = disk.write_all

    def write_all(descriptor: int, data: memoryview, offset: int) -> None:
        if offset + len(data) > room:
            raise OSError(errno.ENOSPC, "No space left on device")
        whole(descriptor, data, offset)

    monkeypatch.setattr(disk, "write_all", write_all)
    with pytest.raises(OSError, match="No space left"):
        _written(tmp_path / "index.h5", _index())


def test_traces_refer_to_files_beside_the_index(path: Path) -> None:
    with h5py.File(path) as file:
        force = file["traces/0/trace/friction_force"]
        assert (force.shape, force.is_virtual) == ((2, 3), True)
        assert [source.file_name for source in force.virtual_sources()] == ["runs/a.h5", "runs/b.h5"]
        assert [source.dset_name for source in force.virtual_sources()] == ["/trace/friction_force"] * 2
        assert "slider" not in file["traces/0"]
        assert file["traces/0/trace/run"][:].tolist() == [0, 2]


@pytest.mark.parametrize(("rows", "shape"), [(5, (2, 5)), (None, None)])
def test_a_slider_is_stacked_by_rows_of_its_own(
    tmp_path: Path, rows: int | None, shape: tuple[int, int] | None
) -> None:
    features: frozenset[Feature] = frozenset({"speed", "strength", "slider"})
    stack = Stack(rows=[0, 2], files=["runs/a.h5", "runs/b.h5"], features=features, ticks=3, slider=rows)
    with h5py.File(_written(tmp_path / "index.h5", replace(_index(), stacks=[stack]))) as file:
        assert file["traces/0/trace/real_contact_area"].shape == (2, 3)
        there = file["traces/0"].get("slider")
        assert (None if there is None else there["velocity"].shape) == shape


def test_an_index_is_no_run_and_a_run_no_index(path: Path, tmp_path: Path) -> None:
    with pytest.raises(RunFileRefused, match="is the index of a sweep, not the result of a run"):
        open_run(path)
    (tmp_path / "text").write_text("no HDF5", encoding="utf-8")
    with pytest.raises(RunFileRefused, match="not an HDF5 file"):
        open_index(tmp_path / "text")
    with pytest.raises(RunFileRefused, match="no folder of a sweep"):
        open_sweep(tmp_path / "nowhere")


def _virtual(file: h5py.File) -> None:
    del file["runs/real_contact_area_std"]
    layout = h5py.VirtualLayout((COUNT,), "<f8")
    layout[:] = h5py.VirtualSource("/etc/passwd.h5", "x", shape=(COUNT,))
    file["runs"].create_virtual_dataset("real_contact_area_std", layout)


def _external(file: h5py.File) -> None:
    del file["runs/point"]
    file["runs"].create_dataset("point", (COUNT,), "<i8", external=[("/etc/passwd", 0, 8 * COUNT)])


def _linked(file: h5py.File) -> None:
    file["runs/other"] = h5py.ExternalLink("/etc/passwd.h5", "/x")


def _variable(file: h5py.File) -> None:
    file["runs"].create_dataset("other", data=["a"] * COUNT, dtype=h5py.string_dtype())


def _short(file: h5py.File) -> None:
    file["runs"].create_dataset("other", data=np.zeros(COUNT - 1))


def _crowded(file: h5py.File) -> None:
    for number in range(300):
        file["runs"].create_dataset(f"other{number}", data=np.zeros(COUNT))


def _newer(file: h5py.File) -> None:
    file.attrs.modify("format_version", 2)


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (_virtual, "/runs/real_contact_area_std is not stored as an index stores it"),
        (_external, "/runs/point is not stored as an index stores it"),
        (_linked, "/runs/other is no column"),
        (_variable, "/runs/other is not stored as an index stores it"),
        (_short, "/runs has columns of several lengths"),
        (_crowded, "/runs holds 305 objects"),
        (lambda file: file.pop("points"), "/points is missing"),
        (lambda file: file.attrs.pop("grid"), "attribute grid is missing"),
    ],
)
def test_what_an_index_is_not_is_refused(path: Path, spoil: Callable[[h5py.File], None], said: str) -> None:
    with h5py.File(path, "r+") as file:
        spoil(file)
    with pytest.raises(RunFileRefused, match=said):
        open_index(path)


def test_one_of_a_later_format_is_told_from_a_damaged_one(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        _newer(file)
    with pytest.raises(TooNew, match="has format version 2"):
        open_index(path)
