"""Verification of attributes and of folders of sweeps: every change is named."""

from collections.abc import Callable
from pathlib import Path
from shutil import copy, copytree

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.runs.verification import verify, verify_sweep
from rubnoise.storage.index import sealed
from rubnoise.storage.reader import open_run
from tests.unit.scenarios import SHORT_HEAD, SMALL, sweep_of
from tests.unit.tampering import forget, put_seal, put_text, run_of, tell

pytestmark = pytest.mark.slow

# What a result says of itself: every attribute, unit, figure and name is asked, and a change of one is named.
Change = Callable[[Path], None]


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run_of(tmp_path_factory.mktemp("attributes") / "x.h5", sliding={"distance": "150 um"})


@pytest.fixture
def result(original: Path, tmp_path: Path) -> Path:
    return Path(copy(original, tmp_path / "x.h5"))


def told(path: Path) -> dict[str, str]:
    """Return the first place of each check that fails."""
    with open_run(path) as run:
        return {check.name: str(check.first) for check in verify(run).different}


def edited(by: Callable[[h5py.File], object]) -> Change:
    """Return a change by plain h5py, with the hash of all attributes put right after it."""

    def change(path: Path) -> None:
        with h5py.File(path, "r+") as file:
            by(file)
            put_seal(file)

    return change


def text(owner: str, name: str, value: str) -> Change:
    return edited(lambda file: put_text(file[owner], name, value))


def without_sizes(path: Path) -> None:
    """Take `d` out of the formula of an area."""
    tell(path, "/", "junction_area_formula", "A = pi u")


