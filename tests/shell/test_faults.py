"""Every command beside every fault of what it reads and where it writes: one line with the path, and nothing made."""

import fcntl
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
import pytest
from typer.main import get_command

from rubnoise.cli.app import EARLIER, program
from tests.architecture.sources import ROOT
from tests.shell.terminal import WITH_SLIDER, call, names, start
from tests.shell.terminal import command as words_of

READERS = {
    "info": (),
    "junction": ("0",),
    "junctions": (),
    "compare": (),
    "verify": (),
    "plot": (),
    "listen": (),
    "page": (),
    "report": (),
    "export": ("--to", "csv"),
}
"""Commands that read a result and nothing else, with the words behind its path."""

OF_SWEEPS = ("info", "plot", "page", "report")
"""Those that take the folder of a sweep, too."""

WRITERS = {
    "run": ("scenario.toml", "-o", "{}"),
    "new": ("{}",),
    "plot": ("good.h5", "-o", "{}"),
    "listen": ("good.h5", "-o", "{}"),
    "page": ("good.h5", "-o", "{}"),
    "export": ("good.h5", "--to", "csv", "--group", "trace", "-o", "{}"),
    "teach": ("scenario.toml", "-o", "{}"),
    "theory": ("scenario.toml", "--plot", "{}"),
    "junction": ("good.h5", "0", "--plot", "{}"),
}
ENDINGS = {
    "run": "h5",
    "new": "toml",
    "listen": "wav",
    "export": "csv",
    "teach": "html",
    "page": "html",
}


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("good")
    (folder / "scenario.toml").write_text(WITH_SLIDER, encoding="utf-8")
    assert call("run", folder / "scenario.toml", "-o", folder / "good.h5", "-q").code == 0
    return folder


