"""Files below results: regular, written whole, between HDF5 and the disk, on systems that do half of what is asked."""

import errno
import os
import socket
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from rubnoise.errors import RubnoiseError
from rubnoise.regular_file import NotRegular, open_regular
from rubnoise.storage.disk import write_all
from rubnoise.storage.reader import open_run
from tests.format.runs import Compression, attempt, describe, random_rows, write_run


# Only regular files are opened, none of them is waited for, and none is read beyond what was asked.
def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as there:
        there.bind(str(path))


OTHERS: dict[str, Callable[[Path], object]] = {
    "folder": Path.mkdir,
    "pipe": os.mkfifo,
    "socket": _socket,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "terminal": lambda path: path.symlink_to("/dev/tty"),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_what_is_no_regular_file_is_not_even_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    path = tmp_path / "x"
    OTHERS[kind](path)
    opened: list[object] = []
    monkeypatch.setattr(os, "open", lambda name, *_: opened.append(name))
    with pytest.raises(NotRegular) as refused:
        open_regular(path)
    assert (refused.value.strerror, refused.value.filename, opened) == ("is not a regular file", str(path), [])


def test_a_pipe_that_takes_the_place_of_a_file_is_neither_waited_for_nor_kept_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    regular, pipe = tmp_path / "regular", tmp_path / "pipe"
    regular.touch()
    os.mkfifo(pipe)
    about = regular.stat()
    monkeypatch.setattr(Path, "stat", lambda _path: about)
    free = os.dup(0)
    os.close(free)
    with pytest.raises(NotRegular):
        open_regular(pipe)
    after = os.dup(0)
    os.close(after)
    assert after == free


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
        assert run.damaged() == ()
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
    with pytest.raises(RubnoiseError, match="cannot be written: Input/output error"):
        attempt(tmp_path / "x.h5")
