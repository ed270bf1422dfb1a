"""An output is refused before anything is created, and locks keep others away."""

import errno
import fcntl
import os
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from rubnoise.errors import OutputRefused
from rubnoise.storage import disk
from rubnoise.storage.lock import Held, holding, is_held, remove_stale
from rubnoise.storage.output import OutputPaths, check_output, sole_writer
from rubnoise.storage.reader import open_run, open_unfinished
from rubnoise.storage.sync_many import clear_unsynced
from rubnoise.storage.writer import RunWriter
from tests.format.runs import attempt, describe, names, random_rows


# An output that cannot be written is refused before anything is created, and a lock keeps others away.
def make_folder(path: Path) -> None:
    path.mkdir()


def make_pipe(path: Path) -> None:
    os.mkfifo(path)


def make_link(path: Path) -> None:
    (path.parent / "elsewhere.h5").write_bytes(b"of somebody")
    path.symlink_to(path.parent / "elsewhere.h5")


def make_dangling_link(path: Path) -> None:
    path.symlink_to(path.parent / "nowhere.h5")


@pytest.mark.parametrize("name", ["run.h5", "run.h5.part", ".run.h5.lock", ".run.h5.making"])
@pytest.mark.parametrize("make", [make_folder, make_pipe, make_link, make_dangling_link])
def test_what_is_no_regular_file_is_refused(tmp_path: Path, make: Callable[[Path], None], name: str) -> None:
    make(tmp_path / name)
    before = names(tmp_path)
    for force in (False, True):
        with pytest.raises(OutputRefused, match="not a regular file"):
            attempt(tmp_path / "run.h5", force=force)
    assert names(tmp_path) == before
    assert not (tmp_path / "elsewhere.h5").exists() or (tmp_path / "elsewhere.h5").read_bytes() == b"of somebody"


def itself(path: Path) -> Path:
    return path


def by_another_path(path: Path) -> Path:
    return path.parent / ".." / path.parent.name / path.name


def by_a_link(path: Path) -> Path:
    link = path.with_name("link")
    link.symlink_to(path)
    return link


def by_a_hard_link(path: Path) -> Path:
    os.link(path, path.with_name("link"))
    return path.with_name("link")


@pytest.mark.parametrize("name", ["run.h5", "run.h5.part"])
@pytest.mark.parametrize("named", [itself, by_another_path, by_a_link, by_a_hard_link])
def test_what_is_read_is_no_output_by_any_name(tmp_path: Path, named: Callable[[Path], Path], name: str) -> None:
    (tmp_path / name).write_bytes(b"read")
    read = named(tmp_path / name)
    for force in (False, True):
        with pytest.raises(OutputRefused, match="is read here"):
            check_output(tmp_path / "run.h5", force=force, reads=[tmp_path / "missing", read])
    check_output(tmp_path / "other.h5", force=False, reads=[read])


@pytest.mark.parametrize("name", ["run.h5", "run.h5.part"])
def test_an_existing_file_is_refused_and_replaced_by_force(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"older")
    with pytest.raises(OutputRefused, match="force=True"):
        attempt(tmp_path / "run.h5")
    assert names(tmp_path) == [name]
    assert (tmp_path / name).read_bytes() == b"older"
    attempt(tmp_path / "run.h5", force=True)
    assert names(tmp_path) == ["run.h5"]
    with open_run(tmp_path / "run.h5") as run:
        assert run.damaged() == ()


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("missing/run.h5", "no such folder"),
        ("file/run.h5", "no such folder"),
        ("x" * 300, "too long"),
        ("x" * 250, "too long"),
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


@contextmanager
def as_nobody() -> Iterator[None]:
    """Give up the right of root to write everywhere."""
    if os.getuid() != 0:
        yield
        return
    os.setresuid(65534, 65534, 0)
    try:
        yield
    finally:
        os.setresuid(0, 0, 0)


def test_a_folder_that_is_not_writable_is_refused() -> None:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o555)
        try:
            with as_nobody(), pytest.raises(OutputRefused, match="not writable"):
                attempt(Path(folder, "run.h5"))
            assert names(Path(folder)) == []
        finally:
            Path(folder).chmod(0o755)


def test_a_relative_path_stays_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "later").mkdir()
    monkeypatch.chdir(tmp_path)
    description = describe()
    with RunWriter("run.h5", description) as writer:
        monkeypatch.chdir(tmp_path / "later")
        for group, columns in random_rows(description).items():
            writer.write(group, 0, columns)
        writer.publish({})
    assert names(tmp_path) == ["later", "run.h5"]
    assert names(tmp_path / "later") == []


def test_the_part_is_whole_in_structure_from_the_start(tmp_path: Path) -> None:
    with RunWriter(tmp_path / "run.h5", describe()):
        assert names(tmp_path) == [".run.h5.lock", "run.h5.part"]
        with open_unfinished(tmp_path / "run.h5.part") as part:
            assert part.extent == describe().extent
            assert part.provenance["scenario_toml"] == describe().scenario_toml
            assert part.provenance["finished"] == ""
            assert part.summary == {}
        blocks = (tmp_path / "run.h5.part").stat().st_blocks
        assert blocks * 512 >= (tmp_path / "run.h5.part").stat().st_size
    assert names(tmp_path) == []


def test_a_second_writer_is_refused_and_the_first_goes_on(tmp_path: Path) -> None:
    description = describe()
    with RunWriter(tmp_path / "run.h5", description) as writer:
        for force in (False, True):
            with (
                pytest.raises(OutputRefused, match="another process is writing"),
                sole_writer(OutputPaths.of(tmp_path / "run.h5")),
            ):
                raise AssertionError
            with pytest.raises(OutputRefused):
                attempt(tmp_path / "run.h5", force=force)
        for group, columns in random_rows(description).items():
            writer.write(group, 0, columns)
        writer.publish({})
    assert names(tmp_path) == ["run.h5"]


def test_of_many_who_want_a_lock_one_has_it(tmp_path: Path) -> None:
    """The lock file is removed at each end, so most of these turns open one that is about to go."""
    paths = OutputPaths.of(tmp_path / "run.h5")
    inside, most, turns = [0], [0], [0]
    guard = threading.Lock()

    def contend() -> None:
        for _ in range(300):
            try:
                with sole_writer(paths):
                    with guard:
                        inside[0] += 1
                        turns[0] += 1
                        most[0] = max(most[0], inside[0])
                    os.sched_yield()
                    with guard:
                        inside[0] -= 1
            except OutputRefused:
                continue

    threads = [threading.Thread(target=contend) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most[0] == 1
    assert turns[0] > 1
    assert names(tmp_path) == []


def test_a_lock_whose_name_is_gone_stops_nobody(tmp_path: Path) -> None:
    paths = OutputPaths.of(tmp_path / "run.h5")
    with paths.lock.open("w") as stale:
        fcntl.flock(stale, fcntl.LOCK_EX)
        paths.lock.unlink()
        attempt(tmp_path / "run.h5")
    assert names(tmp_path) == ["run.h5"]


def test_checking_creates_nothing(tmp_path: Path) -> None:
    paths = check_output(tmp_path / "run.h5", force=False)
    assert paths.final == tmp_path / "run.h5"
    assert names(tmp_path) == []


# A lock is held by one alone or shared by several, and its file goes with the last of them, whatever else fails.
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
    clear_unsynced(paths.final, "intact")
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
