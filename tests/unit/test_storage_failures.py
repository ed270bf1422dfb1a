"""A run that fails leaves nothing behind, and provenance that names no person."""

import getpass
import json
import platform
import re
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import rubnoise
from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.runs.making import describe as describe_run
from rubnoise.storage.layout import package_version
from rubnoise.storage.reader import open_run
from rubnoise.storage.writer import RunWriter
from tests.files.runs import attempt, describe, names


@contextmanager
def files_at_most(size: int) -> Iterator[None]:
    """Let the system refuse files beyond a size, as a full disk would."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("size", [0, 5000, 1_000_000])
def test_a_run_that_cannot_fit_is_refused_before_its_first_row(tmp_path: Path, size: int) -> None:
    (tmp_path / "run.h5").write_bytes(b"older")
    with (
        files_at_most(size),
        pytest.raises(OutputRefused, match="file too large"),
        RunWriter(tmp_path / "run.h5", describe(100_000, 100_000), force=True),
    ):
        raise AssertionError
    assert names(tmp_path) == ["run.h5"]
    assert (tmp_path / "run.h5").read_bytes() == b"older"


def test_a_file_that_appears_during_the_run_is_spared(tmp_path: Path) -> None:
    with pytest.raises(RubnoiseError, match="appeared during the run"):
        attempt(tmp_path / "run.h5", meanwhile=lambda: (tmp_path / "run.h5").write_bytes(b"of another"))
    assert (tmp_path / "run.h5").read_bytes() == b"of another"
    assert names(tmp_path) == ["run.h5", "run.h5.part"]
    with open_run(tmp_path / "run.h5.part") as run:
        assert run.damaged() == {}


# Provenance names software, machine and command, and no person.
@pytest.fixture(name="origin")
def gathered() -> dict[str, object]:
    command = ["rubnoise", "run", "my run.toml", "--seed", "12"]
    about = describe_run(rubnoise.load("paper/fig5"), "run.h5", command).provenance
    return {name: value for name, value in about.items() if not name.startswith("scenario_")}


def test_command_can_be_pasted_into_a_shell(origin: dict[str, object]) -> None:
    assert origin["command"] == "rubnoise run 'my run.toml' --seed 12"


def test_neither_a_person_nor_the_host_is_named(origin: dict[str, object]) -> None:
    text = json.dumps(origin)
    assert platform.node() not in text
    assert re.search(rf"\b{re.escape(getpass.getuser())}\b", text) is None
    assert "/" not in text


def test_a_missing_package_is_said_to_be_missing() -> None:
    assert package_version("rubnoise-that-never-was") == "not installed"
