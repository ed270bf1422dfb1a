"""The folder of a sweep: one owner, and runs written down as done when the disk has them."""

import json
import os
from collections.abc import Iterator
from errno import EIO
from pathlib import Path
from types import SimpleNamespace

import pytest

import rubnoise
from rubnoise.api.sweeping import keep_run
from rubnoise.errors import OutputRefused, Refused
from rubnoise.scenario.points import Point, run_id
from rubnoise.scenario.sweep import Sweep, expand
from rubnoise.storage import disk, writer
from rubnoise.storage.output import OutputPaths, sole_writer
from rubnoise.sweep import index
from rubnoise.sweep.folder import Shard, SweepFolder
from rubnoise.sweep.journal import RunRow, SweepJournal, entries
from rubnoise.sweep.run_status import RunStatus, StatusLog, found_run
from rubnoise.sweep.stopping_rule import AdaptiveReplicates
from tests.unit.scenarios import GRID, sweep_of


# A folder belongs to one sweep, and to one writer at a time.
@pytest.fixture
def sweep(tmp_path: Path) -> Sweep:
    return sweep_of(tmp_path, GRID)


@pytest.fixture
def folder(tmp_path: Path, sweep: Sweep) -> SweepFolder:
    """Return a folder that is that of the sweep."""
    found = SweepFolder(tmp_path / "dir")
    found.check()
    with found.writing(None):
        found.claim(sweep)
    return found


@pytest.mark.parametrize(
    ("table", "changes"),
    [
        (GRID, ()),
        (GRID, ("title=another",)),
        (GRID, ("run.engine=events",)),
        (GRID, ("sweep.replicates=7",)),
        (GRID, ("sweep.replicates=1",)),
        (GRID.replace("[10, 20, 30]", "[40, 30, 20, 10]"), ()),
        (GRID.replace("100 um^2", "0.0001 mm^2"), ()),
    ],
    ids=["the same", "titled anew", "by the other engine", "more replicates", "fewer", "more points", "other units"],
)
def test_a_sweep_that_has_the_same_points_and_others_goes_on(
    tmp_path: Path, folder: SweepFolder, table: str, changes: tuple[str, ...]
) -> None:
    folder.claim(sweep_of(tmp_path, table, *changes))


@pytest.mark.parametrize(
    ("table", "changes", "said"),
    [
        (GRID, ("sliding.distance=3 mm",), "sliding.distance is 2000 um there, and 3000 um here"),
        (GRID, ("run.seed=2",), "run.seed is 1 there, and 2 here"),
        (GRID, ("interface.calibration=paper",), "interface.calibration is matched there, and paper here"),
        (GRID, ("strength.mean=1 MPa",), "strength.law is not given there, and constant here"),
        (
            GRID.replace("[10, 20, 30]", "[10, 20]"), (),
            ("it has a point that this one lacks: interface.mean_real_contact_area = 100 um^2, "
            "interface.mean_junction_count = 30, and 1 more"),
        ),
        (GRID, ('sweep.keep="summary"',), 'sweep.keep is "runs" there, and "summary" here'),
    ],
)  # fmt: skip
def test_another_sweep_is_refused_with_the_difference(
    tmp_path: Path, folder: SweepFolder, table: str, changes: tuple[str, ...], said: str
) -> None:
    with pytest.raises(OutputRefused, match="is the folder of another sweep") as refused:
        folder.claim(sweep_of(tmp_path, table, *changes))
    assert str(refused.value).endswith(f": {said}")


UNEQUAL = ('diameter.spread="50 %"', "diameter.law=lognormal")


