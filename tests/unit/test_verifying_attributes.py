"""What a result says of itself: every attribute, unit, figure and name is asked, and a change of one is named."""

from collections.abc import Callable
from pathlib import Path
from shutil import copy

import h5py
import numpy as np
import pytest

from rubnoise.analysis.verification import verify
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import HASH
from tests.unit.tampering import forget, put_seal, put_text, run_of, tell

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
    "a unit of ticks": (
        text("trace/real_contact_area", "units", "mm^2"),
        "attributes",
        "/trace/real_contact_area",
    ),
    "a long name": (text("slider/velocity", "long_name", "displacement"), "attributes", "/slider/velocity long_name"),
    "the meaning of a flag": (text("junctions/state", "flag_meanings", "a b c"), "attributes", "/junctions/state flag"),
    "the formula": (without_sizes, "attributes", "/ junction_area_formula"),
    "the convention": (text("/", "Conventions", "CF-1.0"), "attributes", "/ Conventions"),
    "a title": (text("/", "title", "another"), "", ""),  # the scenario has none: it was the name of the file
    "an empty title": (text("/", "title", " "), "attributes", "/ title"),
    "the program": (text("/", "source", "rubnoise 99.0"), "attributes", "/ source"),
    "the stream version": (
        lambda path: tell(path, "provenance", "stream_version", 0),
        "attributes",
        "stream",
    ),
    "the scenario as read": (
        lambda path: tell(path, "provenance", "scenario_toml", "format = 1\n[run]\nseed = 8\n"),
        "scenario",
        "scenario_toml",
    ),
    "an end that is no time": (
        lambda path: tell(path, "provenance", "finished", "2001-01-01"),
        "attributes",
        "/provenance finished",
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


def test_a_change_without_the_hash_put_right_is_named_by_it(result: Path) -> None:
    tell(result, "provenance", "started", "2001-01-01T00:00:00Z", seal=False)
    assert [*told(result)] == ["hashes"]
    assert f"/provenance {HASH}" in told(result)["hashes"].replace(" attribute ", " ")


def test_every_unit_counts(result: Path) -> None:
    """Of every column, lengths in mm and others in what is no unit, as a careless program might write them."""
    columns = 0
    with h5py.File(result, "r+") as file:
        for group in ("junctions", "trace", "slider", "blocks", "life_curve"):
            for column in file[group].values():
                unit = column.attrs["units"].decode()
                put_text(column, "units", unit.replace("um", "mm") if "um" in unit else f"{unit}2")
                columns += 1
    with open_run(result) as run:
        (check,) = verify(run).different
    assert (check.name, check.different) == ("attributes", columns)


def test_a_clock_that_was_set_back_is_a_note(result: Path) -> None:
    tell(result, "provenance", "finished", "2001-01-01T00:00:00Z")
    with open_run(result) as run:
        found = verify(run)
    assert found.different == []
    assert [each.name for each in found.left_out] == ["finished"]
