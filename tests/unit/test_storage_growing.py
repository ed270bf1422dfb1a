"""Rows of which only the end of a run tells how many there are: stopped anywhere, they come back bit for bit."""

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from random import Random

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.verification import verify
from rubnoise.errors import OutputRefused, RubnoiseError, RunFileRefused, RunStopped
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.sink import Appender, Extent, Sink
from rubnoise.scenario import build
from rubnoise.simulation import draws
from rubnoise.simulation.state import LiveRows, State
from rubnoise.storage import disk, growing, writer
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.journal import Ending, History
from rubnoise.storage.layout import ByteRange, RunDescription
from rubnoise.storage.output import OutputPaths, sole_writer
from rubnoise.storage.reader import open_run, open_unfinished
from rubnoise.storage.resume import look, publish_complete
from rubnoise.storage.sync_many import clear_unsynced
from rubnoise.storage.writer import RunWriter
from tests.format.runs import Compression, Rows, describe, names, random_rows
from tests.verification.scores import seed_of
from tools.survival.recording import Recording

BLOCKS = 6
COUNTS = (40, 300, 0, 7, 211, 90)
"""Rows of /slider that come in each block, some steps of them; of the other groups there are as many in each."""

ROWS = random_rows(describe(5 * BLOCKS, 8 * BLOCKS, BLOCKS, sum(COUNTS)))
START = State(
    block=0,
    begin=0.0,
    next_birth=0.0,
    junctions=0,
    ticks=0,
    events=0,
    live=LiveRows.none(),
    slider_rows=0,
    displacement=0.0,
    velocity=0.0,
)


@pytest.fixture(autouse=True)
def small_steps_and_a_commit_every_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growing, "STEP_BYTES", 4096)
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 0.0)


def description_of(compression: Compression = "none") -> RunDescription:
    description = describe(5 * BLOCKS, 8 * BLOCKS, BLOCKS, None, compression=compression)
    return replace(description, scenario_resolved={"run": {"seed": 1}, "output": {"compression": compression}})