def test_a_folder_of_the_first_calibration_goes_on_with_a_file_that_names_none(tmp_path: Path) -> None:
    first = sweep_of(tmp_path, GRID, *UNEQUAL, "interface.calibration=exact")
    folder = SweepFolder(tmp_path / "dir")
    with folder.writing(None):
        folder.claim(first)
        today = sweep_of(tmp_path, GRID, *UNEQUAL)
        assert [run_id(case.scenario) for case in today.cases] != [run_id(case.scenario) for case in first.cases]
        again = folder.claim(today)
        assert [run_id(case.scenario) for case in again.cases] == [run_id(case.scenario) for case in first.cases]
        assert [case.scenario.text for case in again.cases] == [case.scenario.text for case in today.cases]
        with pytest.raises(OutputRefused, match="calibration is exact there, and matched here"):
            folder.claim(sweep_of(tmp_path, GRID, *UNEQUAL, "interface.calibration=matched"))


def test_another_version_of_the_streams_is_refused(sweep: Sweep, folder: SweepFolder) -> None:
    told = json.loads((folder.root / "sweep.json").read_text(encoding="utf-8"))
    (folder.root / "sweep.json").write_text(json.dumps(told | {"stream_version": 0}), encoding="utf-8")
    with pytest.raises(OutputRefused, match="its random streams are of version 0, and those of today of 1"):
        folder.claim(sweep)


KEPT = '{"format": "rubnoise-sweep", "format_version": 1'


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "[" * 100_000,
        '{"format": "rubnoise-sweep", "format_version": 2}',
        KEPT + "}",
        KEPT + ', "stream_version": 1, "keep": "runs", "points": 7}',
        KEPT + ', "stream_version": 1, "keep": "runs", "points": [[]]}',
        KEPT + ', "stream_version": 1, "keep": "runs", "points": [{"name": "x"}]}',
        KEPT + ', "stream_version": 1, "keep": "runs", "points": [{"name": "x", "values": {}}], "first": []}',
    ],
)
def test_a_description_that_is_none_is_refused(sweep: Sweep, folder: SweepFolder, text: str) -> None:
    (folder.root / "sweep.json").write_text(text, encoding="utf-8")
    with pytest.raises(OutputRefused, match=r"sweep\.json: "):
        folder.claim(sweep)


def test_pipes_in_a_folder_are_refused_and_not_waited_for(sweep: Sweep, folder: SweepFolder) -> None:
    journal = folder.journal(None)
    os.mkfifo(journal)
    with pytest.raises(OutputRefused, match=r"runs\.jsonl: is not a regular file"):
        list(folder.entries())
    with pytest.raises(OutputRefused, match=r"runs\.jsonl: exists and is not a regular file"):
        SweepJournal(journal)
    (folder.root / "sweep.json").unlink()
    os.mkfifo(folder.root / "sweep.json")
    with pytest.raises(OutputRefused, match=r"sweep\.json: cannot be read: is not a regular file"):
        folder.claim(sweep)


def test_a_folder_of_other_things_is_refused_and_one_that_was_only_begun_is_not(tmp_path: Path) -> None:
    (root := tmp_path / "dir").mkdir()
    SweepFolder(root).check()
    with SweepFolder(root).writing(None):
        pass
    (root / "journal").mkdir()
    SweepFolder(root).check()
    (root / "thesis.tex").touch()
    with pytest.raises(OutputRefused, match="is not a sweep folder, and not empty; name another folder"):
        SweepFolder(root).check()
    with pytest.raises(OutputRefused, match=r"thesis.tex: is no folder"):
        SweepFolder(root / "thesis.tex" / "deep").check()


def test_one_writer_or_several_shards(folder: SweepFolder) -> None:
    first, second = Shard.of("1/2"), Shard.of("2/2")
    with folder.writing(first), folder.writing(second):
        for other in (None, second):
            with pytest.raises(OutputRefused, match="another process is running this sweep"):
                folder.writing(other).__enter__()
    with folder.writing(None), pytest.raises(OutputRefused, match="another process"):
        folder.writing(first).__enter__()


