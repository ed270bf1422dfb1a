"""The index of a sweep: it says what it was given, and what is no index is refused."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise.api.sweep_result import open_sweep
from rubnoise.errors import RunFileRefused
from rubnoise.runs.folder import _column, figure_columns
from rubnoise.storage.index import Index, index_bytes, read_index, sealed
from rubnoise.storage.reader import open_run

# An index says what it was given; one that is none of ours, or leads elsewhere, is refused with the reason.
COUNT = 5


def _index() -> Index:
    figures = [{"real_contact_area_std": each} for each in (1.5, np.nan, 0.1, 0.2, 0.3)]
    numbers, runs = [0] * COUNT, [f"{n:016x}" for n in range(COUNT)]
    columns = [
        _column("run", "row number of the run", np.arange(COUNT)),
        _column("run_id", "name of the run", runs),
        _column("point", "number of the point", numbers),
        _column("replicate", "number of the run among those of its point", np.arange(COUNT)),
        _column("seed", "", np.arange(COUNT)),
        _column("file", "", [""] * COUNT),
        _column("state", "", ["done"] * COUNT),
        _column("reason", "why it failed", ["", "no room: \u00b5", "", "", ""]),
        *figure_columns(figures),
    ]
    points = [_column("point", "number of the point", [0]), _column("values", "", ['{"output.tick": "1 um"}'])]
    texts = ("title", "source", "written", "command", "scenario_toml", "scenario_resolved", "grid", "side_by_side")
    return Index(
        texts=dict.fromkeys(texts, "swept \u00b5"),
        points={each.about.name: each for each in points},
        runs={each.about.name: each for each in columns},
        summaries={"spectrum": np.arange(4.0 * COUNT).reshape(COUNT, 4), "spectrum_place": np.arange(4.0)[None]},
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (path := tmp_path / "index.h5").write_bytes(index_bytes(_index()))
    return path


def test_what_was_written_is_read(path: Path) -> None:
    found, right = read_index(path), _index()
    assert found.texts == right.texts
    for one, other in ((found.points, right.points), (found.runs, right.runs)):
        assert [*one] == [*other]
        assert [each.about for each in one.values()] == [each.about for each in other.values()]
        assert [each.values.tobytes() for each in one.values()] == [each.values.tobytes() for each in other.values()]
    assert found.runs["real_contact_area_std"].about.units == "um^2"
    assert found.summaries["spectrum"][1].tolist() == [4.0, 5.0, 6.0, 7.0]
    assert found.summaries["spectrum_place"].shape == (1, 4)


@pytest.mark.parametrize("name", ["runs/point", "points/values", "summaries/spectrum"])
def test_an_index_in_which_a_value_changed_is_refused(path: Path, name: str) -> None:
    with h5py.File(path, "r+") as file:
        file[name][0] = file[name][0] + 1 if name != "points/values" else b"{}"
    with pytest.raises(RunFileRefused, match=r"index\.h5: damaged: is not as it was written; the same"):
        read_index(path)


def test_an_index_is_no_run_and_a_run_no_index(path: Path, tmp_path: Path) -> None:
    with pytest.raises(RunFileRefused, match="is the index of a sweep, not the result of a run"):
        open_run(path)
    (tmp_path / "text").write_text("no HDF5", encoding="utf-8")
    with pytest.raises(RunFileRefused, match="not an HDF5 file"):
        read_index(tmp_path / "text")
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


def _crowded(file: h5py.File) -> None:
    for number in range(300):
        file["runs"].create_dataset(f"other{number}", data=np.zeros(COUNT))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (_virtual, "/runs/real_contact_area_std is not stored as our files store it"),
        (_external, "/runs/point is not stored as our files store it"),
        (_linked, "/runs/other is missing"),
        (_variable, "/runs/other is not stored as our files store it"),
        (_crowded, "/runs holds 309 objects"),
        (lambda file: file.pop("points"), "/points is missing"),
        (lambda file: file.attrs.pop("grid"), "attribute grid is missing"),
    ],
)
def test_what_an_index_is_not_is_refused(path: Path, spoil: Callable[[h5py.File], None], said: str) -> None:
    with h5py.File(path, "r+") as file:
        spoil(file)
    path.write_bytes(sealed(path.read_bytes()))
    with pytest.raises(RunFileRefused, match=said):
        read_index(path)


def test_one_of_a_later_format_is_told_from_a_damaged_one(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", 2)
    with pytest.raises(RunFileRefused, match="has format version 2"):
        read_index(path)
