"""What is left when writing, printing or reading fails, on other systems and in tampered folders."""

import errno
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.errors import RubnoiseError
from rubnoise.simulation import ticks
from rubnoise.storage import disk
from rubnoise.storage.output import NO_LOCKS
from tests.cli.tampered import TABLE, tampered
from tests.cli.terminal import CONTACT, WITH_SLIDER, call, command, names, start
from tests.frozen import examples

# What is left when writing, printing or reading fails: one line, an exit code, no half file.
SHORT = Path("../given/contact.toml")


def _failing_after(writes: int) -> Callable[..., None]:
    """Return a replacement of the call that writes rows, which finds the disk broken after so many large pieces."""
    write, seen = disk.write_all, []

    def failing(descriptor: int, data: memoryview, offset: int) -> None:
        seen.append(len(data))
        if sum(size > 16_384 for size in seen) > writes:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        write(descriptor, data, offset)

    return failing


@pytest.fixture
def many_panels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a run reach the disk in many pieces."""
    monkeypatch.setattr(ticks, "LARGEST_TICK_RANGE", 4096)


@pytest.mark.usefixtures("many_panels")
@pytest.mark.parametrize("writes", [0, 2])
def test_a_disk_that_breaks_in_the_middle_leaves_nothing(
    here: Path, monkeypatch: pytest.MonkeyPatch, writes: int
) -> None:
    monkeypatch.setattr(disk, "write_all", _failing_after(writes))
    answer = call("run", SHORT, "--set", "sliding.distance=20 mm")
    assert (answer.code, answer.out) == (1, "")
    assert answer.err == f"{here / 'contact.h5'}: writing failed: Input/output error\n"
    assert names(here) == []


@pytest.mark.usefixtures("many_panels")
def test_a_disk_that_breaks_in_the_middle_leaves_an_older_result(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (here / "contact.h5").write_bytes(b"precious")
    monkeypatch.setattr(disk, "write_all", _failing_after(1))
    assert call("run", SHORT, "--force", "--set", "sliding.distance=20 mm").code == 1
    assert (here / "contact.h5").read_bytes() == b"precious"
    assert names(here) == ["contact.h5"]


def test_a_reader_that_leaves_early_is_no_failure_worth_a_traceback(here: Path) -> None:
    assert call("run", SHORT).code == 0
    shown = start(command("info", "contact.h5"), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert shown.stdout is not None
    shown.stdout.close()
    _, said = shown.communicate(timeout=60)
    assert said == b""
    assert shown.returncode == 1


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "asked", [("theory", SHORT, "--json"), ("check", SHORT), ("schema",)], ids=lambda words: words[0]
)
def test_a_command_ends_silently_in_a_pipe_that_head_has_closed(
    here: Path, asked: tuple[str | Path, ...], unbuffered: str
) -> None:
    shown = start(command(*asked), {"PYTHONUNBUFFERED": unbuffered}, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert shown.stdout is not None
    os.read(shown.stdout.fileno(), 100)
    shown.stdout.close()
    assert shown.communicate(timeout=60)[1] == b""
    assert shown.returncode in {0, 1}  # a short answer may be in the pipe before


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
def test_an_output_that_is_full_is_told_in_a_line(here: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = start(command("check", SHORT), stdout=full, stderr=subprocess.PIPE, text=True)
    _, said = done.communicate()
    assert (done.returncode, said) == (1, "output: No space left on device\n")


def test_names_that_a_terminal_cannot_show_are_escaped(here: Path) -> None:
    done = subprocess.run(
        command("check", SHORT, "--set", "title=friction of µm"),
        capture_output=True,
        check=False,
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert rb"friction of \xb5m" in done.stdout


@pytest.mark.parametrize("asked", ["run", "check"])
def test_a_result_in_place_of_a_scenario_is_told_so(here: Path, asked: str) -> None:
    (here / "run.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100_000))
    answer = call(asked, "run.h5")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "run.h5: is a result, not a scenario; rubnoise info run.h5 says what is in it\n"


# What needs no lock works on a system that has no more than Windows; a sweep is refused there in one sentence.
WITHOUT = """
import importlib.abc, mmap, os, shutil, signal, socket, subprocess, sys, tempfile, threading
import multiprocessing.connection
import platformdirs.unix  # which pint takes for the right one, as sys.platform stays what it is

usage = shutil.disk_usage(".")
shutil.disk_usage = lambda path: usage

REFUSED = {"fcntl", "grp", "posix_ipc", "pty", "pwd", "resource", "syslog", "termios", "tty"}

class Refusing(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name in REFUSED:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Refusing())
for name in REFUSED & set(sys.modules):
    del sys.modules[name]
