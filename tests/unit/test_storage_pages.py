"""Files between HDF5 and the disk behave as files, and keep what goes wrong until it is asked for."""

import io
import os
from pathlib import Path
from tempfile import TemporaryFile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rubnoise.storage.disk import write_all
from rubnoise.storage.pages import PAGE, Overlay, Unfailing

offsets = st.integers(0, 3 * PAGE)
changes = st.lists(st.tuples(offsets, st.binary(min_size=1, max_size=PAGE + 7)), max_size=8)


@given(beneath=st.binary(max_size=2 * PAGE + 5), changes=changes, size=offsets)
def test_overlay_reads_as_the_changed_file_and_commits_to_it(
    beneath: bytes, changes: list[tuple[int, bytes]], size: int
) -> None:
    expected = io.BytesIO(beneath)
    with TemporaryFile() as disk:
        disk.write(beneath)
        disk.flush()
        overlay = Overlay(disk.fileno())
        for file in (expected, overlay):
            for offset, data in changes:
                file.seek(offset)
                file.write(data)
        overlay.seek(0)
        assert overlay.read(overlay.size) == expected.getvalue()
        assert os.pread(disk.fileno(), 4 * PAGE, 0) == beneath
        overlay.truncate(size)
        overlay.commit(disk.fileno())
        assert os.pread(disk.fileno(), 8 * PAGE, 0) == expected.getvalue()[:size].ljust(size, b"\0")


def test_overlay_of_nothing_costs_only_what_is_written() -> None:
    overlay = Overlay()
    overlay.truncate(10**15)
    overlay.seek(10**14)
    overlay.write(b"far")
    overlay.seek(-3, os.SEEK_CUR)
    assert overlay.read(3) == b"far"
    assert overlay.seek(0, os.SEEK_END) == overlay.size == 10**15
    assert len(overlay._pages) == 1


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
