"""Whatever is opened in place of a run file is refused in one sentence that begins with its path."""

import fcntl
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import TooNew, open_run
from rubnoise.storage.schema import CHUNK_ROWS
from tests.files.runs import BARE, Compression, describe, random_rows, write_run


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


@pytest.mark.slow
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


def virtual_dataset(trace: h5py.Group, name: str) -> None:
    layout = h5py.VirtualLayout((11,), "<f8")
    layout[:] = h5py.VirtualSource("/etc/passwd", "distance", (11,))
    trace.create_virtual_dataset(name, layout)


def compact_storage(trace: h5py.Group, name: str) -> None:
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_layout(h5py.h5d.COMPACT)
    h5py.h5d.create(trace.id, name.encode(), h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((11,)), creation)


def stored(**how: Any) -> Callable[[h5py.Group, str], object]:
    """Return what makes a dataset that is stored in another way."""
    return lambda trace, name: trace.create_dataset(name, **({"shape": (11,), "dtype": "<f8"} | how))


def holding(values: Any) -> Callable[[h5py.Group, str], object]:
    """Return what makes a dataset of other values."""
    return lambda trace, name: trace.create_dataset(name, data=values)


PACKED = {"compression": "gzip", "shuffle": True}
OTHERS: dict[str, tuple[Callable[[h5py.Group, str], object], str]] = {
    "external link": (
        lambda trace, name: trace.__setitem__(name, h5py.ExternalLink("/etc/passwd", "/distance")),
        "/trace/distance is missing",
    ),
    "soft link": (
        lambda trace, name: trace.__setitem__(name, h5py.SoftLink("/slider/distance")),
        "/trace/distance is missing",
    ),
    "group": (lambda trace, name: trace.create_group(name), "/trace/distance is missing"),
    "external storage": (stored(external=[("/etc/passwd", 0, 88)]), "not stored as"),
    "virtual dataset": (virtual_dataset, "not stored as"),
    "another filter": (stored(data=np.zeros(11), chunks=(11,), compression="lzf"), "not stored as"),
    "other chunks": (stored(data=np.zeros(11), chunks=(3,), **PACKED), "not stored as"),
    "compact storage": (compact_storage, "not stored as"),
    "rows never written": (stored(), "not stored as"),
    "chunks never written": (stored(shape=(10**12,), chunks=(CHUNK_ROWS,), **PACKED), "not stored as"),
    "another type": (holding(np.zeros(11, dtype=">f8")), "holds >f8 in 1 dim"),
    "integers": (holding(np.zeros(11, dtype="<i8")), "holds int64"),
    "texts": (holding(["a"] * 11), "holds object"),
    "two dimensions": (holding(np.zeros((11, 1))), "in 2 dimensions"),
    "a scalar": (holding(1.0), "in 0 dimensions"),
    "fewer rows": (holding(np.zeros(10)), "another number of rows"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_a_column_that_is_not_as_the_schema_says_is_refused(path: Path, name: str) -> None:
    make, reason = OTHERS[name]
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


@pytest.mark.parametrize("compression", ["none", "gzip"])
@pytest.mark.parametrize("size", [100, 5000, 60_000])
def test_a_changed_bit_in_a_text_shows_however_long_it_is(tmp_path: Path, size: int, compression: Compression) -> None:
    description = describe(scenario_toml="x" * size, compression=compression)
    write_run(tmp_path / "run.h5", description, random_rows(description))
    content = bytearray((tmp_path / "run.h5").read_bytes())
    content[content.index(b"x" * size) + size // 2] ^= 1
    (tmp_path / "run.h5").write_bytes(content)
    with pytest.raises(RunFileRefused, match=r"run\.h5: damaged: .*checksum"):
        open_run(tmp_path / "run.h5")


def test_damaged_chunks_are_reported_when_read(tmp_path: Path) -> None:
    description = describe(4, 4000, features=BARE, compression="gzip")
    write_run(tmp_path / "run.h5", description, random_rows(description))
    with h5py.File(tmp_path / "run.h5") as file:
        offset = file["trace/distance"].id.get_chunk_info(0).byte_offset
    with (tmp_path / "run.h5").open("r+b") as disk:
        disk.seek(offset)
        disk.write(b"\xff" * 64)
    with open_run(tmp_path / "run.h5") as run:
        assert [*run.damaged()] == ["/trace/distance"]
        with pytest.raises(RunFileRefused, match="damaged"):
            run.column("trace", "distance")


def test_a_file_that_another_program_holds_is_refused(path: Path) -> None:
    with path.open("rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        assert_refused(path, "being written by another program")
    open_run(path).close()


def test_a_file_cut_short_while_it_is_open_is_refused(path: Path) -> None:
    with open_run(path) as run:
        os.truncate(path, 4096)
        with pytest.raises(RunFileRefused, match=r"run\.h5: cut short"):
            run.column("slider", "velocity")
