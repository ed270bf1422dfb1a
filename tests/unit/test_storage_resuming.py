"""Whatever stops a run, at whatever moment: it resumes, and gives the same bits."""

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import h5py
import pytest

import rubnoise
from rubnoise.analysis.summary import summarise
from rubnoise.api import playing
from rubnoise.api.playing import describe, play
from rubnoise.errors import OutputRefused, Refused, RubnoiseError, RunFileRefused, RunStopped
from rubnoise.scenario import Scenario, build
from rubnoise.simulation import draws
from rubnoise.storage import disk, writer
from rubnoise.storage.journal import History, state_at
from rubnoise.storage.output import OutputPaths, sole_writer
from rubnoise.storage.reader import open_unfinished
from rubnoise.storage.resume import look
from rubnoise.storage.writer import RunWriter
from tests.format.runs import names
from tests.verification.scores import seed_of
from tools.survival.recording import Recording

SLIDER = {
    "strength": {"mean": "250 MPa"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
}


def scenario(*, slider: bool = True, **sections: dict[str, object]) -> Scenario:
    """Return a scenario of five blocks, each played by itself."""
    keys: dict[str, object] = {
        "format": 1,
        "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
        "sliding": {"distance": "2400 um", "speed": "1 mm/s"},
        "output": {"tick": "2 um"},
        "run": {"engine": "events"},
    }
    return build(keys | (SLIDER if slider else {}) | sections)


BARE = scenario(slider=False)
WHOLE = scenario()
GZIP = scenario(slider=False, output={"tick": "2 um", "compression": "gzip"})
LONG = {"sliding": {"distance": "16 mm", "speed": "1 mm/s"}, "output": {"tick": "5 um"}}
"""Changes that make so many blocks that they would not all be played together either."""


@pytest.fixture(autouse=True)
def commit_every_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 0.0)
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)


def datasets(path: Path) -> dict[str, tuple[bytes, bytes]]:
    """Return every dataset of a file, and its hash."""
    with h5py.File(path, "r") as file:
        return {
            f"{group}/{name}": (dataset[:].tobytes(), bytes(dataset.attrs["xxh3_128"]))
            for group in file
            for name, dataset in file[group].items()
        }


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, tuple[bytes, bytes]]]:
    """Return the datasets of runs that nothing stopped."""
    folder, found = tmp_path_factory.mktemp("whole"), {}
    for name, each in (("bare", BARE), ("whole", WHOLE), ("long", scenario(**LONG))):
        rubnoise.run(each, folder / f"{name}.h5").close()
        found[name] = datasets(folder / f"{name}.h5")
    return found


def stop_after(path: Path, run: Scenario, blocks: int, number: int = 2) -> str:
    """Run until a signal comes in the block after so many; return what is said of it."""
    file = RunWriter(path, describe(run, path, ["test"]))

    def watch(distance: float, junctions: int, live: int) -> None:
        if (file.state.block if file.state else 0) >= blocks:
            raise RunStopped(number)

    with pytest.raises(RunStopped) as stopped, file:
        play(file, run, watch=watch)
    return str(stopped.value)


@pytest.mark.parametrize("blocks", [1, 9, 17])
@pytest.mark.parametrize(("begun", "gone_on"), [("batch", "events"), ("events", "batch")])
def test_a_run_stopped_in_any_block_goes_on_by_either_engine(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]], blocks: int, begun: str, gone_on: str
) -> None:
    path = tmp_path / "x.h5"
    said = stop_after(path, scenario(**LONG, run={"engine": begun}), blocks)
    assert said == f"stopped by a signal; rubnoise resume {path}.part continues it"
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal"]
    assert 0.02 * blocks < look(f"{path}.part").share < 1.0
    rubnoise.run(scenario(**LONG, run={"engine": gone_on}), path).close()
    assert datasets(path) == expected["long"]
    assert names(tmp_path) == ["x.h5"]


def test_a_run_stopped_twice_goes_on_twice(tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]]) -> None:
    path, seen = tmp_path / "x.h5", []
    stop_after(path, WHOLE, 1)

    def watch(distance: float, junctions: int, live: int) -> None:
        seen.append(distance)
        if len(seen) == 3:
            raise RunStopped(15)

    with pytest.raises(RunStopped, match="resume"):
        rubnoise.resume(f"{path}.part", watch=watch)
    assert 0.0 < seen[0] < seen[1]
    rubnoise.resume(f"{path}.part").close()
    assert datasets(path) == expected["whole"]