def play(sink: Sink, state: State, commit: Callable[[State], None]) -> None:
    """Hand the rows to a sink, block by block, /slider's in two panels of different lengths."""
    slider = Appender(sink, "slider", state.slider_rows)
    for block in range(state.block, BLOCKS):
        for group, size in (("junctions", 5), ("trace", 8), ("blocks", 1)):
            sink.write(group, size * block, part(ROWS, group, size * block, size * (block + 1)))
        first, count = slider.rows, COUNTS[block]
        for begin, end in ((first, first + count // 3), (first + count // 3, first + count)):
            slider.append(part(ROWS, "slider", begin, end))
        junctions, ticks = 5 * (block + 1), 8 * (block + 1)
        commit(replace(START, block=block + 1, junctions=junctions, ticks=ticks, slider_rows=slider.rows))


def part(rows: Rows, group: str, first: int, end: int) -> dict[str, np.ndarray]:
    return {name: values[first:end] for name, values in rows[group].items()}


def make(path: Path, description: RunDescription | None, *, force: bool = False) -> None:
    """Make a run, or without a description resume the one that is there."""
    with RunWriter(path, description, force=force) as file:
        play(file, file.state or START, file.commit)
        file.publish({"area_mean": 204.6736})


def assert_whole(path: Path) -> None:
    """Compare every row with what was written, and every hash."""
    with open_run(path) as run:
        assert run.extent == Extent(junctions=5 * BLOCKS, ticks=8 * BLOCKS, blocks=BLOCKS, slider=sum(COUNTS))
        assert run.damaged() == ()
        for group, columns in ROWS.items():
            for name, values in columns.items():
                assert run.column(group, name).tobytes() == values.tobytes(), f"/{group}/{name}"
    with h5py.File(path, "r") as file:
        assert list(file["slider"]) == ["time", "distance", "friction_force", "displacement", "velocity"]
        assert file["slider/velocity"].dims[0][0].name == "/slider/time"


def gone_on(folder: Path, description: RunDescription) -> None:
    """Resume the run in a folder, and look at the result."""
    path = folder / "x.h5"
    paths = OutputPaths.of(path)
    if paths.part.exists():
        with sole_writer(paths):
            whole = publish_complete(paths, lambda _: None, force=False)
        if not whole:
            make(path, None)
    elif not path.exists():
        make(path, description)
    assert names(folder) == ["x.h5"]
    assert_whole(path)


@contextmanager
def recorded(folder: Path, compression: Compression = "none") -> Iterator[Recording]:
    """Record a run into a folder."""
    folder.mkdir()
    recording = Recording(folder)
    with recording.recording():
        make(folder / "x.h5", description_of(compression))
    yield recording


def stopped_after(path: Path, blocks: int) -> str:
    """Make a run until a signal comes after so many blocks; return what is said of it."""

    def stopping(state: State) -> None:
        file.commit(state)
        if state.block == blocks:
            raise RunStopped(2)

    with pytest.raises(RunStopped) as stopped, RunWriter(path, description_of()) as file:
        play(file, START, stopping)
    return str(stopped.value)


@pytest.mark.parametrize("compression", ["none", "gzip"])
@pytest.mark.parametrize("seconds", [0.0, 1e9])
def test_rows_that_grow_end_in_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: Compression, seconds: float
) -> None:
    monkeypatch.setattr(writer, "COMMIT_SECONDS", seconds)
    make(tmp_path / "x.h5", description_of(compression))
    assert names(tmp_path) == ["x.h5"]
    assert_whole(tmp_path / "x.h5")


def test_a_run_without_a_row_that_grows_is_whole(tmp_path: Path) -> None:
    rows = random_rows(describe(4, 3, 1, 0))
    with RunWriter(tmp_path / "x.h5", describe(4, 3, 1, None)) as file:
        for group, columns in rows.items():
            file.write(group, 0, columns)
        file.publish({})
    with open_run(tmp_path / "x.h5") as run:
        assert run.rows("slider") == 0
        assert run.damaged() == ()


def test_before_the_end_the_rows_lie_beside_the_part(tmp_path: Path) -> None:
    said = stopped_after(tmp_path / "x.h5", 3)
    assert said == f"stopped by a signal; rubnoise resume {tmp_path}/x.h5.part continues it"
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal", "x.h5.part.rows"]
    assert (tmp_path / "x.h5.part.rows").stat().st_size % growing.STEP_BYTES == 0
    found = look(tmp_path / "x.h5.part")
    assert (found.ticks, found.grown) == (24, {"slider": 340})
    with open_unfinished(tmp_path / "x.h5.part") as run:
        assert run.rows("slider") == 0
        assert run.extent.slider is None
    gone_on(tmp_path, description_of())


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_killed_between_any_two_calls_or_within_one_it_goes_on(tmp_path: Path, compression: Compression) -> None:
    with recorded(tmp_path / "run", compression) as recording:
        assert len(recording.moments) > 150
        # All moments around the end, and some between: tools/survive.py goes through them all.
        last, apart = (24, 30) if compression == "none" else (10, 60)
        ends = recording.moments[-last:]
        for moment in (*recording.moments[:-last:apart], *ends):
            writes = moment < len(recording.calls) and recording.calls[moment][0] == "write_all"
            for torn in (False, True)[: 1 + (writes and moment in ends)]:
                folder = tmp_path / f"{moment}{torn}"
                folder.mkdir()
                recording.after_kill(folder, moment, torn=torn)
                gone_on(folder, description_of(compression))


def test_after_a_power_cut_the_growing_rows_that_were_committed_are_there(tmp_path: Path) -> None:
    random = Random(seed_of("power cut of growing rows"))  # noqa: S311  (chance, no secret)
    with recorded(tmp_path / "run") as recording:
        calls = recording.calls
        journal = calls.index(("create", "x.h5.part.journal"))
        first = next(n for n, call in enumerate(calls) if call[0] == "sync_folder" and n > journal)
        for turn in range(20):
            moment = random.randint(first + 1, len(calls))
            committed = sum(call[:2] == ("sync", journal) for call in calls[:moment])
            folder = tmp_path / f"{turn}"
            folder.mkdir()
            recording.after_power_cut(folder, moment, random)
            # A name that was removed may be there still, and one that was removed with it gone.
            for left in ("x.h5.part.journal", "x.h5.part.rows"):
                if not (folder / "x.h5.part").exists() and (folder / left).exists():
                    (folder / left).unlink()
            paths = OutputPaths.of(folder / "x.h5")
            if paths.part.exists() and paths.journal.exists() and paths.growing.exists() and committed <= BLOCKS:
                with RunWriter(paths.final, None, force=True) as file:
                    assert file.state is not None
                    assert file.state.block >= committed
            gone_on(folder, description_of())


def test_growing_rows_that_never_reach_the_disk_are_missed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(GrowingFile, "sync", lambda _: None)
    with pytest.raises(AssertionError):
        test_after_a_power_cut_the_growing_rows_that_were_committed_are_there(tmp_path)


def test_a_commit_is_written_down_when_the_disk_has_its_growing_rows(tmp_path: Path) -> None:
    with recorded(tmp_path / "run") as recording:
        calls = recording.calls
    journal, rows = calls.index(("create", "x.h5.part.journal")), calls.index(("create", "x.h5.part.rows"))
    waiting, commits = False, 0
    for name, file, *given in calls:
        if file == rows:
            waiting = name not in {"sync", "sync_rows"}
        elif file == journal and name == "write_all" and given[0][4:8] in {b"rows", b"end "}:
            commits += 1
            assert not waiting, f"record {commits} came before its rows"
    assert commits >= BLOCKS


def test_growing_rows_lost_behind_a_commit_send_it_back_to_an_earlier_one(tmp_path: Path) -> None:
    stopped_after(tmp_path / "x.h5", 5)
    paths = OutputPaths.of(tmp_path / "x.h5")
    with paths.growing.open("r+b") as file:
        file.truncate(4 * growing.STEP_BYTES)  # of 102 rows each, so that 300 rows and 7 are there
    with RunWriter(paths.final, None) as again:
        assert again.state is not None
        assert (again.state.block, again.state.slider_rows) == (4, 347)
    gone_on(tmp_path, description_of())


@pytest.mark.parametrize("gone", ["x.h5.part.rows", "x.h5.part.journal"])
def test_without_its_rows_or_its_journal_a_part_begins_at_the_start(tmp_path: Path, gone: str) -> None:
    stopped_after(tmp_path / "x.h5", 5)
    (tmp_path / gone).unlink()
    with RunWriter(tmp_path / "x.h5", None) as again:
        assert again.state is None
    gone_on(tmp_path, description_of())


@pytest.mark.parametrize("garbage", [b"", b"rng1", b"rng1\xff\0\0\0" + bytes(5000), bytes(20_000), b"x" * 20_000])
def test_a_file_of_rows_that_is_none_counts_as_without(tmp_path: Path, garbage: bytes) -> None:
    stopped_after(tmp_path / "x.h5", 5)
    (tmp_path / "x.h5.part.rows").write_bytes(garbage)
    gone_on(tmp_path, description_of())


def failing(call: str, after: int, suffix: str = ".rows") -> Callable[..., object]:
    """Return a call of the disk that fails for ever after so many times for the file of rows."""
    real, times = getattr(disk, call), [0]

    def called(descriptor: int, *given: object) -> object:
        times[0] += str(Path(f"/proc/self/fd/{descriptor}").readlink()).endswith(suffix)
        if times[0] > after:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(descriptor, *given)

    return called


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks Linux for the name of an open file")
@pytest.mark.parametrize(("call", "after"), [("allocate", 3), ("write_all", 9), ("sync_rows", 2)])
def test_a_disk_that_fills_up_in_the_middle_leaves_something_to_go_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str, after: int
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(disk, call, failing(call, after))
        with pytest.raises(RubnoiseError, match=r"x\.h5: .*No space left on device; after you fix this, rubno"):
            make(tmp_path / "x.h5", description_of())
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal", "x.h5.part.rows"]
    gone_on(tmp_path, description_of())


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks Linux for the name of an open file")
@pytest.mark.parametrize("call", ["allocate", "write_all"])
def test_a_disk_that_fills_up_while_rows_are_copied_in_leaves_all_of_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    path = tmp_path / "x.h5"
    with RunWriter(path, description_of()) as file, monkeypatch.context() as patch:
        play(file, START, file.commit)
        patch.setattr(disk, call, failing(call, 0 if call == "allocate" else 3, suffix=".h5.part"))
        with pytest.raises(RubnoiseError, match=r"No space left on device; after you fix this, rubno"):
            file.publish({})
        with pytest.raises(RunFileRefused, match="no space left on device"):
            publish_complete(OutputPaths.of(path), lambda _: None, force=False)
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal", "x.h5.part.rows"]
    gone_on(tmp_path, description_of())


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks Linux for the name of an open file")
def test_a_run_that_fails_before_its_first_commit_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "allocate", failing("allocate", 2))
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 1e9)
    with pytest.raises(RubnoiseError, match="writing failed: No space left"):
        make(tmp_path / "x.h5", description_of())
    assert names(tmp_path) == []


