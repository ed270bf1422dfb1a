"""What is left when writing, printing or reading fails: one line, an exit code, no half file."""

import errno
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from rubnoise.simulation import ticks
from rubnoise.storage.part import Part
from tests.cli.terminal import call, command, names, start

SHORT = Path("../given/contact.toml")


def _failing_after(writes: int) -> Callable[..., None]:
    """Return a replacement of Part.write that finds the disk broken after so many writes of the trace."""
    write, seen = Part.write, []

    def failing(self: Part, group: str, *rows: object) -> None:
        seen.append(group)
        if seen.count("trace") > writes:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        write(self, group, *rows)  # type: ignore[arg-type]

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
    monkeypatch.setattr(Part, "write", _failing_after(writes))
    answer = call("run", SHORT, "--set", "sliding.distance=20 mm")
    assert (answer.code, answer.out) == (1, "")
    assert answer.err == f"{here / 'contact.h5'}: writing failed: Input/output error\n"
    assert names(here) == []


@pytest.mark.usefixtures("many_panels")
def test_a_disk_that_breaks_in_the_middle_leaves_an_older_result(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (here / "contact.h5").write_bytes(b"precious")
    monkeypatch.setattr(Part, "write", _failing_after(1))
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