def test_before_the_first_block_there_is_nothing_to_keep(tmp_path: Path) -> None:
    assert stop_after(tmp_path / "x.h5", WHOLE, 0) == "stopped by a signal; nothing was kept"
    assert names(tmp_path) == []


def test_the_summary_is_that_of_the_whole_run(tmp_path: Path) -> None:
    stop_after(tmp_path / "x.h5", WHOLE, 2)
    with rubnoise.resume(tmp_path / "x.h5.part") as resumed, rubnoise.run(WHOLE, tmp_path / "y.h5") as whole:
        for one, other in zip(resumed.summary, whole.summary, strict=True):
            assert one.name == other.name
            assert one.observed == pytest.approx(other.observed, rel=1e-12)


def test_a_run_is_stopped_while_it_is_compressed_and_goes_on(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]]
) -> None:
    told = []

    def watch(distance: float, junctions: int, live: int) -> None:
        told.append(distance)
        if told.count(2400.0) == 4:  # the last panel, theory, and two chunks
            raise RunStopped(2)

    path = tmp_path / "x.h5"
    with pytest.raises(RunStopped, match="continues it"):
        rubnoise.run(GZIP, path, watch=watch)
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal"]
    rubnoise.run(GZIP, path).close()
    assert datasets(path) == expected["bare"]


def test_a_run_that_was_to_stop_during_its_theory_is_not_published_and_goes_on(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    signals = []

    def slow(*given: Any) -> Any:
        signals.append(2)
        return summarise(*given)

    def watch(distance: float, junctions: int, live: int) -> None:
        if signals:
            raise RunStopped(signals[0])

    path = tmp_path / "x.h5"
    with monkeypatch.context() as patched:
        patched.setattr(playing, "summarise", slow)
        with pytest.raises(RunStopped, match="continues it"):
            rubnoise.run(WHOLE, path, watch=watch)
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal"]
    rubnoise.run(WHOLE, path).close()
    assert datasets(path) == expected["whole"]


@contextmanager
def recorded(folder: Path, run: Scenario) -> Iterator[Recording]:
    """Record a run into a folder."""
    folder.mkdir()
    recording = Recording(folder)
    with recording.recording():
        rubnoise.run(run, folder / "x.h5").close()
    yield recording


def gone_on(folder: Path, run: Scenario) -> dict[str, tuple[bytes, bytes]]:
    """Resume the run in a folder, and return the datasets of its result."""
    path = folder / "x.h5"
    if (folder / "x.h5.part").exists():
        rubnoise.resume(f"{path}.part").close()
    elif not path.exists():
        rubnoise.run(run, path).close()
    assert names(folder) == ["x.h5"]
    return datasets(path)


@pytest.mark.parametrize("run", [BARE, GZIP], ids=["none", "gzip"])
def test_killed_between_any_two_writes_it_goes_on(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]], run: Scenario
) -> None:
    with recorded(tmp_path / "run", run) as recording:
        assert len(recording.moments) > 100
        # All moments around the beginning and the end, and some between: tools/survival goes through them all.
        some = {*recording.moments[:12], *recording.moments[12:-20:25], *recording.moments[-20:]}
        for moment in sorted(some):
            (tmp_path / f"{moment}").mkdir()
            recording.after_kill(tmp_path / f"{moment}", moment)
            assert gone_on(tmp_path / f"{moment}", run) == expected["bare"], moment


def test_after_a_power_cut_what_was_committed_is_there(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]]
) -> None:
    random = Random(seed_of("power cut"))  # noqa: S311  (chance, no secret)
    with recorded(tmp_path / "run", BARE) as recording:
        first = next(n for n, call in enumerate(recording.calls) if call[0] == "sync_folder")
        for turn in range(20):
            moment = random.randint(first + 1, len(recording.calls))
            committed = sum(call[0] == "sync" for call in recording.calls[:moment]) - 1  # and the part was made
            folder = tmp_path / f"{turn}"
            folder.mkdir()
            recording.after_power_cut(folder, moment, random)
            if (folder / "x.h5.part.journal").exists() and (folder / "x.h5.part").exists():
                assert len(History.read(folder / "x.h5.part.journal").commits) >= min(committed, 4)
            assert gone_on(folder, BARE) == expected["bare"], moment


