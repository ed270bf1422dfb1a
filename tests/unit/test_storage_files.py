"""Files below results: regular, written whole, between HDF5 and the disk, on systems that do half of what is asked."""

import errno
import os
import socket
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.regular_file import NotRegular, is_folder, open_regular, open_stream, read_at_most
from rubnoise.storage.disk import read_into, write_all
from rubnoise.storage.format import Unfailing
from rubnoise.storage.output import OutputAppearedError, whole_file
from rubnoise.storage.reader import open_run
from tests.format.runs import Compression, attempt, describe, names, random_rows, write_run


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


def test_no_more_is_read_than_asked(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(b"0123456789")
    assert [read_at_most(path, count) for count in (0, 4, 10, 11)] == [b"", b"0123", b"0123456789", b"0123456789"]
    with open_stream(path) as stream:
        assert stream.read() == b"0123456789"


def test_a_file_without_an_end_is_read_as_far_as_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "x").touch()
    monkeypatch.setattr(os, "read", lambda _descriptor, count: b"x" * min(count, 7))
    assert read_at_most(tmp_path / "x", 100) == b"x" * 100


def test_a_file_that_would_be_waited_for_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def waiting(_descriptor: int, _count: int) -> bytes:
        raise BlockingIOError

    (tmp_path / "x").touch()
    monkeypatch.setattr(os, "read", waiting)
    with pytest.raises(NotRegular):
        read_at_most(tmp_path / "x", 100)


def test_a_name_that_no_file_can_have_is_told_as_the_system_would() -> None:
    with pytest.raises(OSError, match="embedded null byte"):
        open_regular("a\0b")


def test_a_folder_that_may_not_be_looked_at_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert is_folder(tmp_path)
    assert not is_folder(tmp_path / "x")

    def closed(_path: Path) -> bool:
        raise PermissionError

    with monkeypatch.context() as patch:
        patch.setattr(os, "stat", closed)
        assert not is_folder(tmp_path)


# Files that are written whole or not at all.
def test_a_file_gets_its_name_when_it_is_whole(tmp_path: Path) -> None:
    with whole_file(tmp_path / "a", force=False) as part:
        part.write_bytes(b"half")
        assert not (tmp_path / "a").exists()
        part.write_bytes(b"whole")
    assert (tmp_path / "a").read_bytes() == b"whole"
    assert names(tmp_path) == ["a"]


def _fail(path: Path, problem: BaseException) -> None:
    with whole_file(path, force=True) as part:
        part.write_bytes(b"half")
        raise problem


@pytest.mark.parametrize("problem", [KeyboardInterrupt(), ValueError("x")])
def test_what_stops_the_writing_leaves_what_was_there(tmp_path: Path, problem: BaseException) -> None:
    (tmp_path / "a").write_bytes(b"precious")
    with pytest.raises(type(problem)):
        _fail(tmp_path / "a", problem)
    assert (tmp_path / "a").read_bytes() == b"precious"
    assert names(tmp_path) == ["a"]


def test_a_full_disk_is_told(tmp_path: Path) -> None:
    with pytest.raises(RubnoiseError, match="a: writing failed: No space left on device"):
        _fail(tmp_path / "a", OSError(errno.ENOSPC, "No space left on device"))
    assert names(tmp_path) == []


def test_nothing_is_begun_where_a_file_is(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"precious")
    with pytest.raises(OutputRefused, match="exists already"), whole_file(tmp_path / "a", force=False):
        raise AssertionError
    assert (tmp_path / "a").read_bytes() == b"precious"


def _write_beside_another(path: Path) -> None:
    with whole_file(path, force=False) as part:
        part.write_bytes(b"ours")
        path.write_bytes(b"theirs")


def test_a_file_that_appears_meanwhile_stays_beside_the_part(tmp_path: Path) -> None:
    with pytest.raises(OutputAppearedError):
        _write_beside_another(tmp_path / "a")
    assert (tmp_path / "a").read_bytes() == b"theirs"
    assert (tmp_path / "a.part").read_bytes() == b"ours"


# Files between HDF5 and the disk behave as files, and keep what goes wrong until it is asked for.
def test_unfailing_is_the_file_on_disk(tmp_path: Path) -> None:
    with (tmp_path / "file").open("w+b") as disk:
        file = Unfailing(disk.fileno())
        file.write(b"0123456789")
        file.seek(4)
        file.write(b"xy")
        file.seek(2)
        assert file.read(12) == b"23xy6789\0\0\0\0"
        file.truncate(8)
        file.raise_first_error()
    assert (tmp_path / "file").read_bytes() == b"0123xy67"


def test_unfailing_keeps_the_first_failure(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with (tmp_path / "file").open("rb") as disk:
        file = Unfailing(disk.fileno())
        assert file.write(b"abc") == 3
        assert file.write(b"def") == 3
        assert file.tell() == 6
        with pytest.raises(OSError, match="Bad file descriptor"):
            file.raise_first_error()
    assert (tmp_path / "file").read_bytes() == b""


def test_short_writes_are_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = os.pwrite
    monkeypatch.setattr(os, "pwrite", lambda descriptor, data, offset: whole(descriptor, data[:3], offset))
    with (tmp_path / "file").open("w+b") as disk:
        write_all(disk.fileno(), memoryview(b"0123456789"), 2)
    assert (tmp_path / "file").read_bytes() == b"\0\x000123456789"


# A system that reads or writes less than it was asked for, as it may, changes no byte of what is read or written.
CONTENT = bytes(range(256)) * 40
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


def test_all_is_read_and_written(tmp_path: Path, short: Shorten) -> None:
    with (tmp_path / "file").open("w+b") as file:
        write_all(file.fileno(), memoryview(CONTENT), 3)
        for size, offset, content in ((len(CONTENT), 3, CONTENT), (10**5, 3, CONTENT), (10, 10**5, b"")):
            found = bytearray(size)
            assert found[: read_into(file.fileno(), memoryview(found), offset)] == content


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
