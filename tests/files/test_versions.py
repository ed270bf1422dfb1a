"""Files of the present format version are read as ever; those of others are refused in a sentence.

After FORMAT_VERSION has been raised, `python -m tests.files.test_versions` from the root writes the files of
the new version. Version 1, of which one file is kept, was never published.
"""

import hashlib
import json
import os
import platform
import shutil
from collections import Counter
from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import TooNew, open_run
from rubnoise.storage.schema import FORMAT_VERSION

# Files of format version 2, kept as they were written: what is read out of them never changes.
HERE = Path(__file__).parent
KEPT = json.loads((HERE / "kept.json").read_text(encoding="utf-8"))
"""What each file has, by the stem of its name."""

WHOLE, BARE = HERE / "format_2.h5", HERE / "format_2_bare.h5"
FILES = pytest.mark.parametrize("path", [WHOLE, BARE], ids=lambda path: path.stem)


@FILES
def test_the_kept_file_is_the_one_that_was_kept(path: Path) -> None:
    assert hashlib.sha256(path.read_bytes()).hexdigest() == KEPT[path.stem]["sha256"]


@FILES
def test_junction_3_is_what_it_was(path: Path) -> None:
    kept = KEPT[path.stem]["junction_3"]
    with open_run(path) as run:
        assert {name: run.column("junctions", name)[3] for name in run.columns["junctions"]} == kept
    with rubnoise.open(path) as opened:
        junction = opened.junction(3)
        assert {"junction": 3} | {name: getattr(junction, name) for name in kept if name != "junction"} == kept


@FILES
def test_every_column_is_there_and_has_its_hash(path: Path) -> None:
    kept = KEPT[path.stem]
    with open_run(path) as run:
        assert {name: list(run.columns[name]) for name in kept["columns"]} == kept["columns"]
        assert run.columns.keys() == {"junctions", "life_curve", *kept["columns"]}
        assert Counter(run.column("junctions", "state").tolist()) == dict(kept["states"])
        assert run.rows("trace") == kept["ticks"]
        assert run.damaged() == {}


@FILES
def test_a_changed_byte_is_noticed_in_any_column(path: Path, tmp_path: Path) -> None:
    shutil.copy(path, tmp_path / "run.h5")
    for group, names in KEPT[path.stem]["columns"].items():
        with h5py.File(tmp_path / "run.h5", "r+") as file:
            for name in names:
                file[group][name][7] += 1
        with open_run(tmp_path / "run.h5") as run:
            assert {f"/{group}/{name}" for name in names} <= set(run.damaged())


@FILES
def test_scenario_summary_and_origin_are_read(path: Path) -> None:
    kept = HERE / KEPT[path.stem]["scenario"]
    scenario = rubnoise.load(kept)
    with rubnoise.open(path) as run:
        assert run.provenance["scenario_toml"] == kept.read_text(encoding="utf-8")
        assert run.scenario.resolved() == scenario.resolved()
        assert run.provenance["calibrated_diameter"] == scenario.model().calibrated_diameter
        mean = next(figure for figure in run.summary if figure.name == "real_contact_area_mean")
    assert [mean.value, mean.exact] == KEPT[path.stem]["mean_area"]


# Files of other versions, and files that hold more than this version knows.
@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return a copy of the kept file that may be changed."""
    return Path(shutil.copy(WHOLE, tmp_path / "run.h5"))


def set_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Replace a text attribute by another of fixed length, as run files have them."""
    owner.attrs.create(name, np.array(text.encode()), dtype=h5py.string_dtype("utf-8", len(text)))


def test_the_present_version_is_kept() -> None:
    kept = {path.name for path in HERE.glob("*.h5")}
    assert kept == {"format_1_bare.h5", f"format_{FORMAT_VERSION}.h5", f"format_{FORMAT_VERSION}_bare.h5"}


def test_version_1_gets_a_sentence() -> None:
    path = HERE / "format_1_bare.h5"
    with pytest.raises(RunFileRefused) as refusal:
        open_run(path)
    assert str(refusal.value) == (
        f"{path}: has format version 1, and this rubnoise reads version {FORMAT_VERSION}: run its scenario again"
    )


def test_a_newer_version_is_refused_with_the_version_needed(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", FORMAT_VERSION + 1)
        set_text(file, "source", "rubnoise 7.3.0")
    with pytest.raises(TooNew) as refusal:
        open_run(path)
    assert str(refusal.value) == (
        f"{path}: has format version {FORMAT_VERSION + 1}, written by rubnoise 7.3.0; this one reads versions up to "
        f"{FORMAT_VERSION}. rubnoise 7.3.0 or later is needed"
    )
    assert refusal.value.exit_code == 2


def test_unknown_groups_datasets_and_attributes_are_ignored(path: Path) -> None:
    with open_run(path) as run:
        known, rows = run.columns, [run.rows(group) for group in run.columns]
        before = {name: run.column("junctions", name).tobytes() for name in run.columns["junctions"]}
        attributes, provenance = run.attributes, run.provenance
    with h5py.File(path, "r+") as file:
        file.create_group("notes/of/somebody").attrs["text"] = "of any length"
        file["notes"]["texts"] = ["of", "any", "length"]
        file["elsewhere"] = h5py.ExternalLink("missing.h5", "/")
        file["junctions"]["colour"] = np.zeros((2, 3), dtype=np.complex128)
        file["trace"]["nowhere"] = h5py.SoftLink("/missing")
        file["trace/distance"].attrs["remark"] = [1, 2, 3]
        for owner in (file, file["trace"], file["provenance"]):
            owner.attrs["remark"] = "of any length"
    with open_run(path) as run:
        assert (run.columns, [run.rows(group) for group in run.columns]) == (known, rows)
        assert {name: run.column("junctions", name).tobytes() for name in before} == before
        assert (run.attributes, run.provenance) == (attributes, provenance)
        assert run.damaged() == {}


def keep() -> None:
    """Run both scenarios into files that say nothing of the machine they were made on; refuses to replace one."""
    platform.platform, platform.machine, os.cpu_count = lambda: "Linux", lambda: "x86_64", lambda: 1
    for name, suffix in {"whole": "", "bare": "_bare"}.items():
        command = ["rubnoise", "run", f"{name}.toml"]
        path = HERE / f"format_{FORMAT_VERSION}{suffix}.h5"
        rubnoise.run(rubnoise.load(HERE / f"{name}.toml"), path, command=command).close()


if __name__ == "__main__":
    keep()
