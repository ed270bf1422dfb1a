"""An output is refused before anything is created, and locks keep others away."""

import errno
import fcntl
import os
import shutil
import threading
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import pytest

from rubnoise.errors import OutputRefused, RubnoiseError, RunFileRefused
from rubnoise.storage import output
from rubnoise.storage.output import OutputInUse, WrittenWithLess, check_output, part_file
from rubnoise.storage.reader import open_run
from rubnoise.storage.writer import RunWriter
from tests.files.runs import Compression, attempt, describe, names, random_rows


# An output that cannot be written is refused before anything is created, and a lock keeps others away.
def make_link(path: Path) -> None:
    (path.parent / "elsewhere.h5").write_bytes(b"of another")
    path.symlink_to(path.parent / "elsewhere.h5")


IN_ITS_PLACE: dict[str, Callable[[Path], object]] = {
    "folder": Path.mkdir,
    "pipe": os.mkfifo,
    "link": make_link,
    "dangling link": lambda path: path.symlink_to(path.parent / "nowhere.h5"),
}


@pytest.mark.parametrize("name", ["run.h5", "run.h5.part"])
@pytest.mark.parametrize("kind", IN_ITS_PLACE)
def test_what_is_no_regular_file_is_refused(tmp_path: Path, kind: str, name: str) -> None:
    IN_ITS_PLACE[kind](tmp_path / name)
    before = names(tmp_path)
    for force in (False, True):
        with pytest.raises(OutputRefused, match="not a regular file"):
            attempt(tmp_path / "run.h5", force=force)
    assert names(tmp_path) == before
    assert not (tmp_path / "elsewhere.h5").exists() or (tmp_path / "elsewhere.h5").read_bytes() == b"of another"


def linked(path: Path, link: Callable[[Path, Path], object]) -> Path:
    link(path, path.with_name("link"))
    return path.with_name("link")


NAMED: dict[str, Callable[[Path], Path]] = {
    "itself": lambda path: path,
    "by another path": lambda path: path.parent / ".." / path.parent.name / path.name,
    "by a link": lambda path: linked(path, os.symlink),
    "by a hard link": lambda path: linked(path, os.link),
}


@pytest.mark.parametrize("name", ["run.h5", "run.h5.part"])
@pytest.mark.parametrize("how", NAMED)
def test_what_is_read_is_no_output_by_any_name(tmp_path: Path, how: str, name: str) -> None:
    (tmp_path / name).write_bytes(b"read")
    read = NAMED[how](tmp_path / name)
    for force in (False, True):
        with pytest.raises(OutputRefused, match="is read here"):
            check_output(tmp_path / "run.h5", force=force, reads=[tmp_path / "missing", read])
    check_output(tmp_path / "other.h5", force=False, reads=[read])


def test_an_existing_file_is_refused_and_replaced_by_force(tmp_path: Path) -> None:
    (tmp_path / "run.h5").write_bytes(b"older")
    with pytest.raises(OutputRefused, match="force=True"):
        attempt(tmp_path / "run.h5")
    assert names(tmp_path) == ["run.h5"]
    assert (tmp_path / "run.h5").read_bytes() == b"older"
    attempt(tmp_path / "run.h5", force=True)
    assert names(tmp_path) == ["run.h5"]
    with open_run(tmp_path / "run.h5") as run:
        assert run.damaged() == {}


@pytest.mark.parametrize("left", [b"", b"older", b"x" * 10**6])
@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_part_of_a_dead_run_is_overwritten(tmp_path: Path, left: bytes, compression: Compression) -> None:
    (tmp_path / "run.h5.part").write_bytes(left)
    attempt(tmp_path / "run.h5", compression=compression)
    assert names(tmp_path) == ["run.h5"]
    with open_run(tmp_path / "run.h5") as run:
        assert run.damaged() == {}


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("missing/run.h5", "no such folder"),
        ("file/run.h5", "no such folder"),
        ("x" * 300, "too long"),
        ("x" * 252, "too long"),
        ("a\0b", "null"),
        ("", "not a regular file"),
        ("/", "names a folder"),
        ("new/", "names a folder"),
    ],
)
def test_an_impossible_path_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, reason: str) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputRefused, match=reason):
        attempt(path)
    assert names(tmp_path) == ["file"]


def test_the_space_is_taken_from_the_start_and_the_part_is_no_result(tmp_path: Path) -> None:
    with RunWriter(tmp_path / "run.h5", describe(100_000)) as writer:
        assert names(tmp_path) == ["run.h5.part"]
        about = (tmp_path / "run.h5.part").stat()
        assert about.st_blocks * 512 >= about.st_size > 100_000 * 73
        with pytest.raises(RunFileRefused, match="is being written by another program"):
            open_run(tmp_path / "run.h5.part")
        writer.write("trace", 0, random_rows(describe())["trace"])
        shutil.copy(tmp_path / "run.h5.part", tmp_path / "killed.h5.part")
    assert names(tmp_path) == ["killed.h5.part"]
    with pytest.raises(RunFileRefused, match="is a part of a run that did not end"):
        open_run(tmp_path / "killed.h5.part")


