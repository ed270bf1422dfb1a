"""The index of a sweep: it says what it was given, and what is no index is refused."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise.api.sweep_result import open_sweep
from rubnoise.errors import RunFileRefused
from rubnoise.runs.index import figure, text, whole
from rubnoise.storage.index import Filled, Index, index_bytes, open_index
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import Dataset

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
        arrays_of_runs={"spectrum": np.arange(4.0 * COUNT).reshape(COUNT, 4)},
        arrays_of_points={"spectrum_place": np.arange(4.0)[None]},
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (path := tmp_path / "index.h5").write_bytes(index_bytes(_index()))
    return path


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
        assert index.read("summaries", "spectrum")[1].tolist() == [4.0, 5.0, 6.0, 7.0]
        assert index.read("summaries", "spectrum_place").shape == (1, 4)
        assert index.is_as_written()
    with pytest.raises(ValueError, match="closed"):
        index.read("runs", "run")


def test_an_index_that_was_replaced_gives_no_rows_of_the_other_one(path: Path) -> None:
    with open_index(path) as index:
        path.write_bytes(index_bytes(replace(_index(), title="another")))
        assert index.read("runs", "run").size == COUNT
        with pytest.raises(RunFileRefused, match="was replaced since it was opened"):
            index.read("summaries", "spectrum")


@pytest.mark.parametrize("name", ["runs/point", "points/values", "summaries/spectrum"])
def test_a_value_that_changed_is_noticed(path: Path, name: str) -> None:
    with h5py.File(path, "r+") as file:
        file[name][0] = file[name][0] + 1 if name != "points/values" else b"{}"
    with open_index(path) as index:
        assert index.damaged() == (f"/{name}",)
        assert not index.is_as_written()


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
    with pytest.raises(RunFileRefused, match="has format version 2"):
        open_index(path)
