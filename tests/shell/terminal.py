"""The command line as a user has it: called in this process where that is enough, in one of its own where it is not."""

import json
import os
import pty
import signal
import subprocess
import sys
import termios
import time
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any
from unittest.mock import patch

import h5py
import pytest

from rubnoise.cli.app import main
from tests.architecture.sources import ROOT
from tests.warm import Warm

PAPER = ROOT / "scenarios" / "paper"

CONTACT = """\
format = 1
title = "a short contact"

[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20

[sliding]
distance = "300 um"
"""
WITH_SLIDER = """\
format = 1

[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20
calibration = "paper"

[diameter]
law = "normal"
spread = "0.2 um"

[strength]
mean = "250 MPa"

[sliding]
speed = "1 mm/s"
distance = "300 um"

[slider]
mass = "5 g"
stiffness = "300 N/m"
damping = "0.05 N*s/m"

[output]
tick = "0.1 um"
"""
LONG = ("--set", "sliding.distance=2 m", "--set", "output.tick=1 um")
"""Changes that make a run last many seconds."""
LONGEST = ("--set", "sliding.distance=100 m", "--set", "output.tick=10 um")
"""Changes that make it last many seconds to count the births alone; 14 GB have to be free for the result."""

READ_AT_START = ("NUMBA_", "PYTHON")
"""How variables begin that only a new process reads."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a call left: exit code and text on both streams."""

    code: int
    out: str
    err: str

    def json(self) -> Any:
        """Return standard output as the one JSON object that it is."""
        return json.loads(self.out)

    def values(self) -> Any:
        """Return the same with the value of each row in place of the row."""
        return values_of(self.json())


ROW = {"value", "unit", "exact", "error", "interval", "z", "note"}


def values_of(told: Any) -> Any:
    """Return an answer in JSON with the value of each row in place of the row; None where it has no value."""
    if not isinstance(told, dict):
        return told
    return told.get("value") if told and set(told) <= ROW else {name: values_of(item) for name, item in told.items()}


def call(*arguments: str | Path) -> Answer:
    """Call the command line in this process; neither stream is a terminal."""
    out, err, code = StringIO(), StringIO(), 0
    with patch.object(sys, "argv", ["rubnoise", *map(str, arguments)]), redirect_stdout(out), redirect_stderr(err):
        try:
            main()
        except SystemExit as left:
            code = left.code if isinstance(left.code, int) else 0 if left.code is None else 1
    return Answer(code=code, out=out.getvalue(), err=err.getvalue())


def command(*arguments: str | Path) -> list[str]:
    """Return the words of a call in a process of its own."""
    return [sys.executable, "-m", "rubnoise", *map(str, arguments)]


def start(
    words: list[str], environment: dict[str, str] | None = None, *, cold: bool = False, **streams: Any
) -> "subprocess.Popen[Any]":
    """Start a program; one of ours as the copy of a process that has loaded it, unless its own start is to be seen.

    What stands after `-c` is one of ours, too, and finds everything loaded.
    """
    settings = environment or {}
    warm = words[:3] == command() or words[:2] == [sys.executable, "-c"]
    if warm and not cold and not any(name.startswith(READ_AT_START) for name in settings):
        return Warm(words[1:], env=os.environ | settings, **streams)
    return subprocess.Popen(words, env=os.environ | settings, **streams)


def spawn(*arguments: str | Path, cold: bool = False, **environment: str) -> Answer:
    """Call the command line in a process of its own, with pipes for its streams; a cold one loads all it needs."""
    return answer_of(command(*arguments), environment, cold=cold)


def spawn_program(program: str, *arguments: str | Path) -> Answer:
    """Call a Python program in a process of its own, where everything is loaded already."""
    return answer_of([sys.executable, "-c", program, *map(str, arguments)])


def answer_of(words: list[str], environment: dict[str, str] | None = None, **how: Any) -> Answer:
    """Return the answer of a program (see start), with pipes for its streams."""
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with start(words, environment, text=True, **pipes, **how) as run:
        out, err = run.communicate()
    return Answer(code=run.returncode, out=out, err=err)


def begin(*arguments: str | Path, part: Path) -> "subprocess.Popen[str]":
    """Start a run in a process of its own, and return it when rows are being written to its part file."""
    run = start(command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(3000):
        if part.exists():
            break
        time.sleep(0.01)
    assert run.poll() is None, "the run ended before it began"
    time.sleep(0.3)  # over the opening of the part, into the panels
    return run


def stop(run: "subprocess.Popen[str]", *numbers: signal.Signals) -> Answer:
    """Send signals to a run and return its answer; raises TimeoutExpired where it does not leave."""
    for number in numbers:
        run.send_signal(number)
    out, err = run.communicate(timeout=60)
    return Answer(code=run.returncode, out=out, err=err)


def begin_on_terminal(
    arguments: list[str], columns: int = 0, **environment: str
) -> tuple["subprocess.Popen[bytes]", int]:
    """Start a program on a terminal of its own, so many columns wide; return it and our end of that terminal."""
    try:
        ours, theirs = pty.openpty()
    except OSError as problem:
        pytest.skip(f"this system gives no pseudo-terminal: {problem}")
    termios.tcsetwinsize(theirs, (24 if columns else 0, columns))
    there = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    with patch.dict(os.environ, there, clear=True):
        program = start(arguments, environment, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    return program, ours


def read_terminal(ours: int) -> bytes:
    """Return what a terminal got since it was last read; nothing where the program has ended."""
    try:
        return os.read(ours, 65536)
    except OSError:  # what Linux says when the other end is closed
        return b""


def shown_on_terminal(arguments: list[str], columns: int = 0, **environment: str) -> tuple[int, str]:
    """Return the exit code of a program on a terminal, and all that the terminal got."""
    program, ours = begin_on_terminal(arguments, columns, **environment)
    shown = b"".join(iter(lambda: read_terminal(ours), b""))
    os.close(ours)
    return program.wait(), shown.decode()


def columns(path: Path) -> dict[str, bytes]:
    """Return the bytes of every column of a result."""
    with h5py.File(path) as file:
        return {f"{group}/{name}": data[:].tobytes() for group in file for name, data in file[group].items()}


def names(folder: Path) -> list[str]:
    """Return the names of everything in a folder, hidden ones too."""
    return sorted(entry.name for entry in folder.iterdir())
