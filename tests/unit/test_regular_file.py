"""Only regular files are opened, none of them is waited for, and none is read beyond what was asked."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from rubnoise.regular_file import NotRegular, is_folder, open_regular, open_stream, read_at_most


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

    monkeypatch.setattr(Path, "is_dir", closed)
    assert not is_folder(tmp_path)
