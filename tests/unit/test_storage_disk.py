"""A system that reads or writes less than it was asked for, as it may, changes no byte of what is read or written."""

import errno
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.errors import RubnoiseError, RunStopped
from rubnoise.simulation import draws
from rubnoise.storage import disk, writer
from rubnoise.storage.reader import open_run
from rubnoise.sweep.journal import Entry, Journal, entries
from tests.format.runs import Compression, attempt, describe, names, random_rows, write_run

CONTENT = bytes(range(256)) * 40
SCENARIO = {
    "format": 1,
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "sliding": {"distance": 300.0, "speed": 1000.0},
    "strength": {"mean": 250.0},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
    "output": {"tick": 1.0},
}

Shorten = Callable[[int], int]


def one_less(size: int) -> int:
    return max(size - 1, 1)


def half(size: int) -> int:
    return max(size // 2, 1)


@pytest.fixture(params=[one_less, half])
def short(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Shorten:
    """Let every call of the system read and write less than it was asked for."""
    less: Shorten = request.param
    pread, preadv, pwrite, write = os.pread, os.preadv, os.pwrite, os.write

    def short_preadv(descriptor: int, targets: Sequence[Any], offset: int) -> int:
        view = memoryview(targets[0]).cast("B")
        return preadv(descriptor, [view[: less(len(view))]], offset)

    monkeypatch.setattr(os, "pread", lambda descriptor, size, offset: pread(descriptor, less(size), offset))
    monkeypatch.setattr(os, "preadv", short_preadv)
    monkeypatch.setattr(os, "pwrite", lambda descriptor, data, at: pwrite(descriptor, data[: less(len(data))], at))
    monkeypatch.setattr(os, "write", lambda descriptor, data: write(descriptor, data[: less(len(data))]))
    return less


def test_all_is_read_and_written(tmp_path: Path, short: Shorten) -> None:
    with (tmp_path / "file").open("w+b") as file:
        disk.write_all(file.fileno(), memoryview(CONTENT), 3)
        assert disk.read(file.fileno(), len(CONTENT), 3) == CONTENT
        assert disk.read(file.fileno(), 10**5, 3) == CONTENT
        assert disk.read(file.fileno(), 10, 10**5) == b""
        disk.append_all(file.fileno(), memoryview(b"0123456789"))
        assert disk.read(file.fileno(), 13, 0) == b"0123456789" + CONTENT[7:10]


@pytest.mark.parametrize("compression", ["none", "gzip"])
def test_a_result_is_the_same_file(tmp_path: Path, short: Shorten, compression: Compression) -> None:
    description = describe(700, 900, compression=compression)
    write_run(tmp_path / "short.h5", description, random_rows(description), borders=(3, 500))
    with open_run(tmp_path / "short.h5") as run:
        assert run.damaged() == ()
        assert run.attributes["title"] == description.title
        rows = random_rows(description)
        assert all(
            run.column(group, name).tobytes() == values.tobytes()
            for group, columns in rows.items()
            for name, values in columns.items()
        )


def test_a_run_that_was_stopped_goes_on_to_the_same_bits(
    tmp_path: Path, short: Shorten, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 0.0)
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)
    scenario = rubnoise.build(SCENARIO | {"sliding": {"distance": 3000.0, "speed": 1000.0}})

    def stop(distance: float, born: int, live: int) -> None:
        del born, live
        if distance > 1000.0:
            raise RunStopped(15)

    with pytest.raises(RunStopped):
        rubnoise.run(scenario, tmp_path / "x.h5", watch=stop)
    assert names(tmp_path) == ["x.h5.part", "x.h5.part.journal"]
    with rubnoise.run(scenario, tmp_path / "x.h5") as one, rubnoise.run(scenario, tmp_path / "y.h5") as other:
        assert one._file.damaged() == other._file.damaged() == ()
        for name, group in one.groups().items():
            assert [group[each][:].tobytes() for each in group] == [
                other.groups()[name][each][:].tobytes() for each in group
            ]


def test_the_journal_of_a_sweep_has_whole_lines(tmp_path: Path, short: Shorten) -> None:
    told = [Entry(run_id=f"{n:016x}", state="failed", reason="no room " * n) for n in range(20)]
    for some in (told[:7], told[7:]):
        with Journal(tmp_path / "j") as journal:
            journal.add(*some)
    assert list(entries(tmp_path / "j")) == told


def test_a_system_that_writes_nothing_is_not_asked_for_ever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "pwrite", lambda *_: 0)
    monkeypatch.setattr(os, "write", lambda *_: 0)
    with (tmp_path / "file").open("w+b") as file:
        with pytest.raises(OSError, match=os.strerror(errno.EIO)):
            disk.write_all(file.fileno(), memoryview(b"x"), 0)
        with pytest.raises(OSError, match=os.strerror(errno.EIO)):
            disk.append_all(file.fileno(), memoryview(b"x"))
    with pytest.raises(RubnoiseError, match="cannot be written: Input/output error"):
        attempt(tmp_path / "x.h5")