def test_a_commit_is_written_down_when_the_disk_has_its_rows(tmp_path: Path) -> None:
    with recorded(tmp_path / "run", BARE) as recording:
        calls = recording.calls
    journal = calls.index(("create", "x.h5.part.journal"))
    part = next(number for number, call in enumerate(calls) if call[0] == "create" and number != journal)
    waiting, commits = False, 0
    for name, file, *given in calls:
        if file == part:
            waiting = name not in {"sync", "sync_rows"}
        elif file == journal and name == "write_all" and given[0][4:8] == b"rows":
            commits += 1
            assert not waiting, f"commit {commits} came before its rows"
    assert commits >= 4


def test_rows_lost_behind_a_commit_send_it_back_to_an_earlier_one(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]]
) -> None:
    path = tmp_path / "x.h5"
    stop_after(path, WHOLE, 4)
    paths = OutputPaths.of(path)
    states = [state_at(paths.journal, commit) for commit in History.read(paths.journal).commits]
    with open_unfinished(paths.part) as part:
        assert part.rows("slider") > states[2].ticks > states[1].ticks
    with h5py.File(paths.part, "r") as file:
        offset = file["slider/velocity"].id.get_offset()
    with paths.part.open("r+b") as disk_file:
        disk_file.seek(offset + 8 * (states[1].ticks + 3))
        disk_file.write(b"\0" * 4096)
    reached: list[float] = []
    rubnoise.resume(paths.part, watch=lambda distance, junctions, live: reached.append(distance)).close()
    assert reached[0] == (states[1].ticks - 1) * 2.0
    assert datasets(path) == expected["whole"]


def test_without_its_journal_a_part_begins_at_the_start(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]]
) -> None:
    stop_after(tmp_path / "x.h5", WHOLE, 3)
    (tmp_path / "x.h5.part.journal").unlink()
    assert look(tmp_path / "x.h5.part").share == 0.0
    reached: list[float] = []
    rubnoise.resume(tmp_path / "x.h5.part", watch=lambda *told: reached.append(told[0])).close()
    assert reached[0] == 0.0
    assert datasets(tmp_path / "x.h5") == expected["whole"]


def test_a_journal_of_another_run_is_left_out_of_account(
    tmp_path: Path, expected: dict[str, dict[str, tuple[bytes, bytes]]]
) -> None:
    stop_after(tmp_path / "x.h5", WHOLE, 1)
    stop_after(tmp_path / "y.h5", scenario(run={"seed": 2}), 4)
    shutil.copy(tmp_path / "y.h5.part.journal", tmp_path / "x.h5.part.journal")
    assert look(tmp_path / "x.h5.part").share == 0.0
    rubnoise.resume(tmp_path / "x.h5.part").close()
    assert datasets(tmp_path / "x.h5") == expected["whole"]


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (scenario(run={"seed": 2}), "run.seed is 1 there and 2 here"),
        (scenario(sliding={"distance": "3 mm", "speed": "1 mm/s"}), '"2400 um" there and "3000 um" here'),
        (scenario(slider=False, strength={"mean": "250 MPa"}), "slider.mass is .* there and absent here; .*; ..."),
        (scenario(output={"tick": "2 um", "compression": "gzip"}), 'output.compression is "none" there and "gzip"'),
    ],
)
def test_another_run_is_refused_with_the_difference(tmp_path: Path, other: Scenario, said: str) -> None:
    path = tmp_path / "x.h5"
    stop_after(path, WHOLE, 2)
    before = (tmp_path / "x.h5.part").read_bytes()
    with pytest.raises(OutputRefused, match=said) as refused:
        rubnoise.run(other, path)
    assert "(force=True starts over; rubnoise resume" in str(refused.value)
    assert refused.value.exit_code == 2
    assert (tmp_path / "x.h5.part").read_bytes() == before
    rubnoise.run(other, path, force=True).close()
    assert names(tmp_path) == ["x.h5"]
    with rubnoise.open(path) as run:
        assert run.scenario.resolved() == other.resolved()


def test_other_random_numbers_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stop_after(tmp_path / "x.h5", WHOLE, 2)
    monkeypatch.setattr("rubnoise.api.resuming.STREAM_VERSION", 2)
    for go_on in (lambda: rubnoise.resume(tmp_path / "x.h5.part"), lambda: rubnoise.run(WHOLE, tmp_path / "x.h5")):
        with pytest.raises(Refused, match=r"stream version 1, and here they are of 2; rubnoise \S+ can resume it"):
            go_on()
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal"]


