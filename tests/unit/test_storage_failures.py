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
import numpy as np
import pytest

from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.storage.provenance import gather, now, package_version
from rubnoise.storage.reader import open_run
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION
from tests.format.runs import Compression, attempt, describe, names, random_rows, write_run


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


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_run_with_missing_rows_is_not_published(tmp_path: Path, compression: Compression) -> None:
    description = describe(compression=compression)
    rows = random_rows(description)
    rows["slider"]["velocity"] = rows["slider"]["velocity"][:-1]
    with pytest.raises(RubnoiseError, match="/slider/velocity has 12 of its 13 rows"):
        write_run(tmp_path / "run.h5", description, rows)
    assert names(tmp_path) == []


def test_rows_in_the_wrong_place_or_of_the_wrong_type_are_refused(tmp_path: Path) -> None:
    trace = random_rows(describe())["trace"]
    with RunWriter(tmp_path / "run.h5", describe()) as writer:
        for first in (1, -1):
            with pytest.raises(ValueError, match=f"rows {first} to"):
                writer.write("trace", first, trace)
        writer.write("trace", 0, trace)
        with pytest.raises(ValueError, match="rows 1 to 12 of 11"):
            writer.write("trace", 1, trace)
        with pytest.raises(TypeError, match="int64"):
            writer.write("trace", 0, {"junction_count": trace["junction_count"].astype("i8")})
        with pytest.raises(TypeError, match="2 dimensions"):
            writer.write("trace", 0, {"distance": trace["distance"][None]})
        with pytest.raises(KeyError):
            writer.write("trace", 0, {"temperature": trace["distance"]})


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


def test_a_run_larger_than_the_disk_is_refused(tmp_path: Path) -> None:
    with (
        pytest.raises(OutputRefused, match=r"no room for the .* bytes|File too large"),
        RunWriter(tmp_path / "run.h5", describe(10**13, 10**13, slider=10**13)),
    ):
        raise AssertionError
    assert names(tmp_path) == []


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


def test_a_disk_that_fails_during_the_run_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    with RunWriter(tmp_path / "run.h5", describe()) as writer:
        monkeypatch.setattr(os, "pwrite", fail)
        with pytest.raises(RubnoiseError, match="writing failed: No space left"):
            writer.write("trace", 0, random_rows(describe())["trace"])
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


def test_versions_are_those_in_use(origin: dict[str, object]) -> None:
    software = origin["software"]
    assert isinstance(software, dict)
    assert {"rubnoise", "numpy", "scipy", "numba", "simpy", "h5py", "hdf5", "python"} == set(software)
    assert software["numpy"] == np.__version__
    assert software["hdf5"] == h5py.version.hdf5_version
    assert software["python"] == platform.python_version()


def test_command_can_be_pasted_into_a_shell(origin: dict[str, object]) -> None:
    assert origin["command"] == "rubnoise run 'my run.toml' --seed 12"


def test_constants_and_seed_are_kept(origin: dict[str, object]) -> None:
    assert (origin["seed"], origin["calibrated_diameter"]) == (12, 5.53)
    assert origin["propagator_constants"] == {"decay": 0.1}
    assert origin["stream_version"] == STREAM_VERSION


def test_neither_a_person_nor_the_host_is_named(origin: dict[str, object]) -> None:
    text = json.dumps(origin)
    assert platform.node() not in text
    assert re.search(rf"\b{re.escape(getpass.getuser())}\b", text) is None
    assert "/" not in text


def test_times_are_utc_to_the_second() -> None:
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", now())


def test_a_missing_package_is_said_to_be_missing() -> None:
    assert package_version("rubnoise-that-never-was") == "not installed"