for name in (
    "O_CLOEXEC O_DIRECTORY O_NOCTTY O_NOFOLLOW O_NONBLOCK O_SYNC O_DSYNC WIFSIGNALED WTERMSIG chown confstr"
    " confstr_names fchdir fchmod fchown fdatasync fork forkpty fpathconf getegid geteuid getgid getloadavg getpgid"
    " getpgrp getuid killpg lockf mkfifo mknod nice pathconf posix_fadvise posix_fallocate posix_spawn pread preadv"
    " pwrite pwritev sched_getaffinity sched_yield sendfile setsid statvfs fstatvfs sync sysconf sysconf_names"
    " wait3 wait4"
).split():
    if hasattr(os, name):
        delattr(os, name)
for name in "SIGALRM SIGBUS SIGCHLD SIGHUP SIGKILL SIGPIPE SIGQUIT SIGTSTP SIGUSR1 SIGUSR2 SIGXCPU SIGXFSZ".split():
    delattr(signal, name)
for name in ("pthread_sigmask", "setitimer", "alarm", "sigwait"):
    delattr(signal, name)
for name in ("AF_UNIX", "send_fds", "recv_fds"):
    delattr(socket, name)
"""

CALLS = """
import contextlib, io, json
from rubnoise.cli.app import main

answers = []
for words in json.loads(sys.stdin.read()):
    out, err, sys.argv = io.StringIO(), io.StringIO(), ["rubnoise", *words]
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
        except SystemExit as ended:
            code = ended.code or 0
    answers.append((code, out.getvalue(), err.getvalue()))
print(json.dumps(answers))
"""

READING = """
import json, rubnoise
from concurrent.futures import ThreadPoolExecutor

def looked(_):
    with rubnoise.open("slider.h5") as run:
        return [len(run.junctions), run.junction(3).area([20.0, 40.0]).tolist(), float(run.trace["friction_force"][7])]

one, two = ThreadPoolExecutor(2).map(looked, range(2))
kept = rubnoise.simulate("slider.toml")
refused = []
for what in (lambda: rubnoise.open("cut.h5"),):
    try:
        what()
    except rubnoise.Refused as refusal:
        refused.append(str(refusal))