def test_an_older_result_is_replaced_only_by_force(tmp_path: Path) -> None:
    stop_after(tmp_path / "x.h5", WHOLE, 2)
    (tmp_path / "x.h5").write_bytes(b"precious")
    with pytest.raises(OutputRefused, match="exists already"):
        rubnoise.resume(tmp_path / "x.h5.part")
    assert (tmp_path / "x.h5").read_bytes() == b"precious"
    rubnoise.resume(tmp_path / "x.h5.part", force=True).close()
    assert names(tmp_path) == ["x.h5"]


def test_a_run_that_is_being_written_is_looked_at_and_not_resumed(tmp_path: Path) -> None:
    path = tmp_path / "x.h5"
    stop_after(path, WHOLE, 2)
    with sole_writer(OutputPaths.of(path)):
        for _ in range(20):
            found = look(f"{path}.part")
        with pytest.raises(OutputRefused, match="another process is writing it"):
            rubnoise.resume(f"{path}.part")
    assert found.being_written
    assert not look(f"{path}.part").being_written


@pytest.mark.parametrize("name", ["x.h5", "y.h5.part", ".part"])
def test_what_is_no_part_is_refused(tmp_path: Path, name: str) -> None:
    rubnoise.run(BARE, tmp_path / "x.h5").close()
    with pytest.raises(RunFileRefused, match=r"names end in \.part|no such file"):
        rubnoise.resume(tmp_path / name)


def test_a_part_that_cannot_be_read_is_refused_until_force(tmp_path: Path) -> None:
    (tmp_path / "x.h5.part").write_bytes(b"something else")
    with pytest.raises(RunFileRefused, match="not an HDF5 file"):
        rubnoise.resume(tmp_path / "x.h5.part")
    with pytest.raises(OutputRefused, match=r"not an HDF5 file.*\(force=True starts over\)"):
        rubnoise.run(BARE, tmp_path / "x.h5")
    rubnoise.run(BARE, tmp_path / "x.h5", force=True).close()
    assert names(tmp_path) == ["x.h5"]


def failing(call: str, after: int) -> object:
    """Return a call of the disk that fails for ever after so many times."""
    real, times = getattr(disk, call), [0]

    def called(*given: object) -> object:
        times[0] += 1
        if times[0] > after:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(*given)

    return called


@pytest.mark.parametrize(("call", "after"), [("write_all", 60), ("sync_rows", 2), ("sync", 3)])
def test_a_disk_that_fails_after_a_commit_leaves_something_to_go_on_with(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    expected: dict[str, dict[str, tuple[bytes, bytes]]],
    call: str,
    after: int,
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(disk, call, failing(call, after))
        with pytest.raises(RubnoiseError, match=r"x\.h5: .*No space left on device; after you fix this, rubno"):
            rubnoise.run(BARE, tmp_path / "x.h5")
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal"]
    rubnoise.run(BARE, tmp_path / "x.h5").close()
    assert datasets(tmp_path / "x.h5") == expected["bare"]


def test_a_disk_that_fails_before_the_first_commit_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "sync_rows", failing("sync_rows", 0))
    with pytest.raises(RubnoiseError, match=r"x\.h5: writing failed: No space left on device$"):
        rubnoise.run(BARE, tmp_path / "x.h5")
    assert names(tmp_path) == []


def test_a_short_run_makes_no_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 1e9)
    with recorded(tmp_path / "run", BARE) as recording:
        pass
    # The part when it is made, its last changes in the journal, and in itself.
    assert [call[0] for call in recording.calls].count("sync") == 3
    assert "sync_rows" not in {call[0] for call in recording.calls}


def test_without_safety_there_is_neither_journal_nor_hash(tmp_path: Path) -> None:
    path = tmp_path / "x.h5"
    recording = Recording(tmp_path)
    with recording.recording(), RunWriter(path, describe(BARE, path, ["test"]), safe=False) as file:
        play(file, replace(BARE, text=""))
    assert "x.h5.part.journal" not in {call[1] for call in recording.calls}
    assert {digest for _, digest in datasets(path).values()} == {b"0" * 32}