def test_a_second_writer_is_refused_and_the_first_continues(tmp_path: Path) -> None:
    description = describe()
    with RunWriter(tmp_path / "run.h5", description) as writer:
        for force in (False, True):
            with pytest.raises(OutputInUse, match="another process is writing"):
                attempt(tmp_path / "run.h5", force=force)
        for group, columns in random_rows(description).items():
            writer.write(group, 0, columns)
        writer.publish({})
    assert names(tmp_path) == ["run.h5"]


def test_of_many_writers_one_has_the_part_and_no_result_is_cut(tmp_path: Path) -> None:
    """The part gets its final name at each end, so most of these turns open one that is about to go."""
    inside, most, turns = [0], [0], [0]
    guard = threading.Lock()

    def contend() -> None:
        for _ in range(100):
            with suppress(OutputInUse), part_file(tmp_path / "run.h5", force=True) as part:
                with guard:
                    inside[0] += 1
                    turns[0] += 1
                    most[0] = max(most[0], inside[0])
                os.pwrite(part.descriptor, b"whole", 0)
                with guard:
                    inside[0] -= 1
                part.finish()
                assert (tmp_path / "run.h5").read_bytes() in (b"", b"whole")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "PATIENCE_SECONDS", 0.0)
        threads = [threading.Thread(target=contend) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert most[0] == 1
    assert turns[0] > 1
    assert names(tmp_path) == ["run.h5"]
    assert (tmp_path / "run.h5").read_bytes() == b"whole"


def test_a_part_that_gets_its_final_name_while_another_waits_is_not_cut(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "run.h5.part").write_bytes(b"whole")
    os.link(tmp_path / "run.h5.part", tmp_path / "kept")
    waited = []

    def lock(descriptor: int, _final: Path) -> None:
        if not waited:
            waited.append(descriptor)
            (tmp_path / "run.h5.part").rename(tmp_path / "run.h5")

    monkeypatch.setattr(output, "_wait_for_lock", lock)
    with pytest.raises(OutputRefused, match="exists already"):
        attempt(tmp_path / "run.h5")
    assert waited
    assert names(tmp_path) == ["kept", "run.h5"]
    (tmp_path / "run.h5").rename(tmp_path / "run.h5.part")
    waited.clear()
    attempt(tmp_path / "run.h5", force=True)
    assert (tmp_path / "kept").read_bytes() == b"whole"


def replaced(path: Path, content: bytes) -> None:
    """Put another file in the place of one."""
    (path.parent / "other").write_bytes(content)
    (path.parent / "other").replace(path)


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_part_that_was_swapped_is_not_published_and_stays(tmp_path: Path, compression: Compression) -> None:
    part = tmp_path / "run.h5.part"
    (tmp_path / "run.h5").write_bytes(b"older")
    with pytest.raises(RubnoiseError, match=r"run\.h5\.part: another file has taken its place .* is not written"):
        attempt(
            tmp_path / "run.h5", compression=compression, force=True, meanwhile=lambda: replaced(part, b"of another")
        )
    assert (tmp_path / "run.h5").read_bytes() == b"older"
    assert names(tmp_path) == ["run.h5", "run.h5.part"]
    assert part.read_bytes() == b"of another"


@pytest.mark.parametrize(
    ("owner", "call", "said"),
    [(fcntl, "flock", "this file system has no locks"), (os, "posix_fallocate", "this file system reserves no space")],
    ids=["locks", "space"],
)
def test_a_file_system_without_locks_or_without_space_to_reserve_gets_one_note(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, owner: ModuleType, call: str, said: str
) -> None:
    monkeypatch.setattr(owner, call, failing(errno.EOPNOTSUPP))
    with warnings.catch_warnings(record=True) as noted:
        warnings.simplefilter("default")
        attempt(tmp_path / "run.h5")
        attempt(tmp_path / "gzip.h5", compression="gzip")
    assert [str(note.message).startswith(said) for note in noted] == [True]
    assert noted[0].category is WrittenWithLess
    with open_run(tmp_path / "run.h5") as run:
        assert run.damaged() == {}


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_only_a_full_disk_or_quota_means_no_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, compression: Compression
) -> None:
    (tmp_path / "run.h5").write_bytes(b"older")
    monkeypatch.setattr(os, "posix_fallocate", failing(number))
    no_room = number != errno.EIO
    with pytest.raises(OutputRefused, match="no room for the .* bytes" if no_room else "cannot be written: input"):
        attempt(tmp_path / "run.h5", force=True, compression=compression)
    assert (tmp_path / "run.h5").read_bytes() == b"older"
    assert names(tmp_path) == ["run.h5"]


def failing(number: int) -> Callable[..., None]:
    """Return a call of the system that fails."""

    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return fail