@pytest.fixture
def place(good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a folder with a scenario and a good result."""
    for name in ("scenario.toml", "good.h5"):
        (tmp_path / name).write_bytes((good / name).read_bytes())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def newer(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format_version", 99)
        file.attrs["source"] = np.bytes_("rubnoise 9.9")


def foreign(path: Path, _content: bytes) -> None:
    with h5py.File(path, "w") as file:
        file["values"] = np.arange(5.0)


def behind_a_file(path: Path, _content: bytes) -> None:
    path.parent.joinpath("file").touch()
    path.symlink_to("file/run.h5")


FAULTS: dict[str, tuple[Callable[[Path, bytes], object], str]] = {
    "missing": (lambda _path, _content: None, "no such file or directory"),
    "empty": (lambda path, _: path.touch(), "is empty; "),
    "text": (lambda path, _: path.write_text("distance,area\n" * 100), "is not an HDF5 file; "),
    "cut short": (lambda path, content: path.write_bytes(content[: len(content) // 2]), "cut short; "),
    "foreign": (foreign, "is an HDF5 file, but not one of rubnoise"),
    "newer": (newer, "rubnoise 9.9 or later is needed"),
    "damaged": (lambda path, content: path.write_bytes(content[:200] + bytes(3000) + content[3200:]), "damaged: "),
    "folder": (lambda path, _: path.mkdir(), "is not a regular file"),
    "pipe": (lambda path, _: os.mkfifo(path), "is not a regular file"),
    "device": (lambda path, _: path.symlink_to("/dev/zero"), "is not a regular file"),
    "loop": (lambda path, _: path.symlink_to(path), "too many levels of symbolic links"),
    "behind a file": (behind_a_file, "not a directory"),
}


CASES = [(command, fault) for command in READERS for fault in FAULTS if fault != "folder" or command not in OF_SWEEPS]


def _refused(place: Path, name: str, command: str, fault: str, *words: str) -> None:
    """Put a fault in the place of what a command reads, and see it refused in a line."""
    spoil, said = FAULTS[fault]
    spoil(place / name, (place / "good.h5").read_bytes())
    before = names(place)
    answer = call(command, name, *words)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith(f"{name}: ")
    # A folder may be that of a sweep, which verify looks into.
    assert ("is not a sweep folder" if (fault, command) == ("folder", "verify") else said) in answer.err
    assert answer.err.count("\n") == 1
    assert names(place) == before


@pytest.mark.parametrize(("command", "fault"), CASES)
def test_what_is_no_result_is_refused_in_a_line(place: Path, command: str, fault: str) -> None:
    _refused(place, "bad.h5", command, fault, *READERS[command])


NOT_REPLACED = "exists already; choose another name"
"""What `new`, which replaces nothing, says in place of the first and of those about what is no file."""

PLACES: dict[str, tuple[Callable[[Path], object], str]] = {
    "exists": (lambda path: path.write_bytes(b"precious"), "exists already (--force replaces it)"),
    "no folder": (lambda path: path.parent.rmdir(), "no such folder"),
    "folder": (lambda path: path.mkdir(), "exists and is not a regular file"),
    "pipe": (os.mkfifo, "exists and is not a regular file"),
    "link": (lambda path: path.symlink_to("elsewhere"), "exists and is not a regular file"),
    "device": (lambda path: path.symlink_to("/dev/null"), "exists and is not a regular file"),
    "file for a folder": (lambda path: (path.parent.rmdir(), path.parent.touch()), "no such folder"),
}


def _words(command: str) -> list[str]:
    name = f"there/out.{ENDINGS.get(command, 'png')}"
    return [command, *(word.format(name) for word in WRITERS[command])]


@pytest.mark.parametrize("fault", PLACES)
@pytest.mark.parametrize("command", WRITERS)
def test_where_nothing_may_be_written_is_told_in_a_line(place: Path, command: str, fault: str) -> None:
    (place / "there").mkdir()
    words = _words(command)
    path = place / next(word for word in words if word.startswith("there/"))
    spoil, expected = PLACES[fault]
    spoil(path)
    before = names(place), names(path.parent) if path.parent.is_dir() else []
    answer = call(*words)
    assert (answer.code, answer.out) == (2, "")
    assert (NOT_REPLACED if command == "new" and expected.startswith("exists") else expected) in answer.err
    assert "there" in answer.err.partition(": ")[0]
    assert answer.err.count("\n") == 1
    assert (names(place), names(path.parent) if path.parent.is_dir() else []) == before


@contextmanager
def _held(path: Path) -> Iterator[None]:
    """Hold the part of an output, as another process that writes it would."""
    part = path.with_name(f"{path.name}.part")
    with part.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
    part.unlink()


@pytest.mark.slow("teach", "theory")
@pytest.mark.parametrize("command", WRITERS)
def test_a_second_writer_is_refused(place: Path, command: str) -> None:
    (place / "there").mkdir()
    words = _words(command)
    path = place / next(word for word in words if word.startswith("there/"))
    with _held(path):
        answer = call(*words)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith(f"{path}: another process is writing it\n")
    assert names(place / "there") == []


@pytest.mark.slow("teach", "theory", "junction")
@pytest.mark.parametrize("command", WRITERS)
def test_what_is_there_is_replaced_only_by_force(place: Path, command: str) -> None:
    """The control of the tests above, too: the same words write where nothing is in the way."""
    (place / "there").mkdir()
    words = _words(command)
    path = place / next(word for word in words if word.startswith("there/"))
    assert call(*words).code == 0
    assert names(place / "there") == [path.name]
    path.write_bytes(b"precious")
    assert call(*words).code == 2
    assert path.read_bytes() == b"precious"
    if command != "new":
        assert call(*words, "--force").code == 0
        assert path.stat().st_size > 100


DRAWING = {
    "plot": ("good.h5",),
    "junction": ("good.h5", "0", "--plot"),
    "theory": ("scenario.toml", "--plot"),
}


@pytest.mark.parametrize("command", DRAWING)
def test_without_matplotlib_nothing_is_drawn(place: Path, command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    before = names(place)
    answer = call(command, *DRAWING[command])
    assert (answer.code, answer.out, names(place)) == (2, "", before)
    assert "tools/dev.py sync" in answer.err.replace("'", "")


@pytest.mark.parametrize("command", [name for name in READERS if name != "report"])
def test_what_is_unfinished_is_refused(place: Path, command: str) -> None:
    (place / "good.h5").rename(place / "x.h5.part")
    with h5py.File(place / "x.h5.part", "r+") as file:
        file["provenance"].attrs["finished"] = np.bytes_(b"\0")
    before = names(place)
    answer = call(command, "x.h5.part", *READERS[command])
    assert (answer.code, answer.out, names(place)) == (2, "", before)
    assert answer.err == "x.h5.part: is a part of a run that did not end; the same command makes the run again\n"


@pytest.mark.parametrize("command", OF_SWEEPS)
def test_a_folder_without_an_index_is_no_sweep(place: Path, command: str) -> None:
    (place / "sweep").mkdir()
    answer = call(command, "sweep")
    assert (answer.code, answer.err) == (2, "sweep: no folder of a sweep: it has no index.h5\n")
    os.mkfifo(place / "sweep" / "index.h5")
    answer = call(command, "sweep")
    assert (answer.code, answer.err) == (2, "sweep/index.h5: is not a regular file\n")


SCENARIO_READERS = {"check": (), "run": (), "theory": (), "sweep": (), "teach": ("-o", "out.html")}
"""Commands that read a scenario, with the words behind its path."""


def test_every_command_that_reads_a_file_is_tried() -> None:
    reads = {}
    for name, each in get_command(program()).commands.items():  # type: ignore[attr-defined]
        first = next((given.metavar for given in each.params if given.param_type_name == "argument"), "")
        reads[name] = first.split("|")[0]
    assert {name for name, what in reads.items() if what == "RUN.h5"} == {*READERS} - {*EARLIER}
    assert {name for name, what in reads.items() if what == "FILE"} == {*SCENARIO_READERS} - {*EARLIER}


@pytest.mark.parametrize("fault", ["missing", "folder", "pipe", "device", "loop", "behind a file"])
@pytest.mark.parametrize("command", SCENARIO_READERS)
def test_what_is_no_scenario_is_refused_in_a_line(place: Path, command: str, fault: str) -> None:
    _refused(place, "bad.toml", command, fault, *SCENARIO_READERS[command])


KERNEL_LOG = Path("/proc/kmsg")
"""A regular file by its type, whose reader waits for the kernel to write something."""


def _kernel_log_opens() -> bool:
    try:
        os.close(os.open(KERNEL_LOG, os.O_RDONLY | os.O_NONBLOCK))
    except OSError:
        return False
    return True


@pytest.mark.skipif(not _kernel_log_opens(), reason="the log of the kernel cannot be opened here")
@pytest.mark.parametrize("command", ["check", "info"])
def test_a_file_that_never_ends_is_refused(place: Path, command: str) -> None:
    with start(words_of(command, KERNEL_LOG), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as asked:
        try:
            said = asked.communicate(timeout=60)
        finally:
            asked.kill()
    assert (asked.returncode, *said) == (2, "", f"{KERNEL_LOG}: is not a regular file\n")
    (place / "bad.toml").write_text(f'format = 1\nextends = "{KERNEL_LOG}"\n')
    assert f"extends: {KERNEL_LOG}: is not a regular file\n" in call("check", "bad.toml").err


CALLS = """
import json, sys
from tests.shell.terminal import call
answers = [call(*words) for words in json.loads(sys.argv[1])]
print(json.dumps([(answer.code, answer.out, answer.err) for answer in answers]))
"""


@pytest.mark.slow
def test_what_may_not_be_read_is_refused_in_a_line(place: Path, unprivileged: tuple[str, ...]) -> None:
    """Both where a file is closed and where its folder is; for each command that reads, and for parts and sweeps."""
    closed = place / "closed"
    closed.mkdir()
    for name in ("good.h5", "scenario.toml"):
        (place / name).chmod(0o000)
        (closed / name).write_bytes(b"")
    (place / "good.h5.part").touch(0o000)
    (place / "sweep").mkdir(0o000)
    (place / "extending.toml").write_text('format = 1\nextends = "scenario.toml"\n')
    closed.chmod(0o000)
    calls = [[name, f"{where}good.h5", *READERS[name]] for name in READERS for where in ("", "closed/")]
    calls += [[name, f"{where}scenario.toml", *SCENARIO_READERS[name]] for name in ("check", "run", "theory")
              for where in ("", "closed/")]  # fmt: skip
    calls += [["info", "good.h5.part"], ["info", "closed/good.h5.part"]]
    calls += [[name, "sweep"] for name in ("info", "plot", "verify")]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [*unprivileged, sys.executable, "-c", CALLS, json.dumps(calls)],
        capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    for path in (closed, place / "sweep"):
        path.chmod(0o755)
    assert done.returncode == 0, done.stderr
    for words, (code, out, err) in zip(calls, json.loads(done.stdout), strict=True):
        assert (code, out) == (2, ""), words
        assert err.startswith(words[1]), words
        assert err.endswith(": permission denied\n"), words
        assert err.count("\n") == 1, words
