"""A program with threads has its files looked at by a process of one thread, and need not know of it."""

import os
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

import h5py
import pytest

import rubnoise.storage.sandbox
from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import open_run
from rubnoise.storage.sandbox import PROGRAM, SandboxWorker
from tests.format.runs import attempt

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