def test_force_starts_over_and_removes_the_rows_of_before(tmp_path: Path) -> None:
    stopped_after(tmp_path / "x.h5", 5)
    with pytest.raises(OutputRefused, match="running or stopped run"):
        make(tmp_path / "x.h5", description_of())
    fixed = describe(2, 3)
    with RunWriter(tmp_path / "x.h5", fixed, force=True) as file:
        assert not (tmp_path / "x.h5.part.rows").exists()
        for group, columns in random_rows(fixed).items():
            file.write(group, 0, columns)
        file.publish({})
    assert names(tmp_path) == ["x.h5"]


def test_what_nothing_can_be_made_of_is_cleared_with_its_rows(tmp_path: Path) -> None:
    stopped_after(tmp_path / "x.h5", 2)
    (tmp_path / "x.h5.part").unlink()
    clear_unsynced(tmp_path / "x.h5", None)
    assert names(tmp_path) == []


def test_rows_are_no_link_to_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "precious").write_bytes(b"of somebody")
    (tmp_path / "x.h5.part.rows").symlink_to(tmp_path / "precious")
    with pytest.raises(OutputRefused, match=r"x\.h5\.part\.rows: exists and is not a regular file"):
        make(tmp_path / "x.h5", description_of())
    assert (tmp_path / "precious").read_bytes() == b"of somebody"


