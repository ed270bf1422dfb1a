"""Diameters of a file: read beside the scenario, kept with their hash, and never needed again."""

from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.scenario.reading import hash_of, loads
from rubnoise.scenario.sweep import run_id
from tests.shell.terminal import call

HEAD = 'format = 1\n[interface]\nmean_real_contact_area = "200 um^2"\nmean_junction_count = 20\n'
RUN = '[sliding]\ndistance = "300 um"\n[run]\nengine = "batch"\n'
TABLE = '[diameter]\nlaw = "empirical"\nfile = "sizes.csv"\ncolumn = "diameter"\n'
SIZES = [4.0, 5.5, 8.5]
CHANGES = ["diameter.sampled=alive", "sliding.distance=2 mm"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a scenario and its sizes, not at even steps and in mm, and the same in HDF5."""
    (tmp_path / "measured").mkdir()
    rows = "".join(f"{at},{size / 1000:g}\n" for at, size in zip((1, 7, 8), SIZES, strict=True))
    (tmp_path / "measured" / "sizes.csv").write_text(f"birth_distance (um),diameter (mm)\n{rows}", encoding="utf-8")
    with h5py.File(tmp_path / "measured" / "sizes.h5", "w") as file:
        file["junctions/diameter"] = np.array(SIZES)
        file["junctions/diameter"].attrs["units"] = "um"
        file["strain"] = np.eye(2)
    (tmp_path / "measured" / "contact.toml").write_text(HEAD + TABLE + RUN, encoding="utf-8")
    return tmp_path / "measured"


def test_a_file_is_its_values_and_their_hash(folder: Path) -> None:
    """The file lies beside the scenario, wherever it is read from; where sizes were read names no run."""
    found = rubnoise.load(folder / "contact.toml")
    assert found.diameter.values == pytest.approx(SIZES, rel=1e-15)
    assert found.diameter.hash == hash_of(found.diameter.values or ())
    of_hdf5 = rubnoise.load(
        folder / "contact.toml", ["diameter.column=/junctions/diameter", f"diameter.file={folder}/sizes.h5"]
    )
    assert of_hdf5.diameter.values == tuple(SIZES)
    listed = loads(HEAD + f'[diameter]\nlaw = "empirical"\nvalues = {SIZES}\n' + RUN)
    assert listed.model() == of_hdf5.model()
    assert run_id(listed) == run_id(of_hdf5)
    pinned = rubnoise.load(folder / "contact.toml", [f"diameter.hash={found.diameter.hash}"])
    assert pinned.resolved() == found.resolved()


@pytest.mark.slow
def test_no_result_needs_the_file_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder.parent)
    monkeypatch.setenv("COLUMNS", "200")
    changes = [word for change in CHANGES for word in ("--set", change)]
    assert call("run", "measured/contact.toml", "-o", "whole.h5", *changes).code == 0

    (folder / "sizes.csv").unlink()
    assert call("run", "measured/contact.toml").code == 2
    assert call("verify", "whole.h5").code == 0
    with rubnoise.open("whole.h5") as one:
        assert one.scenario.diameter.values == pytest.approx(SIZES)
        other = rubnoise.simulate(one.scenario)
        assert np.array_equal(one.trace["real_contact_area"], other.trace["real_contact_area"])
        assert rubnoise.build(one.scenario.to_dict()).model() == one.scenario.model()
        assert loads(one.scenario.to_toml()).model() == one.scenario.model()
        assert one.scenario.replace(seed=3).diameter == one.scenario.diameter


@pytest.mark.slow
def test_a_sweep_goes_over_files(folder: Path) -> None:
    (folder / "other.csv").write_text("diameter\n3\n9\n", encoding="utf-8")
    table = (
        '[sweep]\n[sweep.grid]\ndiameter.file = ["sizes.csv", "other.csv"]\ninterface.mean_junction_count = [10, 20]\n'
    )
    (folder / "sweep.toml").write_text(HEAD + TABLE.replace('file = "sizes.csv"\n', "") + RUN + table, encoding="utf-8")
    place = folder / "swept"
    with rubnoise.sweep(folder / "sweep.toml", place, jobs=1) as swept:
        sizes = [
            point.scenario.diameter.values for point in rubnoise.expand(rubnoise.load_sweep(folder / "sweep.toml"))
        ]
        assert len(swept.points) == 4
        assert sizes[0] == sizes[1] == pytest.approx(SIZES)
        assert sizes[2] == sizes[3] == (3.0, 9.0)
    asked = rubnoise.load(folder / "contact.toml")
    with rubnoise.sweep(
        asked, grid={"diameter.file": [f"{folder}/sizes.csv", f"{folder}/other.csv"]}, jobs=1
    ) as of_python:
        assert len(of_python.points) == 2
    for name in ("sizes.csv", "other.csv"):
        (folder / name).unlink()
    assert call("verify", str(place)).code == 0


@pytest.mark.parametrize(("kind", "said"), [("no file", "no such file"), ("a folder", "is not a regular file")])
def test_what_is_no_file_of_sizes_is_refused(folder: Path, kind: str, said: str) -> None:
    (place := folder / "sizes.csv").unlink()
    if kind == "a folder":
        place.mkdir()
    answer = call("run", str(folder / "contact.toml"), "-o", str(folder / "a.h5"))
    assert (answer.code, f"diameter.file: {place}: {said}" in answer.err) == (2, True)
    assert not (folder / "a.h5").exists()


def test_a_file_that_changed_is_refused(folder: Path) -> None:
    before = rubnoise.load(folder / "contact.toml").diameter.hash
    (folder / "sizes.csv").write_text("diameter\n4\n5\n", encoding="utf-8")
    after = rubnoise.load(folder / "contact.toml").diameter.hash
    answer = call("run", str(folder / "contact.toml"), "--set", f"diameter.hash={before}")
    assert answer.code == 2
    assert f'diameter.hash: the file changed: "sizes.csv" has {after}, not {before}' in answer.err


def test_values_take_the_place_of_a_file(folder: Path) -> None:
    found = rubnoise.load(folder / "contact.toml").replace({"diameter.values": [4, 5]})
    assert (found.diameter.file, found.diameter.hash) == (None, None)
    with pytest.raises(Refused, match=r"diameter.file: other.csv: is read by rubnoise\.load"):
        found.replace({"diameter.file": "other.csv"})
