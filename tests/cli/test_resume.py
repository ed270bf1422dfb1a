"""`rubnoise resume`, signals in the middle of a run, and installations that cannot be written to."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.cli.progress import SIGNALS, stoppable, watching
from rubnoise.errors import RunStopped
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.resume import examined
from tests.cli.terminal import LONG, Answer, begin, call, columns, names, spawn_program, start, stop
from tests.pages.reading import answer as answer_of_page
from tests.pages.reading import data_of

# `rubnoise resume`, and `run` and `info` on a run that did not finish.
SLIDER = Path("../given/slider.toml")
HALF_WAY = """
import time
from pathlib import Path
from unittest.mock import patch
from rubnoise.cli.app import main
from rubnoise.cli.progress import Watcher
from rubnoise.errors import RunStopped
from rubnoise.simulation import draws
from rubnoise.storage import writer

class Halts(Watcher):
    halts = True

    def __call__(self, distance, junctions, live):
        if self.halts and distance > 1500.0:
            self.halts = False
            {halt}

writer.COMMIT_SECONDS = 0.0
draws._DRAWN_AT_ONCE = 1
with patch("rubnoise.cli.progress.Watcher", Halts):
    main()
"""
STOPPED = HALF_WAY.format(halt="raise RunStopped(15)")
WAITING = HALF_WAY.format(
    halt="""Path("halted").touch()
            while Path("halted").exists(): time.sleep(0.01)"""
)
SHORT = ("--set", "sliding.distance=3 mm", "--set", "output.tick=1 um")


@pytest.fixture
def part(here: Path) -> Path:
    """Return the part of a run that was stopped half-way."""
    done = spawn_program(STOPPED, "run", SLIDER, "-o", "x.h5", "-q", *SHORT)
    assert (done.code, done.out) == (143, "")
    assert done.err == "stopped by a signal; rubnoise resume x.h5.part continues it\n"
    return here / "x.h5.part"


@pytest.fixture
def whole(here: Path) -> dict[str, bytes]:
    """Return the columns of that run when nothing stops it."""
    assert call("run", SLIDER, "-o", "whole.h5", "-q", *SHORT).code == 0
    found = columns(here / "whole.h5")
    (here / "whole.h5").unlink()
    return found


@pytest.fixture
def waiting(here: Path) -> Iterator["subprocess.Popen[str]"]:
    """Begin a run that waits half-way until the file `halted` is gone."""
    words = [sys.executable, "-c", WAITING, "run", SLIDER, "-o", "x.h5", "-q", *SHORT]
    with start(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        while not (here / "halted").exists():
            assert run.poll() is None, "the run ended before it was half-way"
            time.sleep(0.01)
        yield run
        run.kill()


def test_killed_in_the_middle_a_run_goes_on_to_the_same_bits(
    here: Path, whole: dict[str, bytes], waiting: "subprocess.Popen[str]"
) -> None:
    killed = stop(waiting, signal.SIGKILL)
    (here / "halted").unlink()
    assert killed.code == -signal.SIGKILL
    assert names(here) == [".x.h5.lock", "x.h5.part", "x.h5.part.journal"]
    assert 0.1 < call("info", "x.h5.part", "--json").json()["share"] < 0.6
    answer = call("resume", "x.h5.part", "-q")
    assert answer == Answer(code=0, out="", err="")
    assert columns(here / "x.h5") == whole
    assert names(here) == ["x.h5"]


def test_a_part_is_viewed_as_far_as_it_is_committed(part: Path, whole: dict[str, bytes]) -> None:
    answer = call("view", part.name, "-o", "x.html")
    assert answer.code == 0, answer.err
    data = data_of(Path("x.html").read_text(encoding="utf-8"))
    done = call("info", part.name, "--json").json()["done"]
    assert (data["planned"], data["distance"]) == (3000.0, done["ticks"] - 1.0)
    assert data["junctionRows"] == done["junctions"]
    body = "return Array.from(view.columns(view.data.groups.trace.columns).real_contact_area);"
    area = np.frombuffer(whole["trace/real_contact_area"])
    assert answer_of_page(data, body) == area[: done["ticks"]].tolist()


def test_resume_answers_as_run_does(here: Path, part: Path, whole: dict[str, bytes]) -> None:
    answer = call("resume", part.name)
    assert answer.code == 0
    assert answer.out.startswith("x.h5: ")
    assert "warning: the velocity of the slider" in answer.err
    assert columns(here / "x.h5") == whole
    assert names(here) == ["x.h5"]


def test_run_goes_on_by_itself_and_says_so(here: Path, part: Path, whole: dict[str, bytes]) -> None:
    share = call("info", part.name, "--json").json()["share"]
    answer = call("run", SLIDER, "-o", "x.h5", *SHORT, "--engine", "batch", "--json")
    assert answer.code == 0
    assert answer.err == f"x.h5.part: resumes an unfinished run at {share:.0%}\n"
    assert answer.json()["output"] == "x.h5"
    assert columns(here / "x.h5") == whole


def test_another_run_is_refused_and_force_starts_over(here: Path, part: Path) -> None:
    answer = call("run", SLIDER, "-o", "x.h5", *SHORT, "--seed", "9")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == (
        "x.h5.part: belongs to another run: run.seed is 1 there and 9 here"
        " (--force starts over; rubnoise resume x.h5.part continues it)\n"
    )
    assert names(here) == ["x.h5.part", "x.h5.part.journal"]
    assert call("run", SLIDER, "-o", "x.h5", *SHORT, "--seed", "9", "--force", "-q").err == ""
    assert names(here) == ["x.h5"]


def test_a_dry_run_leaves_the_part_alone(here: Path, part: Path) -> None:
    before = part.read_bytes()
    assert call("run", SLIDER, "-o", "x.h5", *SHORT, "--dry-run").code == 0
    assert part.read_bytes() == before


def test_info_says_how_far_it_is(here: Path, part: Path) -> None:
    answer = call("info", part.name)
    told = call("info", part.name, "--json").json()
    assert 0.1 < told["share"] < 0.6
    assert told["done"]["ticks"] == pytest.approx(told["share"] * told["whole"]["ticks"])
    assert not told["being_written"]
    assert answer.code == 0
    assert answer.out.startswith("x.h5.part: ")
    assert f"{told['done']['junctions']:,} of {told['whole']['junctions']:,} junctions" in answer.out
    assert f"last commit                   {told['committed']}" in answer.out
    assert "rubnoise resume x.h5.part continues it" in answer.out


def test_info_looks_at_a_run_under_way_without_harm(
    here: Path, whole: dict[str, bytes], waiting: "subprocess.Popen[str]"
) -> None:
    assert call("info", "x.h5.part", "--json").json()["being_written"]
    refused = call("resume", "x.h5.part")
    assert (refused.code, refused.err) == (2, f"{here / 'x.h5'}: another process is writing it\n")
    (here / "halted").unlink()
    assert waiting.communicate(timeout=120)[1] == ""
    assert columns(here / "x.h5") == whole


def test_a_run_that_ends_while_it_is_looked_at_is_told_as_ended(
    here: Path, part: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(paths: OutputPaths) -> RunDescription:
        paths.part.rename(paths.final)
        return examined(paths)

    monkeypatch.setattr("rubnoise.api.resuming.examined", late)
    answer = call("resume", part.name)
    assert (answer.code, answer.err) == (2, "x.h5.part: no such file; x.h5 is there\n")


def test_what_is_no_part_is_told_in_a_line(here: Path) -> None:
    (here / "x.h5").write_bytes(b"whole")
    for name, said in (
        ("x.h5", "x.h5: is not an unfinished run: their names end in .part\n"),
        ("x.h5.part", "x.h5.part: no such file; x.h5 is there\n"),
        ("y.h5.part", "y.h5.part: no such file\n"),
    ):
        answer = call("resume", name)
        assert (answer.code, answer.err) == (2, said)
    assert call("info", "y.h5.part").err == "y.h5.part: no such file\n"


# A signal in the middle of a long run: gone within a second, with what it takes to go on.
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


@pytest.mark.parametrize("number", SIGNALS)
def test_what_writes_pages_and_films_is_stopped_between_pieces_alone(number: signal.Signals) -> None:
    """An exception in the middle is swallowed by a library that is being loaded, which then warns of itself."""
    with stoppable() as between:
        between()
        signal.raise_signal(number)
        with pytest.raises(RunStopped) as stopped:
            between()
    assert stopped.value.exit_code == 128 + number


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


# An installation that cannot be written to, used without a home.
@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """Return a folder with the package in it, none of which can be written."""
    folder = tmp_path / "installed"
    shutil.copytree(Path(rubnoise.__file__).parent, folder / "rubnoise", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    return folder


def test_a_run_works_where_kernels_cannot_be_kept(here: Path, installed: Path, unprivileged: tuple[str, ...]) -> None:
    environment = {name: text for name, text in os.environ.items() if not name.startswith(("NUMBA_", "XDG_"))}
    environment |= {"PYTHONPATH": str(installed), "HOME": str(installed / "nobody")}
    here.joinpath("where.py").write_text("import rubnoise.api\nprint(rubnoise.__file__)", encoding="utf-8")
    told = subprocess.run(
        [*unprivileged, sys.executable, "where.py"], env=environment, capture_output=True, text=True, check=False
    )
    assert told.stdout.startswith(str(installed)), told.stderr
    run = [sys.executable, "-m", "rubnoise", "run", "../given/contact.toml", "-o"]
    done = subprocess.run([*unprivileged, *run, "x.h5"], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1), done.stderr
    assert done.stderr.startswith("Compiling the kernels")
    assert (here / "x.h5").stat().st_size > 10_000
    assert not [path for path in installed.rglob("*") if path.suffix in {".pyc", ".nbi", ".nbc"}]


def test_a_folder_that_cannot_be_written_is_refused(here: Path, installed: Path, unprivileged: tuple[str, ...]) -> None:
    run = [sys.executable, "-m", "rubnoise", "run", "../given/contact.toml", "-o", str(installed / "x.h5")]
    done = subprocess.run([*unprivileged, *run], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{installed}: the folder is not writable\n"
