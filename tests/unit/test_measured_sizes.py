"""Diameters of a file: read beside the scenario, kept with their hash, and never needed again."""

from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.scenario.fields import MOST
from rubnoise.scenario.points import run_id
from rubnoise.scenario.reading import hash_of, loads
from tests.cli.terminal import call

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


WRONG = {
    "no file": ("", "diameter.file: {0}sizes.csv: no such file"),
    "a folder": ("folder", "diameter.file: {0}sizes.csv: is not a regular file"),
    "another column": ("size\n4\n5\n", "diameter.column: {0}sizes.csv: column=: diameter is none of the columns size"),
    "no values": ("diameter\n", "diameter.file: {0}sizes.csv"),
    "an empty cell": ("a,diameter\n1,4\n2,\n3,4\n", "line 3: diameter: '' is no number"),
    "a text": ("a,diameter\n1,4\n2,5\n3,five\n4,6\n", "line 4: diameter: 'five' is no number"),
    "no number": ("diameter\n4\nnan\n", "line 3: diameter is nan"),
    "a zero": ("diameter\n4\n0\n", "line 3: diameter is 0; must be above 0"),
    "a negative one": ("diameter\n4\n-5\n", "line 3: diameter is -5; must be above 0"),
    "one too large": ("diameter\n4\n1e13\n", "line 3: diameter is 1e+13; possible: 1e-12 to 1e+12 um"),
    "a force": ("diameter (N)\n4\n5\n", "has the unit N; diameters are lengths"),
    "too many": ("diameter\n" + "4\n" * (MOST + 1), f"has more than {MOST:,} values"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_file_of_sizes_is_refused(folder: Path, name: str) -> None:
    text, said = WRONG[name]
    place = folder / "sizes.csv"
    place.unlink()
    if text == "folder":
        place.mkdir()
    elif text:
        place.write_text(text, encoding="utf-8")
    answer = call("run", str(folder / "contact.toml"), "-o", str(folder / "a.h5"))
    assert answer.code == 2
    assert said.format(f"{folder}/") in answer.err
    assert not (folder / "a.h5").exists()


@pytest.mark.parametrize(
    ("column", "said"),
    [
        (
            "/junctions/size",
            "diameter.column: sizes.h5: /junctions/size is no dataset in it; it has junctions/diameter, strain",
        ),
        ("/strain", "diameter.column: sizes.h5: /strain has 2 dimensions"),
        ("", "diameter.column: sizes.h5: which dataset?"),
    ],
)
def test_what_is_no_dataset_of_sizes_is_refused(
    folder: Path, column: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    with pytest.raises(Refused, match=said.replace("?", r"\?")):
        rubnoise.load("contact.toml", ["diameter.file=sizes.h5", f"diameter.column={column}"])


def test_a_file_that_changed_is_refused(folder: Path) -> None:
    before = rubnoise.load(folder / "contact.toml").diameter.hash
    (folder / "sizes.csv").write_text("diameter\n4\n5\n", encoding="utf-8")
    after = rubnoise.load(folder / "contact.toml").diameter.hash
    answer = call("run", str(folder / "contact.toml"), "--set", f"diameter.hash={before}")
    assert answer.code == 2
    assert f'diameter.hash: the file changed: "sizes.csv" has {after}, not {before}' in answer.err


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('values = [4, 5]\nfile = "sizes.csv"\n', "diameter.values: both values and file are given"),
        (
            'values = [4, 5]\nfile = "sizes.csv"\nhash = "abc"\n',
            f"diameter.hash: the values beside it have {hash_of((4, 5))}, not abc",
        ),
        ('values = [4, 5]\ncolumn = "a"\n', "diameter.column: a column needs a file"),
        ('values = [4, 5]\nhash = "abc"\n', "diameter.hash: a hash needs a file"),
        ('values = "a"\nfile = "sizes.csv"\nhash = "abc"\n', "diameter.values: needs a list"),
        ("file = 3\n", "diameter.file: needs a text"),
        ("", 'diameter.values: missing; the law "empirical" needs a values'),
        ('file = "sizes.csv"\n', "diameter.file: sizes.csv: is read by rubnoise.load"),
    ],
)
def test_keys_that_contradict_are_refused(table: str, said: str) -> None:
    with pytest.raises(Refused) as refused:
        loads(HEAD + f'[diameter]\nlaw = "empirical"\n{table}' + RUN)
    assert said in str(refused.value)


def test_values_take_the_place_of_a_file(folder: Path) -> None:
    found = rubnoise.load(folder / "contact.toml").replace({"diameter.values": [4, 5]})
    assert (found.diameter.file, found.diameter.hash) == (None, None)
    with pytest.raises(Refused, match=r"diameter.file: other.csv: is read by rubnoise\.load"):
        found.replace({"diameter.file": "other.csv"})