print(json.dumps([one, two, [len(kept.junctions), *looked(0)[1:]], refused]))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scenario, its result, and a part of one, made where there are locks."""
    folder = tmp_path_factory.mktemp("posix")
    (folder / "slider.toml").write_text(WITH_SLIDER)
    (folder / "sweep.toml").write_text(WITH_SLIDER + "\n[sweep]\nreplicates = 2\n")
    rubnoise.run(folder / "slider.toml", folder / "slider.h5").close()
    (folder / "lesson.html.part").touch()  # as a copied folder may have one
    (folder / "cut.h5").write_bytes((folder / "slider.h5").read_bytes()[:5000])
    return folder


def without(program: str, folder: Path, given: Any = None) -> Any:
    """Return what a program prints, as JSON, in a process that has neither the modules nor the names of POSIX."""
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT + program],
        cwd=folder,
        env=os.environ | {"MPLBACKEND": "Agg"},
        input=json.dumps(given),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


ALIKE: Sequence[Sequence[str]] = (
    ("theory", "slider.toml", "--json"),
    ("info", "slider.h5", "--json"),
    ("info", "cut.h5"),
    ("compare", "slider.h5", "--json"),
    ("junctions", "slider.h5", "--json"),
    ("junction", "slider.h5", "3", "--json"),
    ("infer", "slider.h5", "--json"),
    ("check", "slider.toml", "--set", "sliding.speed=no"),
)
WRITING: Sequence[Sequence[str]] = (
    ("teach", "slider.toml", "-o", "lesson.html"),
    ("view", "slider.h5", "-o", "view.html"),
    ("export", "slider.h5", "--group", "trace", "--to", "csv", "-o", "trace.csv"),
    ("new", "mine.toml"),
)
REFUSED: Sequence[Sequence[str]] = (("sweep", "sweep.toml", "-o", "swept"),)


def _rounded(text: str) -> str:
    """Leave six digits of the numbers: sums of linear algebra round as memory lies, and a fit ends where they do."""
    return re.sub(r"-?\d+\.\d+(?:e[-+]\d+)?", lambda number: f"{float(number[0]):.6g}", text)


def test_commands_answer_as_with_posix_and_sweeps_are_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    check = ("check", "slider.toml", "--json")
    answers = without(CALLS, folder, [check, *ALIKE, *WRITING, *WRITING[:1], *REFUSED])
    code, out, err = answers.pop(0)
    assert (code, err) == (0, "")
    assert json.loads(out)["scenarios"]["slider.toml"]["cost"]["junctions"] > 0
    for words, answer in zip(ALIKE, answers, strict=False):
        here = call(*words)
        assert [answer[0], _rounded(answer[1]), answer[2]] == [here.code, _rounded(here.out), here.err], words
    del answers[: len(ALIKE)]
    for words, (code, _, err) in zip(WRITING, answers, strict=False):
        assert (code, err) == (0, ""), words
        name = words[-1]
        written = (folder / name).read_bytes()
        (folder / name).unlink()
        assert call(*words).code == 0
        assert written == (folder / name).read_bytes(), name
    (code, _, err), *refused = answers[len(WRITING) :]
    assert (code, err) == (2, f"{folder}/lesson.html: exists already (--force replaces it)\n")
    for words, (code, out, err) in zip(REFUSED, refused, strict=True):
        assert (code, out) == (2, ""), words
        assert err.splitlines()[-1] == f"{words[-1]}: {NO_LOCKS}"
    left = {"cut.h5", "lesson.html", "mine.toml", "slider.h5", "slider.toml", "sweep.toml", "trace.csv", "view.html"}
    assert {path.name for path in folder.iterdir()} == left


def test_results_are_read_in_threads_and_runs_are_kept_in_memory(folder: Path) -> None:
    one, two, kept, refused = without(READING, folder)
    with rubnoise.open(folder / "slider.h5") as run:
        area = run.junction(3).area([20.0, 40.0]).tolist()
        assert one == two == kept == [len(run.junctions), area, float(run.trace["friction_force"][7])]
    cut = "cut.h5: cut short; copy it again, or run its scenario again"
    assert refused == [cut]


# Whatever a folder of a sweep says, every command answers in a sentence: no internal error, no memory for nothing.
SWEEPS = {"runs": CONTACT + TABLE, "summary": CONTACT + TABLE.replace("replicates", 'keep = "summary"\nreplicates')}
COMMANDS: dict[str, tuple[str, ...]] = {
    "info": ("info", "d"),
    "info --json": ("info", "d", "--json"),
    "info --figures": ("info", "d", "--figures", "real_contact_area_std", "--over", "interface.mean_junction_count=10"),
    "verify": ("verify", "d"),
    "sweep": ("sweep", "s.toml", "-o", "d", "--jobs", "1"),
    "xarray": (),
    "plot": ("plot", "d", "-o", "d.svg"),
    "view": ("view", "d", "-o", "d.html"),
    "report": ("report", "d", "-o", "d.html"),
}
PICTURES = ("plot", "view", "report")
"""Commands that take some seconds."""

CASES = [
    pytest.param(keep, name, seed, id=f"{name}-{keep}-{seed}")
    for keep in SWEEPS
    for name in COMMANDS
    for seed in range(examples(1, 6) if name in PICTURES else examples(5, 24))
]


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a sweep of each kind."""
    place = tmp_path_factory.mktemp("sweeps")
    for keep, text in SWEEPS.items():
        (place / keep).mkdir()
        (place / keep / "s.toml").write_text(text, encoding="utf-8")
        assert call("sweep", place / keep / "s.toml", "-o", place / keep / "d", "--jobs", "1", "-q").code == 0
    return place


@pytest.mark.parametrize(("keep", "name", "seed"), CASES)
def test_a_sweep_that_was_tampered_with_is_answered_in_a_sentence(
    folders: Path, tmp_path: Path, keep: str, name: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(folders / keep, tmp_path / keep)
    monkeypatch.chdir(tmp_path / keep)
    what = tampered(Path("d"), seed)
    if name == "xarray":
        _ask_from_python(what)
        return
    answer = call(*COMMANDS[name])
    assert answer.code in {0, 1, 2, 3}, what
    assert not re.search("internal error|Traceback|out of memory", answer.err), f"{what}: {answer.err}"
    if answer.code in {1, 2}:
        assert 1 <= answer.err.count("\n") <= 6, f"{what}: {answer.err}"
        assert len(answer.err) < 1500, what
        assert not any(Path().glob("d.*")), what


def _ask_from_python(what: str) -> None:
    try:
        with rubnoise.open_sweep("d") as sweep:
            repr(sweep)
            assert sweep.to_xarray().sizes["replicate"] <= len(sweep.runs), what
            for figure in sweep.figures:
                sweep.estimates(figure)
            for point in range(len(sweep.points)):
                sweep.scenario(point)
            assert len(sweep.failures) <= len(sweep.runs), what
    except RubnoiseError as refused:
        assert str(refused).startswith("d"), what  # noqa: PT017
