"""A run that fails leaves nothing behind, and provenance that names no person."""

import errno
import getpass
import json
import os
import platform
import re
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

import h5py
import pytest

from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.storage.provenance import gather
from rubnoise.storage.reader import open_run
from rubnoise.storage.writer import RunWriter
from tests.format.runs import Compression, attempt, describe, names


# A run that fails, at whatever point, leaves nothing behind and nothing harmed.
@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_run_that_fails_leaves_the_older_file(tmp_path: Path, compression: Compression) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    (tmp_path / "run.h5").write_bytes(b"older")
    with pytest.raises(KeyboardInterrupt):
        attempt(tmp_path / "run.h5", force=True, compression=compression, meanwhile=interrupt)
    assert names(tmp_path) == ["run.h5"]
    assert (tmp_path / "run.h5").read_bytes() == b"older"


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
        pytest.raises(OutputRefused, match="File too large"),
        RunWriter(tmp_path / "run.h5", describe(100_000, 100_000), force=True),
    ):
        raise AssertionError
    assert names(tmp_path) == ["run.h5"]
    assert (tmp_path / "run.h5").read_bytes() == b"older"


@pytest.mark.parametrize("call", ["pwrite", "fsync"])
@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_disk_that_fails_is_reported_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str, compression: Compression
) -> None:
    def fail(*arguments: object) -> int:
        raise OSError(errno.EIO, "Input/output error")

    with pytest.raises(RubnoiseError, match="writing failed: Input/output error") as caught:
        attempt(tmp_path / "run.h5", compression=compression, meanwhile=lambda: monkeypatch.setattr(os, call, fail))
    assert caught.value.exit_code == 1
    assert names(tmp_path) == []


def test_a_file_that_appears_during_the_run_is_spared(tmp_path: Path) -> None:
    with pytest.raises(RubnoiseError, match="appeared during the run"):
        attempt(tmp_path / "run.h5", meanwhile=lambda: (tmp_path / "run.h5").write_bytes(b"of another"))
    assert (tmp_path / "run.h5").read_bytes() == b"of another"
    assert names(tmp_path) == ["run.h5", "run.h5.part"]
    with open_run(tmp_path / "run.h5.part") as run:
        assert run.damaged() == ()


def test_a_disk_without_hard_links_gets_a_rename(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*arguments: object) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", refuse)
    attempt(tmp_path / "run.h5")
    assert names(tmp_path) == ["run.h5"]
    with h5py.File(tmp_path / "run.h5") as file:
        assert file["trace/distance"].size == 11


# Provenance names software, machine and command, and no person.
@pytest.fixture(name="origin")
def gathered() -> dict[str, object]:
    return asdict(
        gather(
            seed=12,
            calibrated_diameter=5.53,
            propagator_constants={"decay": 0.1},
            command=["rubnoise", "run", "my run.toml", "--seed", "12"],
        )
    )


def test_command_can_be_pasted_into_a_shell(origin: dict[str, object]) -> None:
    assert origin["command"] == "rubnoise run 'my run.toml' --seed 12"


def test_neither_a_person_nor_the_host_is_named(origin: dict[str, object]) -> None:
    text = json.dumps(origin)
    assert platform.node() not in text
    assert re.search(rf"\b{re.escape(getpass.getuser())}\b", text) is None
    assert "/" not in text
