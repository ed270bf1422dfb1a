"""The folder of a sweep: a run is done if its file is there, and what is not of the sweep is refused or left."""

import os
from collections.abc import Callable
from contextlib import AbstractContextManager
from errno import EIO
from pathlib import Path
from shutil import copytree, rmtree

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import OutputRefused, RunFileRefused
from rubnoise.runs import folder as place
from rubnoise.runs import sweep
from rubnoise.runs.folder import file_of, found, read
from rubnoise.runs.making import describe
from rubnoise.runs.sweep import check_folder, in_shard
from rubnoise.runs.verification import verify_sweep
from rubnoise.scenario.sweep import Sweep, expand
from rubnoise.storage.output import PartFile
from rubnoise.storage.writer import RunWriter
from tests.unit.scenarios import GRID, SHORT_HEAD, SMALL, sweep_of

pytestmark = pytest.mark.slow


def small(folder: Path, *changes: str, table: str = SMALL) -> Sweep:
    return sweep_of(folder, table, *changes, head=SHORT_HEAD)


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep of four runs."""
    folder = tmp_path_factory.mktemp("swept")
    rubnoise.sweep(small(folder), folder / "d", jobs=1).close()
    return folder / "d"


@pytest.fixture
def folder(original: Path, tmp_path: Path) -> Path:
    return Path(copytree(original, tmp_path / "d"))


def times(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in (folder / "runs").iterdir()}


def being_made(path: Path, folder: Path) -> AbstractContextManager[RunWriter]:
    """Return the writer of a run that is being made."""
    point = next(point for point in expand(small(folder)) if point.run_id == path.stem)
    return RunWriter(path, describe(point.scenario, path, ["rubnoise"]), force=True)


def made(call: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> int:
    """Return how many runs a call makes."""
    count: list[object] = []
    whole = place.play
    with monkeypatch.context() as patch:
        patch.setattr(place, "play", lambda *given, **named: (count.append(given), whole(*given, **named))[1])
        call()
    return len(count)


# What belongs to a folder.
@pytest.mark.parametrize(
    ("table", "changes"),
    [
        (SMALL, ()),
        (SMALL, ("title=another",)),
        (SMALL, ("run.engine=events",)),
        (SMALL, ("sweep.replicates=3",)),
        (SMALL, ("sweep.replicates=1",)),
        (SMALL.replace("[10, 20]", "[40, 20, 10]"), ()),
        (SMALL.replace("5 um", "0.005 mm"), ()),
    ],
    ids=["the same", "titled anew", "by the other engine", "more replicates", "fewer", "more points", "other units"],
)
def test_a_sweep_that_has_the_same_points_and_others_goes_on(
    tmp_path: Path, folder: Path, table: str, changes: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    before, same = times(folder), small(tmp_path, *changes, table=table)
    count = made(lambda: rubnoise.sweep(same, folder, jobs=1).close(), monkeypatch)
    assert count == max(0, len(expand(same)) - 4)
    assert before.items() <= times(folder).items()


@pytest.mark.parametrize(
    ("table", "changes"),
    [
        (SMALL, ("sliding.distance=300 um",)),
        (SMALL, ("run.seed=2",)),
        (SMALL, ("interface.calibration=paper",)),
        (SMALL, ("strength.mean=1 MPa",)),
        (SMALL.replace("[10, 20]", "[10, 30]"), ()),
    ],
)
def test_runs_of_another_scenario_are_refused_by_name_or_left(
    tmp_path: Path, folder: Path, table: str, changes: tuple[str, ...]
) -> None:
    other, before = small(tmp_path, *changes, table=table), times(folder)
    with pytest.raises(
        OutputRefused, match=r"holds the runs of another scenario, such as (runs/[0-9a-f]{16}\.h5)"
    ) as refused:
        rubnoise.sweep(other, folder, jobs=1)
    named = folder / str(refused.value).partition("such as ")[2].partition(";")[0]
    assert named.exists()
    assert str(refused.value).endswith("; force=True leaves them beside the runs of this one")
    assert times(folder) == before
    with rubnoise.sweep(other, folder, jobs=1, force=True) as swept:
        assert (swept.count("done"), len(swept.runs)) == (4, 4)
    assert before.items() <= times(folder).items()
    assert verify_sweep(folder).passed


def test_a_folder_of_other_things_is_refused_and_one_that_was_only_begun_is_not(tmp_path: Path) -> None:
    (root := tmp_path / "dir").mkdir()
    check_folder(root)
    (root / "thesis.tex").touch()
    with pytest.raises(OutputRefused, match="is not a sweep folder, and not empty; name another folder"):
        check_folder(root)
    with pytest.raises(OutputRefused, match=r"thesis.tex: is no folder"):
        check_folder(root / "thesis.tex" / "deep")
    (root / "runs").mkdir()
    check_folder(root)


@pytest.mark.parametrize("spoilt", ["gone", "cut short", "a bit turned", "older"])
def test_an_index_that_is_lost_or_stale_is_made_again_from_the_files(
    folder: Path, tmp_path: Path, spoilt: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    index = folder / "index.h5"
    with rubnoise.open_sweep(folder) as swept:
        right = {name: swept.runs[name][:].tolist() for name in swept.runs.names}
    if spoilt == "older":
        os.utime(index, (1e9, 1e9))
    elif spoilt == "gone":
        index.unlink()
    else:
        content = bytearray(index.read_bytes())
        at = content.index(np.array([right["real_contact_area_mean"][1]]).tobytes())
        content[at] ^= 1
        index.write_bytes(content if spoilt == "a bit turned" else content[:-3000])
    looked_at: list[Path] = []
    whole = sweep.found
    monkeypatch.setattr(sweep, "found", lambda point, path: (looked_at.append(path), whole(point, path))[1])
    assert made(lambda: rubnoise.sweep(small(tmp_path), folder, jobs=1).close(), monkeypatch) == 0
    assert len(looked_at) == 4
    with rubnoise.open_sweep(folder) as swept:
        assert {name: swept.runs[name][:].tolist() for name in swept.runs.names} == right
    rubnoise.sweep(small(tmp_path), folder, jobs=1).close()
    assert len(looked_at) == 4  # the index knows them now


def test_a_result_that_a_power_cut_spoilt_is_made_again(folder: Path, tmp_path: Path) -> None:
    with rubnoise.open_sweep(folder) as swept:
        names = swept.runs["run_id"][:].tolist()
    cut, turned = (folder / "runs" / f"{name}.h5" for name in names[:2])
    with rubnoise.open(turned) as run:
        at = turned.read_bytes().index(run.trace["real_contact_area"][3:15].tobytes())
    cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 2])
    data = bytearray(turned.read_bytes())
    data[at] ^= 1
    turned.write_bytes(data)
    assert not verify_sweep(folder).passed
    with rubnoise.sweep(small(tmp_path), folder, jobs=1) as swept:
        assert swept.failures == []
    assert verify_sweep(folder).passed


def test_the_result_of_another_run_stays_and_its_run_has_failed(folder: Path, tmp_path: Path) -> None:
    one, other, *_ = sorted((folder / "runs").iterdir())
    one.replace(other)
    with rubnoise.open_sweep(folder) as swept, pytest.raises(RunFileRefused, match="is the result of another run"):
        swept.run(other.stem)
    with rubnoise.sweep(small(tmp_path), folder, jobs=1) as again:
        assert (again.count("done"), [failure.run_id for failure in again.failures]) == (3, [other.stem])
        assert "is not the result of this run; move it away" in again.failures[0].reason
    other.unlink()
    with rubnoise.sweep(small(tmp_path), folder, jobs=1) as again:
        assert (again.count("done"), again.failures) == (4, [])


def test_a_run_that_another_process_is_making_is_left_to_it(folder: Path, tmp_path: Path) -> None:
    path = min((folder / "runs").iterdir())
    path.unlink()
    with being_made(path, tmp_path), rubnoise.sweep(small(tmp_path), folder, jobs=1) as swept:
        assert (swept.count("done"), swept.count("planned"), swept.failures) == (3, 1, [])
    with rubnoise.sweep(small(tmp_path), folder, jobs=1) as swept:
        assert swept.count("done") == 4


def test_a_disk_that_fails_makes_the_run_a_failed_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bad = file_of(tmp_path / "d", expand(small(tmp_path))[1].run_id, "runs")
    finish = PartFile.finish

    def failing(part: PartFile) -> None:
        if part.final == bad:
            raise OSError(EIO, "Input/output error")
        finish(part)

    monkeypatch.setattr(PartFile, "finish", failing)
    with rubnoise.sweep(small(tmp_path), tmp_path / "d", jobs=1) as swept:
        (failure,) = swept.failures
        assert (swept.count("done"), failure.run_id) == (3, bad.stem)
    assert failure.reason == f"{bad}: writing failed: input/output error"
    assert not bad.exists()


def test_the_index_is_written_on_the_way_and_after_a_stop(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rmtree(folder / "runs")
    (folder / "index.h5").unlink()
    monkeypatch.setattr(sweep, "EVERY", 0.0)
    monkeypatch.setattr(sweep, "SHARE", 1e9)
    seen: list[list[str]] = []

    def watch(progress: sweep.SweepProgress) -> None:
        if progress.done == 3:
            raise rubnoise.errors.RunStopped(2)
        if (folder / "index.h5").exists():
            with rubnoise.open_sweep(folder) as swept:
                seen.append(swept.runs["state"][:].tolist())

    with pytest.raises(sweep.SweepStopped, match="finished runs are kept"):
        sweep.carry_out(small(tmp_path), folder, jobs=1, watch=watch)
    assert ["done", "planned", "planned", "planned"] in seen
    with rubnoise.open_sweep(folder) as swept:
        assert swept.runs["state"][:].tolist() == ["done", "done", "done", "planned"]


# A run that keeps its summary alone.
def test_a_summary_lies_in_a_file_and_is_verified_by_being_made_again(tmp_path: Path) -> None:
    summed = small(tmp_path, "sweep.keep=summary")
    with rubnoise.sweep(summed, tmp_path / "d", jobs=1) as swept:
        assert swept.count("done") == 4
        spectrum = swept.summary("spectrum")
    paths = sorted((tmp_path / "d" / "runs").iterdir())
    assert [path.suffix for path in paths] == [".npz"] * 4
    assert verify_sweep(tmp_path / "d").passed
    point = expand(summed)[1]
    _, kept = read(file_of(tmp_path / "d", point.run_id, "summary"))
    assert np.array_equal(kept["spectrum"], spectrum[1], equal_nan=True)
    (tmp_path / "d" / "index.h5").unlink()
    with rubnoise.sweep(summed, tmp_path / "d", jobs=1) as again:
        assert np.array_equal(again.summary("spectrum"), spectrum, equal_nan=True)
    content = bytearray(paths[0].read_bytes())
    content[len(content) // 2] ^= 1
    paths[0].write_bytes(content)
    assert verify_sweep(tmp_path / "d").failing == ("index", "runs")
    assert found(next(p for p in expand(summed) if p.run_id == paths[0].stem), paths[0]) is None


# A part of a sweep.
def test_shards_are_parts_of_the_whole_whatever_the_order(tmp_path: Path) -> None:
    names = [point.run_id for point in expand(sweep_of(tmp_path, GRID))]
    parts = [in_shard(f"{n}/5", names) for n in range(1, 6)]
    assert sorted(name for part in parts for name in part) == sorted(names)
    assert {len(part) for part in parts} <= {2, 3}
    assert [in_shard(f"{n}/5", names[::-1]) for n in range(1, 6)] == parts


def test_shards_of_a_sweep_with_a_precision_make_whole_points(tmp_path: Path) -> None:
    table = SMALL.replace("replicates = 2", "precision = 0.5")
    for shard, done in (("2/2", 8), ("1/2", 16)):
        with rubnoise.sweep(small(tmp_path, table=table), tmp_path / "d", jobs=1, shard=shard) as swept:
            assert (swept.count("done"), len(swept.runs)) == (done, 16)
