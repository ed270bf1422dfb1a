"""What a terminal shows of a run."""

import io
import os
import re
import signal
import time
from pathlib import Path

import numba
import pytest

from rubnoise.cli.progress import Watcher, announce_compilation_by_workers, watching_reads
from rubnoise.simulation.kernels import coarse
from rubnoise.storage.reader import open_run
from tests.cli.terminal import LONGEST, begin_on_terminal, command, read_terminal, shown_on_terminal
from tests.format.runs import attempt

SLIDER = Path("../given/slider.toml")
LINE = re.compile(
    r"\r *(?P<share>\d+)%  (?P<reached>[\d.e-]+) of 100 mm  (?P<junctions>[\d,]+) junctions, (?P<live>\d+) alive"
    r"(?P<rest>  \d+:\d\d to go)?"
)


def test_a_terminal_sees_compilation_once_and_how_far_the_run_is(here: Path, tmp_path: Path) -> None:
    arguments = command("run", SLIDER, "--force", "--set", "sliding.distance=100 mm")
    code, first = shown_on_terminal(arguments, NUMBA_CACHE_DIR=str(tmp_path))
    assert code == 0
    assert first.count("Compiling the kernels") == 1
    code, second = shown_on_terminal(arguments, NUMBA_CACHE_DIR=str(tmp_path))
    assert code == 0
    assert "Compiling" not in second
    for shown in (first, second):
        _check_progress(shown)
    assert "real contact area mean (um^2)" in second


def _check_progress(shown: str) -> None:
    lines = list(LINE.finditer(shown))
    assert len(lines) >= 3
    reached = [float(line["reached"]) for line in lines]
    junctions = [int(line["junctions"].replace(",", "")) for line in lines]
    assert reached == sorted(reached)
    assert junctions == sorted(junctions)
    assert junctions[-1] > 1000
    assert all(0 < int(line["live"]) < 60 for line in lines[1:])
    assert any(line["rest"] for line in lines)
    assert all(len(line[0].rstrip()) <= 80 for line in lines)


@pytest.mark.parametrize("option", ["-q", "--json"])
def test_a_terminal_sees_no_progress_where_silence_was_asked_for(here: Path, option: str) -> None:
    code, shown = shown_on_terminal(command("run", SLIDER, option, "--set", "strength.mean=0.1 MPa"))
    assert code == 0
    assert "alive" not in shown
    assert "Compiling" not in shown
    assert shown == "" if option == "-q" else shown.startswith('{"output"')


def test_births_in_millions_are_counted_under_ones_eyes_and_a_signal_ends_that(here: Path) -> None:
    run, ours = begin_on_terminal(command("run", SLIDER, *LONGEST))
    shown = b""
    while b"counting the births" not in shown:
        piece = read_terminal(ours)
        assert piece, shown
        shown += piece
    time.sleep(0.2)
    run.send_signal(signal.SIGINT)
    shown += b"".join(iter(lambda: read_terminal(ours), b""))
    os.close(ours)
    assert run.wait(60) == 130
    assert b"stopped by a signal" in shown
    assert list(here.iterdir()) == []


def test_a_sweep_announces_what_its_workers_compile(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr("rubnoise.cli.progress._say_compiling", lambda: said.append("compiling"))
    with monkeypatch.context() as patch:
        patch.setattr("rubnoise.compiling.is_kept", lambda _kernel: True)
        announce_compilation_by_workers()
        assert said == []
    monkeypatch.setattr(coarse, "deposit_coarse_lives", numba.njit(coarse.deposit_coarse_lives.py_func))
    announce_compilation_by_workers()
    assert said == ["compiling"]


class Clock:
    """A clock that is put forward by hand."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_the_time_to_go_leaves_out_the_first_panel(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, screen = Clock(), io.StringIO()
    monkeypatch.setattr("rubnoise.cli.progress.time.monotonic", clock)
    monkeypatch.setattr("sys.stderr", screen)
    watcher = Watcher(1000.0, shown=True)
    for seconds, distance in [(0.0, 0.0), (60.0, 100.0), (1.0, 200.0), (1.0, 300.0)]:
        clock.now += seconds
        watcher(distance, 10, 3)
    shown = screen.getvalue().split("\r")
    assert [text.partition("alive")[2].strip() for text in shown[1:]] == ["", "", "0:08 to go", "0:07 to go"]
    assert "0.3 of 1 mm" in shown[-1]


def test_an_hour_is_told_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, screen = Clock(), io.StringIO()
    monkeypatch.setattr("rubnoise.cli.progress.time.monotonic", clock)
    monkeypatch.setattr("sys.stderr", screen)
    watcher = Watcher(1000.0, shown=True)
    for seconds, distance in [(0.0, 0.0), (1.0, 1.0), (10.0, 2.0)]:
        clock.now += seconds
        watcher(distance, 10, 3)
    assert screen.getvalue().endswith("alive  2:46:20 to go")


def test_a_long_look_through_a_file_is_shown_where_it_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    clock, screen = Clock(), io.StringIO()
    monkeypatch.setattr("rubnoise.cli.progress.time.monotonic", clock)
    monkeypatch.setattr("sys.stderr", screen)
    attempt(tmp_path / "run.h5")
    with open_run(tmp_path / "run.h5") as run:
        with watching_reads(run, shown=True):
            for seconds, stop in [(0.5, 1), (0.6, 2), (0.01, 3), (0.2, 4)]:
                clock.now += seconds
                run.column("trace", "distance", 0, stop)
            assert screen.getvalue().split("\r") == [
                "", "/trace/distance: 2 of 11 rows", "/trace/distance: 4 of 11 rows",
            ]  # fmt: skip
        assert re.fullmatch(r"\r +\r", screen.getvalue()[-31:])
        shown = len(screen.getvalue())
        clock.now += 9.0
        run.column("trace", "distance")
        with watching_reads(run, shown=False):
            run.column("trace", "distance")
        assert len(screen.getvalue()) == shown
