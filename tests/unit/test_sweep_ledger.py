"""A run is written down as done when the disk has its file, and what a power cut leaves of one makes no trouble."""

import os
import signal
from collections.abc import Iterator
from errno import EIO
from pathlib import Path

import pytest

import rubnoise
from rubnoise.api.sweeping import keep_run
from rubnoise.scenario.points import Point
from rubnoise.storage import disk, writer
from rubnoise.storage import read_structure as structure_module
from rubnoise.storage.output import OutputPaths, sole_writer
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.journal import Journal, RunRow, entries
from rubnoise.sweep.run_status import RunStatus, StatusLog, found_run
from tests.unit.sweeps import sweep_of

SHORT = "[sweep]\nreplicates = 3\n"


@pytest.fixture
def points(tmp_path: Path) -> tuple[Point, ...]:
    return rubnoise.expand(sweep_of(tmp_path, SHORT))


@pytest.fixture
def folder(tmp_path: Path) -> SweepFolder:
    found = SweepFolder(tmp_path / "d")
    found.run("x").parent.mkdir(parents=True)
    found.journal(None).parent.mkdir()
    return found


@pytest.fixture
def ledger(folder: SweepFolder) -> Iterator[StatusLog]:
    with Journal(folder.journal(None)) as journal:
        yield StatusLog(folder, journal, RunStatus.of(folder, None))


def _made(point: Point, folder: SweepFolder, ledger: StatusLog) -> Path:
    ledger.done(keep_run(point, root=folder.root, command=("x",), durable=False), synced=False)
    return folder.run(point.run_id)


def _left(point: Point, folder: SweepFolder) -> Path:
    """Make a run that no journal lists, as if its sweep were killed in the same moment."""
    return folder.root / keep_run(point, root=folder.root, command=("x",), durable=False).file


def _recovered(point: Point, folder: SweepFolder, ledger: StatusLog) -> RunRow | None:
    return found_run(point, root=folder.root, begun=point.run_id in ledger.status.begun)


def _told(folder: SweepFolder) -> list[tuple[str, str]]:
    return [(entry.run_id, entry.state) for entry in entries(folder.journal(None))]


def test_runs_wait_for_the_disk_together_and_are_written_down_then(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 1e9)  # a run that others keep from the processor would wait itself
    for name in ("sync", "sync_rows", "sync_folder"):
        monkeypatch.setattr(disk, name, lambda _, name=name: calls.append(f"{name} {len(_told(folder))}"))
    ledger.begin(points[:2])
    begun = [(point.run_id, "begun") for point in points[:2]]
    assert _told(folder) == begun
    for point in points[:2]:
        _made(point, folder, ledger)
    assert calls == []
    assert _told(folder) == begun
    assert not ledger.sync()
    assert calls == ["sync 2", "sync 2", "sync_folder 2"]
    assert _told(folder) == begun + [(point.run_id, "done") for point in points[:2]]
    assert not ledger.sync()
    assert len(calls) == 3


def test_a_run_alone_waits_for_the_disk(
    points: tuple[Point, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []
    monkeypatch.setattr(disk, "sync", lambda _: calls.append("sync"))
    rubnoise.run(points[0].scenario, tmp_path / "x.h5").close()
    assert len(calls) >= 3


def test_a_disk_that_fails_afterwards_makes_the_run_a_failed_one(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    ledger.begin(points[:2])
    good, bad = (_made(point, folder, ledger) for point in points[:2])
    reopen = disk.reopen

    def failing(path: Path) -> int:
        if path == bad:
            raise OSError(EIO, "Input/output error")
        return reopen(path)

    monkeypatch.setattr(disk, "reopen", failing)
    assert ledger.sync()
    assert _told(folder)[2:] == [(good.stem, "done"), (bad.stem, "failed")]
    assert (set(ledger.status.done), set(ledger.status.failed)) == ({good.stem}, {bad.stem})
    *_, last = entries(folder.journal(None))
    assert (good.exists(), bad.exists()) == (True, False)
    assert last.reason == f"{bad}: writing failed: Input/output error"


def test_only_what_had_no_file_is_begun_and_once(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog
) -> None:
    folder.run(points[0].run_id).write_bytes(b"mine")
    ledger.begin(points)
    ledger.begin(points)
    assert _told(folder) == [(point.run_id, "begun") for point in points[1:]]
    assert RunStatus.of(folder, None).begun == {point.run_id for point in points[1:]}


def test_torn_results_of_runs_that_were_begun_go_and_others_stay(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog
) -> None:
    stranger, torn, whole = (folder.run(point.run_id) for point in points)
    stranger.write_bytes(b"mine")
    ledger.begin(points)
    for point in points[1:]:
        _left(point, folder)
    with torn.open("r+b") as file:
        file.truncate(torn.stat().st_size // 2)
    for point in points:
        _recovered(point, folder, ledger)
    assert stranger.read_bytes() == b"mine"
    assert not torn.exists()
    assert found_run(points[2], root=folder.root) is not None
    assert whole.exists()


def test_a_result_with_a_flipped_bit_is_not_taken_for_the_run(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog
) -> None:
    path = _left(points[0], folder)
    with rubnoise.open(path) as run:
        at = path.read_bytes().index(run.trace["real_contact_area"][100:200].tobytes())
    data = bytearray(path.read_bytes())
    data[at] ^= 1
    path.write_bytes(data)
    assert found_run(points[0], root=folder.root) is None
    ledger.begin(points)
    _recovered(points[0], folder, ledger)
    assert path.exists()  # it was there before, and may be anybody's
    ledger.status.begun.add(points[0].run_id)
    _recovered(points[0], folder, ledger)
    assert not path.exists()


def test_parts_without_a_commit_go_and_second_names_too_unless_somebody_writes(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog
) -> None:
    ledger.begin(points)
    path = _left(points[0], folder)
    paths, torn = OutputPaths.of(path), OutputPaths.of(folder.run(points[1].run_id))
    paths.part.hardlink_to(path)
    (alone := OutputPaths.of(folder.run(points[2].run_id)).journal).write_bytes(b"of a part that is gone")
    torn.part.write_bytes(bytes(5000))
    with sole_writer(torn):
        _recovered(points[1], folder, ledger)
        assert torn.part.exists()
    for point in points:
        _recovered(point, folder, ledger)
    assert path.exists()
    assert not paths.part.exists()
    assert not alone.exists()
    assert not torn.part.exists()


def test_a_whole_result_stays_when_whoever_looks_at_it_is_killed(
    points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    ledger.begin(points)
    path = _left(points[0], folder)
    with monkeypatch.context() as patches:
        patches.setattr(structure_module, "read_structure", lambda _: os.kill(os.getpid(), signal.SIGKILL))
        assert _recovered(points[0], folder, ledger) is None
    assert path.exists()
    assert _recovered(points[0], folder, ledger) is not None


def test_a_whole_result_of_another_run_stays(points: tuple[Point, ...], folder: SweepFolder, ledger: StatusLog) -> None:
    ledger.begin(points)
    path = _left(points[1], folder).rename(folder.run(points[0].run_id))
    assert _recovered(points[0], folder, ledger) is None
    assert path.exists()
