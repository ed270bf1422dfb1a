"""A lock is held by one alone or shared by several, and its file goes with the last of them, whatever else fails."""

import errno
import fcntl
import os
import threading
from pathlib import Path

import pytest

from rubnoise.errors import OutputRefused
from rubnoise.storage import disk
from rubnoise.storage.lock import Held, holding, is_held, remove_stale
from rubnoise.storage.output import OutputPaths, sole_writer
from rubnoise.storage.sync_many import clear_unsynced
from tests.format.runs import attempt, names

SOON = 0.02


def test_held_alone_it_keeps_all_others_away(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with holding(path):
        assert is_held(path)
        for shared in (False, True):
            with pytest.raises(Held), holding(path, shared=shared, patience=SOON):
                raise AssertionError
        assert names(tmp_path) == ["lock"]
    assert not is_held(path)
    assert names(tmp_path) == []


def test_a_shared_lock_goes_with_the_last_who_holds_it(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with holding(path, shared=True):
        with holding(path, shared=True), pytest.raises(Held), holding(path, patience=SOON):
            raise AssertionError
        assert names(tmp_path) == ["lock"]
        with pytest.raises(Held), holding(path, patience=SOON):
            raise AssertionError
    assert names(tmp_path) == []
    with holding(path):
        pass


def test_of_many_who_share_or_want_it_alone_none_is_wrong(tmp_path: Path) -> None:
    path, guard = tmp_path / "lock", threading.Lock()
    inside, wrong, turns = [0, 0], [0], [0, 0]

    def contend(*, shared: bool) -> None:
        for _ in range(100):
            with holding(path, shared=shared, patience=None):
                with guard:
                    inside[shared] += 1
                    turns[shared] += 1
                    wrong[0] += inside[False] > (0 if inside[True] else 1)
                os.sched_yield()
                with guard:
                    inside[shared] -= 1

    threads = [threading.Thread(target=contend, kwargs={"shared": n % 2 == 0}) for n in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == [0]
    assert turns == [300, 300]
    assert names(tmp_path) == []


def failing_for(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the disk fail where one name is to be removed."""
    remove = disk.remove

    def failing(name: Path) -> None:
        if name == path:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        remove(name)

    monkeypatch.setattr(disk, "remove", failing)


def test_a_lock_that_cannot_be_removed_is_no_failure_of_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    paths = OutputPaths.of(tmp_path / "run.h5")
    with monkeypatch.context() as patch:
        failing_for(paths.lock, patch)
        attempt(paths.final)
        assert names(tmp_path) == [".run.h5.lock", "run.h5"]
    attempt(paths.final, force=True)
    assert names(tmp_path) == ["run.h5"]


def test_where_there_are_no_locks_none_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EOPNOTSUPP, os.strerror(errno.EOPNOTSUPP))

    monkeypatch.setattr(fcntl, "flock", refuse)
    with pytest.raises(OutputRefused, match=r"run\.h5: cannot be locked: Operation not supported"):
        attempt(tmp_path / "run.h5")
    assert names(tmp_path) == []


def test_what_a_kill_left_beside_a_result_goes_when_the_result_is_in_the_way(tmp_path: Path) -> None:
    paths = OutputPaths.of(tmp_path / "run.h5")
    attempt(paths.final)
    paths.lock.touch()
    with pytest.raises(OutputRefused, match="exists already"):
        attempt(paths.final)
    assert names(tmp_path) == ["run.h5"]
    with sole_writer(paths):
        with pytest.raises(OutputRefused, match="exists already"):
            attempt(paths.final)
        assert is_held(paths.lock)


def test_what_a_kill_left_of_a_run_of_a_sweep_goes_when_it_is_found_whole(tmp_path: Path) -> None:
    paths = OutputPaths.of(tmp_path / "run.h5")
    attempt(paths.final)
    paths.lock.touch()
    paths.making.touch()
    clear_unsynced(paths.final, "whole")
    assert names(tmp_path) == ["run.h5"]


def test_only_the_file_of_a_lock_is_removed_and_only_where_nobody_holds_it(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    remove_stale(path)
    with holding(path, shared=True):
        remove_stale(path)
        assert names(tmp_path) == ["lock"]
    os.mkfifo(path)
    (tmp_path / "link").symlink_to(tmp_path / "lock")
    for name in ("lock", "link"):
        remove_stale(tmp_path / name)
        assert not is_held(tmp_path / name)
    assert names(tmp_path) == ["link", "lock"]
    path.unlink()
    path.touch()
    remove_stale(path)
    assert names(tmp_path) == ["link"]


def test_a_lock_made_anew_by_others_stays_theirs(tmp_path: Path) -> None:
    """If another process removes the file of a lock that is held, its holder leaves the next one alone."""
    path = tmp_path / "lock"
    with holding(path):
        path.unlink()
        with path.open("w") as other:
            fcntl.flock(other, fcntl.LOCK_EX)
    assert names(tmp_path) == ["lock"]
