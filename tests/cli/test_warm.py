"""Copies of a process that has loaded the program behave like new processes."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.terminal import command, spawn, spawn_program, start

SHORT = Path("../given/contact.toml")


@pytest.mark.parametrize(
    "words",
    [("check", SHORT, "--json"), ("info", "missing.h5"), ("run", SHORT, "--seed", "x"), ("new", "mine.toml")],
    ids=["answers", "refuses", "explains its use", "writes"],
)
def test_a_warm_call_answers_as_a_cold_one(here: Path, words: tuple[str | Path, ...]) -> None:
    answers = []
    for cold in (False, True):
        (here / "mine.toml").unlink(missing_ok=True)
        answers.append(spawn(*words, cold=cold, COLUMNS="100"))
    warm, cold = answers
    assert (warm.code, warm.err) == (cold.code, cold.err)
    assert warm.out == cold.out or warm.json().keys() == cold.json().keys()  # it foretells a time


def test_folder_variables_words_and_input_are_its_own(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ONE", "here")
    told = "import os, sys; print(os.getcwd(), os.environ['ONE'], sys.argv[1:], sys.stdin.read())"
    with start(
        [sys.executable, "-c", told, "a b", ""], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as run:
        out, _ = run.communicate("typed")
    assert out == f"{here} here ['a b', ''] typed\n"


def test_it_leaves_as_a_process_does() -> None:
    assert spawn_program("import sys; sys.exit(7)").code == 7
    assert spawn_program("import sys; sys.exit('why')").code == 1
    assert spawn_program("import atexit; atexit.register(print, 'at the end')").out == "at the end\n"
    failed = spawn_program("1 // 0")
    assert failed.code == 1
    assert failed.err.endswith("ZeroDivisionError: integer division or modulo by zero\n")
    assert spawn_program("import os; os.kill(os.getpid(), 9)").code == -signal.SIGKILL


def test_it_can_be_ended_and_waited_for() -> None:
    with start([sys.executable, "-c", "import time; time.sleep(60)"]) as run:
        assert run.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            run.wait(0.05)
        run.terminate()
        assert run.wait(10) == -signal.SIGTERM


def test_it_is_a_process_of_its_own_whose_traces_are_lost() -> None:
    first = spawn_program("import os, rubnoise; rubnoise.trace = 1; print(os.getpid())")
    second = spawn_program("import os, rubnoise; print(os.getpid(), hasattr(rubnoise, 'trace'))")
    assert second.out.split()[1] == "False"
    assert len({first.out.split()[0], second.out.split()[0], str(os.getpid())}) == 3


def test_variables_that_python_reads_make_a_fresh_one() -> None:
    program = "import sys; print('rubnoise.cli.app' in sys.modules)"
    words = [sys.executable, "-c", program]
    for environment, warm in (({}, True), ({"PYTHONHASHSEED": "7"}, False)):
        with start(words, environment, stdout=subprocess.PIPE, text=True) as run:
            assert run.communicate()[0] == f"{warm}\n"
    with start(command("--help"), cold=True, stdout=subprocess.PIPE) as run:
        assert run.args == command("--help")
        run.communicate()
