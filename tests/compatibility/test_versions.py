"""Files of other versions, and files that hold more than this version knows."""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import TooNew, open_run
from rubnoise.storage.schema import FORMAT_VERSION

HERE = Path(__file__).parent


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return a copy of the kept file that may be changed."""
    return Path(shutil.copy(HERE / "format_1.h5", tmp_path / "run.h5"))


def set_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Replace a text attribute by another of fixed length, as run files have them."""
    owner.attrs.create(name, np.array(text.encode()), dtype=h5py.string_dtype("utf-8", len(text)))


def test_every_version_up_to_the_present_one_is_kept() -> None:
    kept = {path.name for path in HERE.glob("*.h5")}
    assert kept == {f"format_{n}{kind}.h5" for n in range(1, FORMAT_VERSION + 1) for kind in ("", "_bare")}


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


def test_a_version_that_never_was_is_refused(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", 0)
    with pytest.raises(RunFileRefused, match="has format version 0, which does not exist"):
        open_run(path)


def test_a_newer_file_without_its_program_is_refused_too(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", FORMAT_VERSION + 1)
        del file.attrs["source"]
    with pytest.raises(RunFileRefused, match="source is missing"):
        open_run(path)


def test_unknown_groups_datasets_and_attributes_are_ignored(path: Path) -> None:
    with open_run(path) as run:
        known, extent = run.columns, run.extent
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
        assert (run.columns, run.extent) == (known, extent)
        assert {name: run.column("junctions", name).tobytes() for name in before} == before
        assert (run.attributes, run.provenance) == (attributes, provenance)
        assert run.damaged() == ()
