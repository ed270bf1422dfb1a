"""A signal in the middle of a long run: gone within a second, with what it takes to go on."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rubnoise.cli.progress import SIGNALS, watching
from rubnoise.errors import RunStopped
from tests.cli.terminal import LONG, begin, call, names, spawn_program, stop

SLIDER = Path("../given/slider.toml")
TWICE = """
import signal
from rubnoise.cli.progress import watching
with watching(1.0, shown=False) as watcher:
    watcher(0.0, 0, 0)
    signal.raise_signal(signal.SIGINT)
    print("one", flush=True)
    signal.raise_signal(signal.{second})
    print("two", flush=True)
"""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_stops_a_run_and_an_older_result_stays(here: Path, number: signal.Signals, code: int) -> None:
    assert call("run", SLIDER, "-o", "short.h5", "-q").code == 0  # no kernel is left to be compiled
    (here / "x.h5").write_bytes(b"precious")
    run = begin("run", SLIDER, "-o", "x.h5", "--force", "-q", *LONG, part=here / "x.h5.part.journal")
    answer = stop(run, number)
    assert (answer.code, answer.out) == (code, "")
    assert answer.err == "stopped by a signal; rubnoise resume x.h5.part continues it\n"
    assert (here / "x.h5").read_bytes() == b"precious"
    assert names(here) == ["short.h5", "x.h5", "x.h5.part", "x.h5.part.journal"]


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_is_obeyed_when_the_run_next_asks(number: signal.Signals) -> None:
    with watching(100.0, shown=False) as watcher:
        watcher(0.0, 0, 0)
        signal.raise_signal(number)
        with pytest.raises(RunStopped) as stopped:
            watcher(50.0, 100, 20)
    assert stopped.value.exit_code == 128 + number


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_before_the_start_is_obeyed_at_once(number: signal.Signals) -> None:
    with watching(100.0, shown=False), pytest.raises(RunStopped):
        signal.raise_signal(number)


def test_what_was_done_about_signals_before_is_done_again_after() -> None:
    def mine(*_: object) -> None:
        raise AssertionError

    before = {number: signal.signal(number, mine) for number in SIGNALS}
    try:
        with watching(100.0, shown=False) as watcher:
            watcher(0.0, 0, 0)
            signal.raise_signal(signal.SIGINT)
        assert [signal.getsignal(number) for number in SIGNALS] == [mine, mine]
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@pytest.mark.parametrize("second", SIGNALS)
def test_the_second_signal_leaves_at_once(second: signal.Signals) -> None:
    program = TWICE.format(second=second.name)
    done = spawn_program(program)
    assert (done.code, done.out) == (-second, "one\n"), done.err


# What is run behind a & begins with SIGINT ignored, and so does what it starts.
USUAL = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"
LOADING = (
    USUAL
    + """
import sys

class Interrupting:
    def find_spec(self, name, path, target=None):
        if name == sys.argv[1]:
            signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
from rubnoise.__main__ import main
main()
"""
)


@pytest.mark.parametrize(
    ("while_loading", "command"),
    [("rubnoise.cli.app", "run"), ("rubnoise.scenario.reading", "run"), ("rubnoise.api.sweeping", "sweep")],
)
def test_an_interrupt_while_the_program_is_being_loaded_says_nothing(while_loading: str, command: str) -> None:
    words = [sys.executable, "-c", LOADING.replace("sys.argv[1]", repr(while_loading)), command, "x.toml"]
    done = subprocess.run(words, capture_output=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, b"", b"")


def test_an_interrupt_after_that_ends_a_command_as_ever() -> None:
    kept = USUAL + "from rubnoise import __main__ as entry; import rubnoise.cli.app as app;"
    kept += "app.main = lambda: print(signal.getsignal(signal.SIGINT) is signal.default_int_handler); entry.main()"
    done = subprocess.run([sys.executable, "-c", kept], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "True\n")
