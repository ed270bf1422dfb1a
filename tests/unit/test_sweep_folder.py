"""A folder belongs to one sweep, and to one writer at a time."""

import json
import os
from pathlib import Path

import pytest

from rubnoise.errors import OutputRefused, Refused
from rubnoise.scenario.sweep import Sweep, expand
from rubnoise.sweep.folder import Shard, SweepFolder
from rubnoise.sweep.journal import Journal
from tests.unit.sweeps import GRID, sweep_of


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
        (GRID, ("interface.calibration=paper",), "interface.calibration is exact there, and paper here"),
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
        Journal(journal)
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