CHANGES: dict[str, tuple[Change, str, str]] = {
    "a unit": (text("junctions/diameter", "units", "mm"), "attributes", "/junctions/diameter units"),
    "a long name": (text("slider/velocity", "long_name", "displacement"), "attributes", "/slider/velocity long_name"),
    "the meaning of a flag": (text("junctions/state", "flag_meanings", "a b c"), "attributes", "/junctions/state flag"),
    "the bits of a flag": (
        edited(lambda file: file["junctions/state"].attrs.modify("flag_masks", np.zeros(3, "|u1"))),
        "attributes",
        "/junctions/state flag_masks",
    ),
    "the formula": (without_sizes, "attributes", "/ junction_area_formula"),
    "the convention": (text("/", "Conventions", "CF-1.0"), "attributes", "/ Conventions"),
    "a title": (text("/", "title", "another"), "", ""),  # the scenario has none: it was the name of the file
    "the stream version": (
        lambda path: tell(path, "provenance", "stream_version", 0),
        "attributes",
        "stream",
    ),
    "a standard error": (
        lambda path: tell(path, "summary", "real_contact_area_mean_standard_error", 1000.0),
        "summary",
        "/summary real_contact_area_mean_standard_error",
    ),
    "a standard error that is none": (
        lambda path: tell(path, "summary", "friction_force_std_standard_error", float("nan")),
        "summary",
        "/summary friction_force_std_standard_error",
    ),
    "a figure that nobody asked for": (
        lambda path: tell(path, "summary", "wear_rate", 1.0),
        "summary",
        "/summary wear_rate",
    ),
    "a figure that is missing": (
        lambda path: forget(path, "summary", "displacement_std_exact"),
        "summary",
        "/summary displacement_std_exact",
    ),
    "an attribute more": (lambda path: tell(path, "trace", "note", "seen"), "attributes", "/trace note"),
    "a column more": (
        edited(lambda file: file["trace"].create_dataset("temperature", data=np.zeros(3))),
        "structure",
        "/trace/temperature",
    ),
    "a group more": (edited(lambda file: file.create_group("notes")), "structure", "/notes"),
    "a link": (edited(lambda file: file.__setitem__("other", h5py.SoftLink("/trace"))), "structure", "/other"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_is_named(result: Path, name: str) -> None:
    change, check, place = CHANGES[name]
    assert told(result) == {}
    change(result)
    found = told(result)
    assert [*found] == ([check] if check else [])
    assert place in " ".join(found.values()).replace(" attribute ", " ")


# The folder of a sweep is what it says, and every change of it is named: index and runs.
FolderChange = Callable[[Path], object]


@pytest.fixture(scope="module")
def original_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep of four runs."""
    folder = tmp_path_factory.mktemp("swept")
    rubnoise.sweep(sweep_of(folder, SMALL, head=SHORT_HEAD), folder / "d", jobs=1).close()
    return folder / "d"


@pytest.fixture
def folder(original_folder: Path, tmp_path: Path) -> Path:
    return Path(copytree(original_folder, tmp_path / "d"))


def told_of_folder(folder: Path) -> dict[str, str]:
    """Return the first place of each check that fails."""
    return {check.name: str(check.first) for check in verify_sweep(folder).different}


def runs(folder: Path) -> list[Path]:
    return sorted((folder / "runs").glob("*.h5"))


def swap(folder: Path) -> None:
    """Exchange the files of two runs."""
    first, second, *_ = runs(folder)
    other = first.with_suffix(".other")
    first.rename(other)
    second.rename(first)
    other.rename(second)


def of_index(by: Callable[[h5py.File], object]) -> FolderChange:
    def change(folder: Path) -> None:
        with h5py.File(folder / "index.h5", "r+") as file:
            by(file)
        index = folder / "index.h5"
        index.write_bytes(sealed(index.read_bytes()))

    return change


def another_title(folder: Path) -> None:
    with h5py.File(folder / "index.h5", "r+") as file:
        put_text(file, "title", "other")


def another_seed(file: h5py.File) -> None:
    file["runs/seed"][1] += 1


def another_column(file: h5py.File) -> None:
    file["runs"].create_dataset("x", data=[1.0] * 4)


def of_run(by: Callable[[h5py.File], object]) -> FolderChange:
    def change(folder: Path) -> None:
        with h5py.File(runs(folder)[2], "r+") as file:
            by(file)

    return change


def another_area(file: h5py.File) -> None:
    file["trace/real_contact_area"][3] += 1.0


FOLDER_CHANGES: dict[str, tuple[FolderChange, str, str]] = {
    "two runs exchanged": (swap, "names", "the result of"),
    "a run in the place of another": (lambda d: copy(runs(d)[0], runs(d)[1]), "names", "the result of"),
    "a run gone": (lambda d: runs(d)[0].unlink(), "index", "missing"),
    "a run under another name": (lambda d: runs(d)[0].rename(d / "runs" / "0.h5"), "names", "the result of"),
    "a file more among the runs": (lambda d: (d / "runs" / "note.txt").touch(), "names", "runs/note.txt"),
    "a value in a run": (of_run(another_area), "runs", "/trace/real_contact_area"),
    "a unit in a run": (of_run(lambda file: put_text(file["trace/distance"], "units", "mm")), "runs", "units"),
    "a seed in the index": (of_index(another_seed), "index", "/runs/point and /runs/seed of"),
    "a title in the index": (another_title, "index", "is not as it was written"),
    "a column more in the index": (of_index(another_column), "index", "/runs"),
    "no index": (lambda d: (d / "index.h5").unlink(), "index", "missing"),
    "an index that is none": (lambda d: (d / "index.h5").write_bytes(b"none"), "index", "HDF5"),
}


def test_a_right_folder_is_verified(folder: Path) -> None:
    found = verify_sweep(folder)
    assert [check.name for check in found.checks] == ["index", "names", "runs"]
    assert (found.different, found.left_out) == ([], {})
    assert min(check.values for check in found.checks) > 0


@pytest.mark.parametrize("name", FOLDER_CHANGES)
def test_a_change_of_a_folder_is_named(folder: Path, name: str) -> None:
    change, check, place = FOLDER_CHANGES[name]
    change(folder)
    found = told_of_folder(folder)
    assert check in found
    assert place in found[check]


def test_an_unfinished_run_and_files_of_others_are_left_out_by_name(folder: Path) -> None:
    (folder / "runs" / f"{runs(folder)[0].name}.part").touch()
    (folder / "notes.txt").touch()
    found = verify_sweep(folder)
    assert found.different == []
    assert list(found.left_out) == [f"runs/{runs(folder)[0].name}.part", "notes.txt"]
