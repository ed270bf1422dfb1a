"""Rows read with plain reads are those that HDF5 reads, and nothing that a chunk claims is believed."""

import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import open_run
from rubnoise.storage.rows import DEFLATE_SKIPPED, SHUFFLE_SKIPPED, StoredColumn
from rubnoise.storage.schema import CHUNK_ROWS
from tests.format.runs import BARE, Compression, describe, random_rows, write_run

TICKS = 2 * CHUNK_ROWS + 17
VALUES = np.arange(5.0)


@pytest.fixture(name="folder", scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rows")
    kinds: tuple[Compression, ...] = ("none", "gzip")
    for compression in kinds:
        description = describe(7, TICKS, features=BARE, compression=compression)
        write_run(folder / f"{compression}.h5", description, random_rows(description))
    return folder


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_any_stretch_of_rows_is_that_of_hdf5(folder: Path, compression: str) -> None:
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


def stored(path: Path, content: bytes, skipped: int = 0) -> StoredColumn:
    path.write_bytes(content)
    return StoredColumn(dtype=np.dtype("<f8"), rows=5, chunk_rows=5, chunks=((0, len(content), skipped),))


@pytest.mark.parametrize(
    ("content", "skipped"),
    [
        (zlib.compress(shuffled(VALUES)), 0),
        (zlib.compress(VALUES.tobytes()), SHUFFLE_SKIPPED),
        (shuffled(VALUES), DEFLATE_SKIPPED),
        (VALUES.tobytes(), SHUFFLE_SKIPPED | DEFLATE_SKIPPED),
    ],
    ids=["both", "deflate alone", "shuffle alone", "neither"],
)
def test_filters_that_a_chunk_skipped_are_skipped(tmp_path: Path, content: bytes, skipped: int) -> None:
    column = stored(tmp_path / "chunk", content, skipped)
    with (tmp_path / "chunk").open("rb") as file:
        assert column.read(file.fileno(), 1, 4).tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("content", "skipped", "reason"),
    [
        (zlib.compress(bytes(10**6)), 0, "does not end where its rows do"),
        (zlib.compress(bytes(41)), 0, "another size than its rows"),
        (zlib.compress(bytes(39)), 0, "another size than its rows"),
        (zlib.compress(bytes(40))[:-1], 0, "does not end where its rows do"),
        (zlib.compress(bytes(40))[:-1] + b"\7", 0, "incorrect data check"),
        (b"no deflate", 0, "incorrect header check"),
        (bytes(39), DEFLATE_SKIPPED, "another size than its rows"),
    ],
)
def test_a_chunk_that_is_not_its_rows_is_refused(tmp_path: Path, content: bytes, skipped: int, reason: str) -> None:
    column = stored(tmp_path / "chunk", content, skipped)
    with (tmp_path / "chunk").open("rb") as file, pytest.raises(RunFileRefused, match=f"damaged: .*{reason}"):
        column.read(file.fileno(), 0, 5)
