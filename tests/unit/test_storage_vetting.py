"""A look at a file in a child process costs this process nothing, however it ends, and reaches nothing else."""

import json
import os
import resource
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rubnoise.storage import sandbox
from rubnoise.storage.rows import REMEDY
from rubnoise.storage.sandbox import sandboxed

GIGABYTE = 1 << 30


@pytest.fixture(name="descriptor")
def open_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Open a file; afterwards every child was seen off."""
    children: list[int] = []
    fork = os.fork

    def noted() -> int:
        children.append(fork())
        return children[-1]

    monkeypatch.setattr(os, "fork", noted)
    (tmp_path / "file").write_bytes(b"content")
    with (tmp_path / "file").open("r+b") as file:
        yield file.fileno()
    assert children
    for child in children:
        with pytest.raises(ChildProcessError):
            os.waitpid(child, os.WNOHANG)


def test_a_lock_of_this_process_is_not_held_by_the_child(descriptor: int, tmp_path: Path) -> None:
    def look(_: int) -> bytes:
        try:
            os.fstat(lock.fileno())
        except OSError:
            return b'"let go"'
        return b'"held"'

    with (tmp_path / "lock").open("w") as lock:
        assert sandboxed(descriptor, look) == b'"let go"'


def refusal(answer: bytes) -> str:
    return str(json.loads(answer)["refused"]).removesuffix(f"; {REMEDY}")


def test_what_the_child_finds_is_handed_on(descriptor: int) -> None:
    assert sandboxed(descriptor, lambda it: os.pread(it, 7, 0)) == b"content"
    assert sandboxed(descriptor, lambda it: b"x" * 10_000_000) == b"x" * 10_000_000
    assert sandboxed(descriptor, lambda it: str(os.getpid()).encode()) != str(os.getpid()).encode()


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS])
def test_a_crash_is_a_reason(descriptor: int, number: signal.Signals, capfd: pytest.CaptureFixture[str]) -> None:
    def crash(it: int) -> bytes:
        os.write(2, b"free(): invalid pointer\n")
        os.kill(os.getpid(), number)
        return b""

    assert refusal(sandboxed(descriptor, crash)) == f"damaged: HDF5 crashes ({number.name}) on its structure"
    assert capfd.readouterr() == ("", "")


def test_an_error_that_nobody_foresaw_is_a_reason(descriptor: int, capfd: pytest.CaptureFixture[str]) -> None:
    assert refusal(sandboxed(descriptor, lambda it: bytes(1 // (it - it)))) == "damaged: HDF5 fails on its structure"
    assert capfd.readouterr() == ("", "")


def test_a_loop_ends(descriptor: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def loop(it: int) -> bytes:
        while it:
            pass
        return b""

    monkeypatch.setattr(sandbox, "CPU_SECONDS", 1)
    assert refusal(sandboxed(descriptor, loop)) == "damaged: HDF5 loops on its structure"


def test_waiting_ends(descriptor: int) -> None:
    def wait(it: int) -> bytes:
        time.sleep(60.0)
        return b""

    assert "takes more time" in refusal(sandboxed(descriptor, wait, patience=0.2))


def test_an_answer_without_end_is_cut_off(descriptor: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sandbox, "ANSWER_BYTES", 1_000_000)
    assert "takes more time or memory" in refusal(sandboxed(descriptor, lambda it: bytes(10_000_000)))


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="only Linux limits the memory of a process")
def test_memory_is_limited(descriptor: int) -> None:
    assert np.ones(GIGABYTE // 8).nbytes == GIGABYTE  # here there is as much
    assert "fails" in refusal(sandboxed(descriptor, lambda it: bytes(np.ones(GIGABYTE // 8)[:1])))


def test_no_other_file_can_be_opened_and_none_written(descriptor: int, tmp_path: Path) -> None:
    def touch(it: int) -> bytes:
        told = []
        for way in (
            lambda: os.open(tmp_path / "file", os.O_RDONLY),
            lambda: os.open(tmp_path / "new", os.O_CREAT | os.O_WRONLY),
            os.pipe,
            lambda: os.pwrite(it, b"changed", 0),
        ):
            try:
                way()
            except OSError as problem:
                told.append(problem.strerror)
        return json.dumps(told).encode()

    assert json.loads(sandboxed(descriptor, touch)) == [*["Too many open files"] * 3, "File too large"]
    assert (tmp_path / "file").read_bytes() == b"content"


def test_the_limits_of_this_process_stay_as_they_were(descriptor: int) -> None:
    limits = (resource.RLIMIT_CPU, resource.RLIMIT_NOFILE, resource.RLIMIT_AS, resource.RLIMIT_FSIZE)
    before = [resource.getrlimit(what) for what in limits]
    sandboxed(descriptor, lambda it: b"")
    assert [resource.getrlimit(what) for what in limits] == before


def test_an_interrupt_leaves_no_child_behind(descriptor: int) -> None:
    """The fixture looks for children afterwards."""

    def wait(it: int) -> bytes:
        time.sleep(60.0)
        return b""

    def interrupt(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(KeyboardInterrupt):
            sandboxed(descriptor, wait)
    finally:
        signal.signal(signal.SIGALRM, before)