def test_a_part_that_was_whole_and_is_damaged_is_made_again(tmp_path: Path) -> None:
    """Its rows lie in it by then, so that it goes on as one whose rows were known before."""
    with recorded(tmp_path / "run") as recording:
        moment = next(n for n, call in enumerate(recording.calls) if call == ("remove", "x.h5.part.rows"))
        for kept in (0, 1, 2):
            folder = tmp_path / f"{kept}"
            folder.mkdir()
            recording.after_kill(folder, moment + kept)
            with open_unfinished(folder / "x.h5.part") as run:
                place = run.stored["slider"]["velocity"].offset
            with (folder / "x.h5.part").open("r+b") as file:
                file.seek(place + 800)
                file.write(b"\xff")
            (folder / "x.h5.part.rows").unlink(missing_ok=True)
            gone_on(folder, description_of())


def test_commits_are_those_of_the_growing_rows(tmp_path: Path) -> None:
    stopped_after(tmp_path / "x.h5", 5)
    commits = History.read(tmp_path / "x.h5.part.journal").commits
    grown = [commit.marks["slider", "velocity"].rows for commit in commits]
    assert grown[:5] == np.cumsum(COUNTS)[:5].tolist()


def test_an_ending_remembers_where_rows_go() -> None:
    grown = ((("slider", "time"), ByteRange(offset=4096, rows=655, dtype="<f8")),)
    ending = Ending(((0, b"head"), (9000, b"tail")), 9004, grown)
    assert Ending.unpacked(ending.packed()) == ending
    assert ending.grown_groups == {"slider": ["time"]}
    without = Ending(ending.pieces, ending.size)
    assert Ending.unpacked(without.packed()) == without
    assert ending.packed().startswith(without.packed())


@pytest.mark.parametrize(
    "told",
    [
        b"\xff",
        b"{}x",
        b'[["slider", "time", "much", 3]]',
        b'[["slider", "mass", 1, 3]]',
        b'[["slider", "time", []]]',
        b"7",
    ],
)
def test_an_ending_that_tells_nonsense_is_refused(told: bytes) -> None:
    with pytest.raises((ValueError, KeyError, TypeError)):
        Ending.unpacked(Ending((), 0).packed() + told)


def test_rows_of_a_hostile_ending_are_not_copied(tmp_path: Path) -> None:
    file = GrowingFile.new(tmp_path / "rows", {"slider": ["time", "velocity"]})
    for rows in (1, 2**70, -3):
        file.copy(("slider", "time"), ByteRange(offset=0, rows=rows, dtype="<f8"), -1)  # which no call could write to
    file.close()


def test_a_record_in_memory_grows(tmp_path: Path) -> None:
    record = MemoryRecord(description_of().extent)
    play(record, START, lambda _: None)
    for group, columns in ROWS.items():
        for name, values in columns.items():
            assert record[group][name].tobytes() == values.tobytes()


def test_a_simulated_run_is_the_same_whether_its_slider_grows_or_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The seam as a model meets it: uncounted rows, stopped, resumed, verified."""
    keys = {
        "format": 1,
        "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
        "strength": {"mean": "250 MPa"},
        "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
        "sliding": {"distance": "16 mm", "speed": "1 mm/s"},
        "output": {"tick": "5 um"},
    }
    run = build(keys)
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)
    rubnoise.run(run, tmp_path / "fixed.h5").close()
    monkeypatch.setattr(Model, "slider_rows", None)
    told = []

    def watch(*reached: float) -> None:
        told.append(reached)
        if len(told) == 12:
            raise RunStopped(2)

    with pytest.raises(RunStopped):
        rubnoise.run(run, tmp_path / "x.h5", watch=watch)
    assert 0 < look(tmp_path / "x.h5.part").grown["slider"] < 3201
    rubnoise.resume(tmp_path / "x.h5.part").close()
    with open_run(tmp_path / "x.h5") as one, open_run(tmp_path / "fixed.h5") as other:
        assert one.extent == other.extent
        for group, columns in one.columns.items():
            for name in columns:
                assert one.column(group, name).tobytes() == other.column(group, name).tobytes()
        assert verify(one).different == []
    record = rubnoise.simulate(run)
    assert len(record.slider) == 3201