def test_no_lock_outlives_its_holder(folder: SweepFolder) -> None:
    with folder.writing(Shard.of("1/2")):
        with folder.writing(Shard.of("2/2")), folder.alone_at("index"):
            assert _locks(folder) == [".index.lock", ".shard-1-of-2.lock", ".shard-2-of-2.lock", ".sweep.lock"]
        assert _locks(folder) == [".shard-1-of-2.lock", ".sweep.lock"]
    with folder.writing(None):
        assert _locks(folder) == [".sweep.lock"]
    assert _locks(folder) == []


def _locks(folder: SweepFolder) -> list[str]:
    return sorted(path.name for path in folder.root.rglob("*.lock"))


def test_shards_are_parts_of_the_whole_whatever_the_order(sweep: Sweep) -> None:
    points = expand(sweep)
    parts = [Shard(number=n, count=5).of_points(points, points) for n in range(1, 6)]
    assert sorted(point.run_id for part in parts for point in part) == sorted(point.run_id for point in points)
    assert {len(part) for part in parts} <= {2, 3}
    assert [Shard(number=n, count=5).of_points(points[:4], points[::-1]) for n in range(1, 6)] == [
        tuple(point for point in part if point in points[:4]) for part in parts
    ]
    cases = [Shard(number=n, count=4).of_cases(sweep.cases) for n in range(1, 5)]
    assert sum(map(len, cases)) == len(sweep.cases)


@pytest.mark.parametrize("text", ["", "1", "0/4", "5/4", "1/0", "a/b", "1/4/2", "-1/4", "1/99999999"])
def test_what_is_no_shard_is_refused(text: str) -> None:
    with pytest.raises(Refused, match='right form: shard="2/8"'):
        Shard.of(text)


def test_every_file_has_its_place(folder: SweepFolder) -> None:
    assert folder.run("ab").relative_to(folder.root).as_posix() == folder.relative("ab") == "runs/ab.h5"
    assert folder.journal(Shard.of("2/8")) != folder.journal(None)


# A run is written down as done when the disk has its file, and what a power cut leaves of one makes no trouble.
SHORT = "[sweep]\nreplicates = 3\n"


@pytest.fixture
def points(tmp_path: Path) -> tuple[Point, ...]:
    return rubnoise.expand(sweep_of(tmp_path, SHORT))


@pytest.fixture
def claimed(tmp_path: Path) -> SweepFolder:
    found = SweepFolder(tmp_path / "d")
    found.run("x").parent.mkdir(parents=True)
    found.journal(None).parent.mkdir()
    return found


@pytest.fixture
def ledger(claimed: SweepFolder) -> Iterator[StatusLog]:
    with SweepJournal(claimed.journal(None)) as journal:
        yield StatusLog(claimed, journal, RunStatus.of(claimed, None))


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
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 1e9)  # a run that others keep from the processor would wait itself
    for name in ("sync", "sync_rows", "sync_folder"):
        monkeypatch.setattr(disk, name, lambda _, name=name: calls.append(f"{name} {len(_told(claimed))}"))
    ledger.begin(points[:2])
    begun = [(point.run_id, "begun") for point in points[:2]]
    assert _told(claimed) == begun
    for point in points[:2]:
        _made(point, claimed, ledger)
    assert calls == []
    assert _told(claimed) == begun
    assert not ledger.sync()
    assert calls == ["sync 2", "sync 2", "sync_folder 2"]
    assert _told(claimed) == begun + [(point.run_id, "done") for point in points[:2]]
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
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    ledger.begin(points[:2])
    good, bad = (_made(point, claimed, ledger) for point in points[:2])
    reopen = disk.reopen

    def failing(path: Path) -> int:
        if path == bad:
            raise OSError(EIO, "Input/output error")
        return reopen(path)

    monkeypatch.setattr(disk, "reopen", failing)
    assert ledger.sync()
    assert _told(claimed)[2:] == [(good.stem, "done"), (bad.stem, "failed")]
    assert (set(ledger.status.done), set(ledger.status.failed)) == ({good.stem}, {bad.stem})
    *_, last = entries(claimed.journal(None))
    assert (good.exists(), bad.exists()) == (True, False)
    assert last.reason == f"{bad}: writing failed: Input/output error"


