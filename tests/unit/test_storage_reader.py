"""Whatever is opened in place of a run file is refused in one sentence that begins with its path."""

import errno
import fcntl
import os
import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import TooNew, open_run
from rubnoise.storage.schema import CHUNK_ROWS
from tests.format.runs import BARE, Compression, describe, random_rows, write_run


@pytest.fixture(name="path")
def run_path(tmp_path: Path) -> Path:
    description = describe()
    write_run(tmp_path / "run.h5", description, random_rows(description))
    return tmp_path / "run.h5"


def assert_refused(path: Path, reason: str) -> RunFileRefused:
    with pytest.raises(RunFileRefused) as caught:
        open_run(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert text.count(str(path)) == 1
    assert "\n" not in text
    assert re.search(reason, text), text
    assert caught.value.exit_code == 2
    return caught.value


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    assert_refused(tmp_path / "missing.h5", "no such file")
    assert_refused(tmp_path, "not a regular file")
    os.mkfifo(tmp_path / "pipe.h5")
    assert_refused(tmp_path / "pipe.h5", "not a regular file")


def test_what_is_not_hdf5_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.h5").write_bytes(b"")
    assert_refused(tmp_path / "empty.h5", "empty")
    (tmp_path / "text.h5").write_text("distance,area\n" * 100)
    assert_refused(tmp_path / "text.h5", "not an HDF5 file")


def test_hdf5_of_others_is_refused(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["distance"] = np.arange(5.0)
    assert_refused(tmp_path / "other.h5", "not one of rubnoise")
    with h5py.File(tmp_path / "other.h5", "r+") as file:
        file.attrs["format"] = "rubnoise-run"
    assert_refused(tmp_path / "other.h5", "attribute format is not a plain number or text")
    with h5py.File(tmp_path / "other.h5", "r+") as file:
        file.attrs["format"] = np.bytes_("rubnoise-run")
    assert_refused(tmp_path / "other.h5", "format_version is missing")


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_file_cut_short_anywhere_is_refused(tmp_path: Path, compression: Compression) -> None:
    description = describe(compression=compression)
    write_run(tmp_path / "run.h5", description, random_rows(description))
    whole = (tmp_path / "run.h5").read_bytes()
    for size in {1, 8, 9, 47, 48, *range(0, len(whole), 997), len(whole) - 1}:
        (tmp_path / "cut.h5").write_bytes(whole[:size])
        assert_refused(tmp_path / "cut.h5", "empty|cut short|not an HDF5 file|damaged")


def test_a_later_format_names_the_version_needed(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", 3)
        file.attrs["source"] = np.bytes_("rubnoise 3.1.4")
    refusal = assert_refused(path, r"format version 3.*reads versions up to 2.*rubnoise 3\.1\.4 or later is needed")
    assert isinstance(refusal, TooNew)


@pytest.mark.parametrize("version", [1, 0, -5])
def test_an_earlier_version_is_refused(path: Path, version: int) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", version)
    assert_refused(path, f"has format version {version}, and this rubnoise reads version 2: run its scenario again")


def replace(file: h5py.File, make: Callable[[h5py.Group, str], object]) -> None:
    del file["trace/distance"]
    make(file["trace"], "distance")


def external_link(trace: h5py.Group, name: str) -> None:
    trace[name] = h5py.ExternalLink("/etc/passwd", "/distance")


def soft_link(trace: h5py.Group, name: str) -> None:
    trace[name] = h5py.SoftLink("/slider/distance")


def external_storage(trace: h5py.Group, name: str) -> None:
    trace.create_dataset(name, (11,), "<f8", external=[("/etc/passwd", 0, 88)])


def virtual_dataset(trace: h5py.Group, name: str) -> None:
    layout = h5py.VirtualLayout((11,), "<f8")
    layout[:] = h5py.VirtualSource("/etc/passwd", "distance", (11,))
    trace.create_virtual_dataset(name, layout)


def other_filter(trace: h5py.Group, name: str) -> None:
    trace.create_dataset(name, data=np.zeros(11), chunks=(11,), compression="lzf")


def other_chunks(trace: h5py.Group, name: str) -> None:
    trace.create_dataset(name, data=np.zeros(11), chunks=(3,), compression="gzip", shuffle=True)


def compact_storage(trace: h5py.Group, name: str) -> None:
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_layout(h5py.h5d.COMPACT)
    h5py.h5d.create(trace.id, name.encode(), h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((11,)), creation)


def rows_never_written(trace: h5py.Group, name: str) -> None:
    trace.create_dataset(name, (11,), "<f8")


def chunks_never_written(trace: h5py.Group, name: str) -> None:
    trace.create_dataset(name, (10**12,), "<f8", chunks=(CHUNK_ROWS,), compression="gzip", shuffle=True)


def group_instead(trace: h5py.Group, name: str) -> None:
    trace.create_group(name)


def other_type(trace: h5py.Group, name: str) -> None:
    trace[name] = np.zeros(11, dtype=">f8")


def integers(trace: h5py.Group, name: str) -> None:
    trace[name] = np.zeros(11, dtype="<i8")


def texts(trace: h5py.Group, name: str) -> None:
    trace[name] = ["a"] * 11


def two_dimensions(trace: h5py.Group, name: str) -> None:
    trace[name] = np.zeros((11, 1))


def scalar(trace: h5py.Group, name: str) -> None:
    trace[name] = 1.0


def fewer_rows(trace: h5py.Group, name: str) -> None:
    trace[name] = np.zeros(10)


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (external_link, "/trace/distance is missing"),
        (soft_link, "/trace/distance is missing"),
        (external_storage, "not stored as"),
        (virtual_dataset, "not stored as"),
        (other_filter, "not stored as"),
        (other_chunks, "not stored as"),
        (compact_storage, "not stored as"),
        (rows_never_written, "not stored as"),
        (chunks_never_written, "not stored as"),
        (group_instead, "/trace/distance is missing"),
        (other_type, "holds >f8 in 1 dim"),
        (integers, "holds int64"),
        (texts, "holds object"),
        (two_dimensions, "in 2 dimensions"),
        (scalar, "in 0 dimensions"),
        (fewer_rows, "another number of rows"),
    ],
)
def test_a_column_that_is_not_as_the_schema_says_is_refused(
    path: Path, make: Callable[[h5py.Group, str], None], reason: str
) -> None:
    with h5py.File(path, "r+") as file:
        replace(file, make)
    assert_refused(path, reason)


def test_a_column_put_back_as_it_was_is_accepted(path: Path) -> None:
    """The control of the test above: the replacing itself is not what is refused."""
    with h5py.File(path, "r+") as file:
        values = file["trace/distance"][:]
        replace(file, lambda trace, name: trace.create_dataset(name, data=values))
    with open_run(path) as run:
        assert run.column("trace", "distance").tobytes() == values.tobytes()


@pytest.mark.parametrize("name", ["junctions", "trace", "life_curve"])
def test_a_missing_group_is_refused(path: Path, name: str) -> None:
    with h5py.File(path, "r+") as file:
        file.move(name, "elsewhere")
        file[name] = h5py.SoftLink("/elsewhere")
    assert_refused(path, f"/{name} is missing")


def test_a_slider_without_a_force_is_refused(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        del file["junctions/shear_strength"]
        del file["trace/friction_force"]
    assert_refused(path, "has a slider without")


def test_a_changed_value_shows_in_the_hash(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file["slider/velocity"][3] += 1e-12
    with open_run(path) as run:
        assert run.damaged() == ("/slider/velocity",)


@pytest.mark.parametrize("compression", ["none", "gzip"])
@pytest.mark.parametrize("size", [100, 5000, 60_000])
def test_a_changed_bit_in_a_text_shows_however_long_it_is(tmp_path: Path, size: int, compression: Compression) -> None:
    description = describe(scenario_toml="x" * size, compression=compression)
    write_run(tmp_path / "run.h5", description, random_rows(description))
    content = bytearray((tmp_path / "run.h5").read_bytes())
    content[content.index(b"x" * size) + size // 2] ^= 1
    (tmp_path / "run.h5").write_bytes(content)
    with open_run(tmp_path / "run.h5") as run, pytest.raises(RunFileRefused, match=r"run\.h5: damaged: .*checksum"):
        str(run.provenance["scenario_toml"])


def test_attributes_are_read_only_when_plain(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file["summary"].attrs["note"] = "of variable length"
        file["provenance"].attrs["command"] = np.zeros(3)
        file["provenance"].attrs["seed"] = np.void(b"x" * 8)
    with open_run(path) as run:
        with pytest.raises(RunFileRefused, match="attribute note is not a plain"):
            assert run.summary
        with pytest.raises(RunFileRefused, match="attribute command is not a plain"):
            assert run.provenance


def test_a_missing_provenance_does_not_hide_the_columns(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        del file["provenance"]
    with open_run(path) as run:
        assert run.rows("trace") == 11
        with pytest.raises(RunFileRefused, match="/provenance is missing"):
            assert run.provenance


def test_a_summary_without_end_is_refused(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        for i in range(300):
            file["summary"].attrs[f"mean_{i}"] = 1.0
    with open_run(path) as run, pytest.raises(RunFileRefused, match="/summary has 302 attributes"):
        assert run.summary


def test_damaged_chunks_are_reported_when_read(tmp_path: Path) -> None:
    description = describe(4, 4000, features=BARE, compression="gzip")
    write_run(tmp_path / "run.h5", description, random_rows(description))
    with h5py.File(tmp_path / "run.h5") as file:
        offset = file["trace/distance"].id.get_chunk_info(0).byte_offset
    with (tmp_path / "run.h5").open("r+b") as disk:
        disk.seek(offset)
        disk.write(b"\xff" * 64)
    with open_run(tmp_path / "run.h5") as run:
        assert run.damaged() == ("/trace/distance",)
        with pytest.raises(RunFileRefused, match="damaged"):
            run.column("trace", "distance")


def test_a_file_that_another_program_holds_is_refused(path: Path) -> None:
    with path.open("rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        assert_refused(path, "being written by another program")
    open_run(path).close()


def test_a_file_system_without_locks_is_read_all_the_same(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*arguments: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", refuse)
    open_run(path).close()


def test_rows_are_read_from_the_file_that_was_opened(path: Path) -> None:
    """Another file put in its place after the check is not read."""
    with open_run(path) as run:
        before = run.column("trace", "distance").tobytes()
        (path.parent / "other.h5").write_bytes(b"x" * path.stat().st_size)
        (path.parent / "other.h5").replace(path)
        assert run.column("trace", "distance").tobytes() == before


def test_a_file_cut_short_while_it_is_open_is_refused(path: Path) -> None:
    with open_run(path) as run:
        os.truncate(path, 4096)
        with pytest.raises(RunFileRefused, match=r"run\.h5: cut short"):
            run.column("slider", "velocity")


def test_a_run_forgotten_is_closed(path: Path) -> None:
    run = open_run(path)
    descriptor = run.descriptor
    os.fstat(descriptor)
    del run
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(descriptor)


def test_a_group_without_end_is_refused(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        for i in range(300):
            file["trace"].create_group(f"more_{i}")
    assert_refused(path, "/trace holds 304 objects")


def test_a_closed_run_reads_no_more(path: Path) -> None:
    run = open_run(path)
    run.close()
    with pytest.raises(ValueError, match="the run file is closed"):
        run.column("trace", "distance")


def test_several_readers_share_a_file(path: Path) -> None:
    with open_run(path) as one, open_run(path) as other:
        assert one.column("trace", "distance").tobytes() == other.column("trace", "distance").tobytes()
