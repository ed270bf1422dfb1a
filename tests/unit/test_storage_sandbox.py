"""Files are looked at in a child process, whose answer is the structure that was written."""

import json
import os
import resource
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rubnoise
import rubnoise.storage.sandbox
from rubnoise.errors import RunFileRefused
from rubnoise.storage import sandbox
from rubnoise.storage.read_structure import read_structure
from rubnoise.storage.reader import open_run
from rubnoise.storage.rows import REMEDY
from rubnoise.storage.sandbox import PROGRAM, SandboxWorker, sandboxed
from tests.format.runs import attempt

# A look at a file in a child process costs this process nothing, however it ends, and reaches nothing else.
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


# A program with threads has its files looked at by a process of one thread, and need not know of it.
USER = """
import os, sys, threading, rubnoise
threading.Thread(target=threading.Event().wait, daemon=True).start()
with rubnoise.open(sys.argv[1]) as run:
    print(len(run.trace), "h5py" in sys.modules)
"""


@pytest.fixture(name="path")
def run_path(tmp_path: Path) -> Path:
    attempt(tmp_path / "run.h5")
    return tmp_path / "run.h5"


@pytest.fixture
def beside_a_thread(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Run a thread, and see to it that this process makes no copy of itself."""

    def refuse(*arguments: object) -> None:
        raise AssertionError("a process with threads was copied")

    monkeypatch.setattr(rubnoise.storage.sandbox, "sandboxed", refuse)
    done = threading.Event()
    thread = threading.Thread(target=done.wait)
    thread.start()
    yield
    done.set()
    thread.join()


@pytest.mark.usefixtures("beside_a_thread")
def test_a_file_is_opened_and_refused_as_without_threads(path: Path) -> None:
    with open_run(path) as run:
        assert run.rows("trace") == 11
        assert run.damaged() == ()
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(RunFileRefused, match="cut short"):
        open_run(path)


@pytest.mark.usefixtures("beside_a_thread")
def test_threads_may_open_files_at_once(path: Path) -> None:
    def rows(_: int) -> int:
        with open_run(path) as run:
            return run.rows("trace")

    with ThreadPoolExecutor(4) as pool:
        assert set(pool.map(rows, range(20))) == {11}


def processes_of(attendant: SandboxWorker) -> list[int]:
    """Return the children of this process that hold the other end of an attendant's channel: all of them here."""
    tasks = Path("/proc/self/task").iterdir()
    return [int(pid) for task in tasks for pid in (task / "children").read_text().split()]


@pytest.mark.skipif(not Path(f"/proc/self/task/{os.getpid()}/children").exists(), reason="only Linux names children")
def test_a_process_that_was_ended_is_started_again(path: Path) -> None:
    attendant = SandboxWorker()
    before = set(processes_of(attendant))
    with path.open("rb") as file:
        first = attendant.ask(file.fileno())
        (child,) = set(processes_of(attendant)) - before
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        assert attendant.ask(file.fileno()) == first
        (child,) = set(processes_of(attendant)) - before
    del attendant  # with its user it goes by itself, and is waited for
    deadline = time.monotonic() + 60.0
    while child in processes_of(SandboxWorker()):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def is_free_after(path: Path, ask: Callable[[int], object]) -> bool:
    """Whether a file that was open for writing while something was asked of another one can be written again."""
    own = path.with_name("own.h5")
    with h5py.File(own, "w"), path.open("rb") as file:
        ask(file.fileno())
    try:
        h5py.File(own, "w").close()
    except BlockingIOError:
        return False
    return True


def test_it_holds_no_lock_of_its_user(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    attendant, careless = SandboxWorker(), SandboxWorker()
    assert is_free_after(path, attendant.ask)
    monkeypatch.setattr(subprocess, "Popen", partial(subprocess.Popen, close_fds=False))
    assert not is_free_after(path, careless.ask)


@pytest.mark.parametrize("answers", [0, 1], ids=["before it has answered", "before its answer is read"])
def test_it_ends_without_a_word_where_its_user_is_gone(path: Path, answers: int) -> None:
    ours, its = socket.socketpair()
    with its:
        attendant = subprocess.Popen([sys.executable, "-c", PROGRAM], stdin=its, stderr=subprocess.PIPE)
    with ours, path.open("rb") as file:
        socket.send_fds(ours, [b"?"], [file.fileno()])
        if answers:
            select.select([ours], [], [], 60.0)
    _, said = attendant.communicate(timeout=60)
    assert (attendant.returncode, said) == (0, b"")


def test_a_program_with_threads_leaves_nothing_behind_and_loads_no_hdf5(path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", USER, path], capture_output=True, text=True, check=False, timeout=120
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "11 False\n", "")


# The structure derived from what was written is what read_structure finds in the file.
PLAIN: dict[str, Any] = {
    "format": 1,
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": 0.2},
    "sliding": {"distance": 300.0},
    "output": {"tick": 0.5},
}
MOVING = PLAIN | {
    "title": 'µm "mean\\slash" and 名',
    "sliding": {"distance": 300.0, "speed": 1000.0},
    "strength": {"law": "constant", "mean": 250.0},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
}


def found(path: Path) -> dict[str, Any]:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        told: dict[str, Any] = json.loads(read_structure(descriptor))
        return told
    finally:
        os.close(descriptor)


@pytest.mark.parametrize("values", [PLAIN, MOVING, MOVING | {"title": "?"}], ids=["plain", "moving", "short"])
def test_a_new_result_is_what_a_survey_finds(values: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "new.h5"
    with rubnoise.run(rubnoise.build(values), path) as run:
        told = run._file._found
        assert told == found(path)
        assert not run._file.damaged()


def test_a_compressed_one_is_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "packed.h5"
    scenario = rubnoise.build(PLAIN | {"output": {"tick": 0.5, "compression": "gzip"}})
    with rubnoise.run(scenario, path) as run:
        assert "chunks" in run._file._found["columns"]["trace"]["distance"]
        assert run._file._found == found(path)


def test_a_file_that_was_touched_meanwhile_is_looked_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "new.h5"
    written: list[Any] = []
    opened = open_run
    monkeypatch.setattr("rubnoise.api.running.open_run", lambda *given, own: written.append(own) or opened(*given, own))
    rubnoise.run(rubnoise.build(PLAIN), path).close()
    os.utime(path, ns=(0, 0))
    with path.open("r+b") as stream:
        stream.write(b"nonsense")
    with pytest.raises(rubnoise.Refused, match="not an HDF5 file"):
        open_run(path, written[0])
