"""Files below results: regular, written whole, between HDF5 and the disk, on systems that do half of what is asked."""

import errno
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from rubnoise.errors import RubnoiseError
from rubnoise.regular_file import write_all
from rubnoise.storage.reader import open_run
from tests.files.runs import Compression, attempt, describe, random_rows, write_run


def test_short_writes_are_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = os.pwrite
    monkeypatch.setattr(os, "pwrite", lambda descriptor, data, offset: whole(descriptor, data[:3], offset))
    with (tmp_path / "file").open("w+b") as disk:
        write_all(disk.fileno(), memoryview(b"0123456789"), 2)
    assert (tmp_path / "file").read_bytes() == b"\0\x000123456789"


Shorten = Callable[[int], int]


def one_less(size: int) -> int:
    return max(size - 1, 1)


def half(size: int) -> int:
    return max(size // 2, 1)


@pytest.fixture(params=[one_less, half])
def short(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Shorten:
    """Let every call of the system read and write less than it was asked for."""
    less: Shorten = request.param
    preadv, pwrite = os.preadv, os.pwrite

    def short_preadv(descriptor: int, targets: Sequence[Any], offset: int) -> int:
        view = memoryview(targets[0]).cast("B")
        return preadv(descriptor, [view[: less(len(view))]], offset)

    monkeypatch.setattr(os, "preadv", short_preadv)
    monkeypatch.setattr(os, "pwrite", lambda descriptor, data, at: pwrite(descriptor, data[: less(len(data))], at))
    return less


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_result_is_the_same_file(tmp_path: Path, short: Shorten, compression: Compression) -> None:
    description = describe(700, 900, compression=compression)
    write_run(tmp_path / "short.h5", description, random_rows(description), borders=(3, 500))
    with open_run(tmp_path / "short.h5") as run:
        assert run.damaged() == {}
        assert run.attributes["title"] == description.title
        rows = random_rows(description)
        assert all(
            run.column(group, name).tobytes() == values.tobytes()
            for group, columns in rows.items()
            for name, values in columns.items()
        )


def test_a_system_that_writes_nothing_is_not_asked_for_ever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "pwrite", lambda *_: 0)
    with (tmp_path / "file").open("w+b") as file, pytest.raises(OSError, match=os.strerror(errno.EIO)):
        write_all(file.fileno(), memoryview(b"x"), 0)
    with pytest.raises(RubnoiseError, match="cannot be written: input/output error"):
        attempt(tmp_path / "x.h5")
