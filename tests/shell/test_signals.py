"""Signals in the middle of a run, and installations that cannot be written to."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import rubnoise
from rubnoise.cli.terminal import SIGNALS, stoppable
from rubnoise.errors import RunStopped
from tests.shell.terminal import LONG, begin, call, names, spawn_program, stop

SLIDER = Path("../given/slider.toml")
SHORT = ("--set", "sliding.distance=3 mm", "--set", "output.tick=1 um")


# A signal in the middle of a long run: gone within a second, and nothing is left.
TWICE = """
import signal
from rubnoise.cli.terminal import bar
with bar(shown=False) as watch:
    watch(0.0, 1.0, "")
    signal.raise_signal(signal.SIGINT)
    print("one", flush=True)
    signal.raise_signal(signal.{second})
    print("two", flush=True)
"""


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_stops_a_run_and_an_older_result_stays(here: Path, number: signal.Signals, code: int) -> None:
    assert call("run", SLIDER, "-o", "short.h5", "-q").code == 0  # no kernel is left to be compiled
    (here / "x.h5").write_bytes(b"precious")
    run = begin("run", SLIDER, "-o", "x.h5", "--force", "-q", *LONG, part=here / "x.h5.part")
    answer = stop(run, number)
    assert (answer.code, answer.out) == (code, "")
    assert answer.err == "stopped by a signal; nothing was kept, and the same command begins again\n"
    assert (here / "x.h5").read_bytes() == b"precious"
    assert names(here) == ["short.h5", "x.h5"]


@pytest.mark.parametrize("number", SIGNALS)
def test_what_writes_pages_and_sounds_is_stopped_between_pieces_alone(number: signal.Signals) -> None:
    """An exception in the middle is swallowed by a library that is being loaded, which then warns of itself."""
    with stoppable() as between:
        between()
        signal.raise_signal(number)
        with pytest.raises(RunStopped) as stopped:
            between()
    assert stopped.value.exit_code == 128 + number


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
    [("rubnoise.cli.app", "run"), ("rubnoise.scenario.reading", "run"), ("rubnoise.runs.sweep", "sweep")],
)
def test_an_interrupt_while_the_program_is_being_loaded_says_nothing(while_loading: str, command: str) -> None:
    words = [sys.executable, "-c", LOADING.replace("sys.argv[1]", repr(while_loading)), command, "x.toml"]
    done = subprocess.run(words, capture_output=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, b"", b"")


# An installation that cannot be written to, used without a home.
@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """Return a folder with the package in it, none of which can be written."""
    folder = tmp_path / "installed"
    shutil.copytree(Path(rubnoise.__file__).parent, folder / "rubnoise", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    return folder


@pytest.mark.slow
def test_a_run_works_where_kernels_cannot_be_kept(here: Path, installed: Path, unprivileged: tuple[str, ...]) -> None:
    environment = {name: text for name, text in os.environ.items() if not name.startswith(("NUMBA_", "XDG_"))}
    environment |= {"PYTHONPATH": str(installed), "HOME": str(installed / "absent")}
    here.joinpath("where.py").write_text("import rubnoise.api\nprint(rubnoise.__file__)", encoding="utf-8")
    told = subprocess.run(
        [*unprivileged, sys.executable, "where.py"], env=environment, capture_output=True, text=True, check=False
    )
    assert told.stdout.startswith(str(installed)), told.stderr
    run = [sys.executable, "-m", "rubnoise", "run", "../given/contact.toml", "-o"]
    done = subprocess.run([*unprivileged, *run, "x.h5"], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    warned, compiles = done.stderr.splitlines()
    assert warned.startswith("warning: compiled code cannot be kept")
    assert compiles.startswith("Compiling the kernels")
    assert (here / "x.h5").stat().st_size > 10_000
    assert not [path for path in installed.rglob("*") if path.suffix in {".pyc", ".nbi", ".nbc"}]


@pytest.mark.slow
def test_a_folder_that_cannot_be_written_is_refused(here: Path, installed: Path, unprivileged: tuple[str, ...]) -> None:
    run = [sys.executable, "-m", "rubnoise", "run", "../given/contact.toml", "-o", str(installed / "x.h5")]
    done = subprocess.run([*unprivileged, *run], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{installed}: the folder is not writable\n"
