"""Rows of a file are those that HDF5 reads: in one piece, mapped, or in chunks, of which nothing is believed."""

import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rubnoise.errors import RunFileRefused
from rubnoise.storage import reader
from rubnoise.storage.objects import rows_of_chunks
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import CHUNK_ROWS
from tests.files.runs import BARE, Compression, describe, random_rows, write_run

TICKS = 2 * CHUNK_ROWS + 17
FEW_VALUES = np.arange(5.0)


@pytest.fixture(name="folder", scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rows")
    kinds: tuple[Compression, ...] = ("none", "gzip")
    for compression in kinds:
        description = describe(7, TICKS, features=BARE, compression=compression)
        write_run(folder / f"{compression}.h5", description, random_rows(description))
    return folder


@pytest.mark.parametrize(("compression", "read_bytes"), [("none", reader.READ_BYTES), ("none", 800), ("gzip", 0)])
def test_any_stretch_of_rows_is_that_of_hdf5(
    folder: Path, monkeypatch: pytest.MonkeyPatch, compression: str, read_bytes: int
) -> None:
    """Stretches of more than ``read_bytes`` are mapped."""
    monkeypatch.setattr(reader, "READ_BYTES", read_bytes)
    path = folder / f"{compression}.h5"
    with h5py.File(path) as file:
        expected = {name: file["trace"][name][:] for name in file["trace"]}

    with open_run(path) as run:

        @given(ends=st.tuples(st.integers(0, TICKS), st.integers(0, TICKS)), name=st.sampled_from(sorted(expected)))
        def check(ends: tuple[int, int], name: str) -> None:
            values = run.column("trace", name, *ends)
            assert values.dtype == expected[name].dtype
            assert values.tobytes() == expected[name][slice(*ends)].tobytes()

        check()
        assert run.column("trace", "distance", -3).tobytes() == expected["distance"][-3:].tobytes()
        run.column("trace", "distance")[:] = 0.0  # what is read is the reader's own
        assert run.column("trace", "distance").tobytes() == expected["distance"].tobytes()


def shuffled(values: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> bytes:
    return values.view(np.uint8).reshape(-1, 8).T.tobytes()


def rows_of(path: Path, content: bytes, skipped: int, first: int, last: int) -> list[float]:
    """Return rows of a dataset of one chunk, whose bytes and skipped filters are given."""
    with h5py.File(path, "w") as file:
        dataset = file.create_dataset("x", (5,), "<f8", chunks=(5,), shuffle=True, compression="gzip")
        dataset.id.write_direct_chunk((0,), content, skipped)
    with h5py.File(path) as file:
        found: list[float] = rows_of_chunks(file["x"], first, last).tolist()
    return found


def test_a_chunk_gives_its_rows(tmp_path: Path) -> None:
    assert rows_of(tmp_path / "chunk", zlib.compress(shuffled(FEW_VALUES)), 0, 1, 4) == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("content", "skipped", "reason"),
    [
        (zlib.compress(bytes(10**6)), 0, "not packed as its rows are"),
        (zlib.compress(bytes(41)), 0, "not packed as its rows are"),
        (zlib.compress(bytes(39)), 0, "not packed as its rows are"),
        (zlib.compress(bytes(40))[:-1], 0, "not packed as its rows are"),
        (zlib.compress(bytes(40))[:-1] + b"\7", 0, "incorrect data check"),
        (b"no deflate", 0, "incorrect header check"),
        (zlib.compress(bytes(40)), 2, "not packed as its rows are"),
    ],
)
def test_a_chunk_that_is_not_its_rows_is_refused(tmp_path: Path, content: bytes, skipped: int, reason: str) -> None:
    with pytest.raises(RunFileRefused, match=f"damaged: .*{reason}"):
        rows_of(tmp_path / "chunk", content, skipped, 0, 5)
