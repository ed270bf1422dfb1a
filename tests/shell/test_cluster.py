"""Sweeps on a cluster give the bits that a pool gives."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from rubnoise.runs import executors
from tests.shell.tampered import SLOW, TABLE, begin_sweep, runs_of
from tests.shell.terminal import CONTACT, call, spawn

# A real scheduler with two worker processes on this machine gives the bits that a pool gives.
pytest.importorskip("distributed", reason="the extra cluster is not installed")

Processes = list["subprocess.Popen[bytes]"]


def _started(module: str, *options: str) -> "subprocess.Popen[bytes]":
    program = [sys.executable, "-m", "distributed.cli." + module, *options]
    return subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture
def scheduler(here: Path) -> Iterator[tuple[Path, Processes]]:
    """Start a scheduler and two workers of one thread; yield the scheduler's file, and the three processes."""
    file = here / "scheduler.json"
    plain = ("--no-dashboard",)
    with ExitStack() as ending:
        processes: Processes = []

        def start(module: str, *options: str) -> None:
            process = _started(module, *options)
            processes.append(process)
            ending.callback(process.wait)
            ending.callback(process.kill)

        start("dask_scheduler", "--scheduler-file", str(file), "--host", "127.0.0.1", "--port", "0", *plain)
        _wait_for(file)
        for _ in range(2):
            start("dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny", *plain)
        yield file, processes


def _wait_for(path: Path) -> None:
    last = time.monotonic() + 120.0
    while not path.exists():
        assert time.monotonic() < last, f"{path} never came to be"
        time.sleep(0.05)


@pytest.fixture
def file(here: Path) -> Path:
    (path := here / "s.toml").write_text(CONTACT + TABLE, encoding="utf-8")
    return path


@pytest.mark.slow
def test_a_cluster_gives_the_bits_of_a_pool(file: Path, scheduler: tuple[Path, Processes]) -> None:
    answer = spawn("sweep", file, "-o", "afar", "--cluster", scheduler[0])
    assert (answer.code, answer.out) == (0, "afar: 2 points, 6 runs: 6 done\n"), answer.err
    assert call("sweep", file, "-o", "near", "--jobs", "1", "-q").code == 0
    assert runs_of(Path("afar")) == runs_of(Path("near"))


@pytest.mark.slow
def test_a_worker_of_a_cluster_that_is_killed_changes_nothing(file: Path, scheduler: tuple[Path, Processes]) -> None:
    address, (_, worker, _) = scheduler
    begun = begin_sweep(Path("afar"), "sweep", file, "-o", "afar", "--cluster", address, *SLOW)
    worker.kill()
    out, err = begun.communicate(timeout=300)
    assert (begun.returncode, out) == (0, "afar: 2 points, 8 runs: 8 done\n"), err
    assert call("sweep", file, "-o", "near", "--jobs", "1", "-q", *SLOW).code == 0
    assert runs_of(Path("afar")) == runs_of(Path("near"))


@pytest.mark.slow
def test_a_sweep_whose_scheduler_is_killed_is_resumed(file: Path, scheduler: tuple[Path, Processes]) -> None:
    address, (boss, *workers) = scheduler
    begun = begin_sweep(Path("afar"), "sweep", file, "-o", "afar", "--cluster", address, *SLOW)
    boss.kill()
    out, err = begun.communicate(timeout=300)
    assert (begun.returncode, out) == (1, "")
    assert "the same command resumes the sweep" in err
    for worker in workers:  # one that is still at a run keeps its file to itself, as long as the run takes
        worker.kill()
        worker.wait()
    answer = call("sweep", file, "-o", "afar", "--jobs", "2", *SLOW)
    assert (answer.out, answer.err) == ("afar: 2 points, 8 runs: 8 done\n", "")


LATER = (
    "import sys; from rubnoise import streams; streams.STREAM_VERSION += 1; "
    "from distributed.cli.dask_worker import main; main()"
)


@pytest.mark.slow
def test_workers_of_another_version_get_no_work(file: Path, scheduler: tuple[Path, Processes]) -> None:
    address, _ = scheduler
    options = ("--scheduler-file", str(address), "--nthreads", "1", "--no-nanny", "--no-dashboard")
    with subprocess.Popen([sys.executable, "-c", LATER, *options], stderr=subprocess.PIPE, text=True) as later:
        while "Registered to" not in later.stderr.readline():
            assert later.poll() is None
        answer = spawn("sweep", file, "-o", "afar", "--cluster", address)
        later.kill()
    assert (answer.code, answer.out) == (2, "")
    assert "this worker has rubnoise" in answer.err
    assert "stream 3, format 2, and this process" in answer.err
    assert runs_of(Path("afar")) == {}


@pytest.mark.parametrize("address", ["nonsense", "tcp://there", "other://10.0.0.1:8786", "10.0.0.1:99999", "none.json"])
def test_what_is_no_address_is_refused_at_once(file: Path, address: str) -> None:
    answer = call("sweep", file, "-o", "afar", "--cluster", address)
    said = f"{address}: is neither the file of a scheduler nor an address such as tcp://10.0.0.1:8786\n"
    assert (answer.code, answer.out, answer.err) == (2, "", said)


def test_where_no_scheduler_answers_is_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executors, "PATIENCE", 0.5)
    answer = call("sweep", file, "-o", "afar", "--cluster", "tcp://127.0.0.1:9")
    assert answer.code == 2
    assert "tcp://127.0.0.1:9: no scheduler answers there" in answer.err