def test_only_what_had_no_file_is_begun_and_once(
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog
) -> None:
    claimed.run(points[0].run_id).write_bytes(b"mine")
    ledger.begin(points)
    ledger.begin(points)
    assert _told(claimed) == [(point.run_id, "begun") for point in points[1:]]
    assert RunStatus.of(claimed, None).begun == {point.run_id for point in points[1:]}


def test_truncated_results_of_runs_that_were_begun_go_and_others_stay(
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog
) -> None:
    stranger, truncated, intact = (claimed.run(point.run_id) for point in points)
    stranger.write_bytes(b"mine")
    ledger.begin(points)
    for point in points[1:]:
        _left(point, claimed)
    with truncated.open("r+b") as file:
        file.truncate(truncated.stat().st_size // 2)
    for point in points:
        _recovered(point, claimed, ledger)
    assert stranger.read_bytes() == b"mine"
    assert not truncated.exists()
    assert found_run(points[2], root=claimed.root) is not None
    assert intact.exists()


def test_a_result_with_a_flipped_bit_is_not_taken_for_the_run(
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog
) -> None:
    path = _left(points[0], claimed)
    with rubnoise.open(path) as run:
        at = path.read_bytes().index(run.trace["real_contact_area"][100:200].tobytes())
    data = bytearray(path.read_bytes())
    data[at] ^= 1
    path.write_bytes(data)
    assert found_run(points[0], root=claimed.root) is None
    ledger.begin(points)
    _recovered(points[0], claimed, ledger)
    assert path.exists()  # it was there before, and may be anybody's
    ledger.status.begun.add(points[0].run_id)
    _recovered(points[0], claimed, ledger)
    assert not path.exists()


def test_parts_without_a_commit_go_and_second_names_too_unless_somebody_writes(
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog
) -> None:
    ledger.begin(points)
    path = _left(points[0], claimed)
    paths, truncated = OutputPaths.of(path), OutputPaths.of(claimed.run(points[1].run_id))
    paths.part.hardlink_to(path)
    (alone := OutputPaths.of(claimed.run(points[2].run_id)).journal).write_bytes(b"of a part that is gone")
    truncated.part.write_bytes(bytes(5000))
    with sole_writer(truncated):
        _recovered(points[1], claimed, ledger)
        assert truncated.part.exists()
    for point in points:
        _recovered(point, claimed, ledger)
    assert path.exists()
    assert not paths.part.exists()
    assert not alone.exists()
    assert not truncated.part.exists()


def test_a_sweep_without_room_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.disk_usage", lambda _path: SimpleNamespace(free=1000))
    with pytest.raises(OutputRefused, match="there is room for 1,000"):
        rubnoise.run_sweep("paper/fig9", tmp_path / "deep" / "fig9", jobs=1)
    assert not list(tmp_path.iterdir())


def test_a_whole_result_of_another_run_stays(
    points: tuple[Point, ...], claimed: SweepFolder, ledger: StatusLog
) -> None:
    ledger.begin(points)
    path = _left(points[1], claimed).rename(claimed.run(points[0].run_id))
    assert _recovered(points[0], claimed, ledger) is None
    assert path.exists()


@pytest.mark.parametrize(("alone", "every", "count"), [(True, 0.0, 1), (True, 1e9, 0), (False, 0.0, 0)])
def test_only_a_whole_sweep_renews_its_index_on_the_way(
    claimed: SweepFolder, sweep: Sweep, monkeypatch: pytest.MonkeyPatch, *, alone: bool, every: float, count: int
) -> None:
    monkeypatch.setattr(index, "EVERY", every)
    refresh, renewed = index.IndexRefresh(claimed, sweep, AdaptiveReplicates(sweep), "", alone=alone), []
    monkeypatch.setattr(refresh, "now", lambda: renewed.append("index.h5"))
    refresh.if_due()
    assert renewed == ["index.h5"] * count
