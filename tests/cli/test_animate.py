"""`rubnoise animate`: a run as a film."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.terminal import begin, call, names, stop

CONTACT = Path("../given/contact.toml")
SHORT = ("--seconds", "0.4", "--fps", "5")


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", CONTACT, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def _pictures(path: Path) -> tuple[int, tuple[int, int]]:
    with Image.open(path) as gif:
        return gif.n_frames, gif.size


def test_a_gif_is_made_where_nothing_is_said(result: Path, here: Path) -> None:
    answer = call("animate", "x.h5", *SHORT)
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.startswith("x.gif: 2 frames, 0 to 32.8634 um of sliding, ")
    assert _pictures(here / "x.gif") == (2, (960, 540))
    assert names(here) == ["x.gif", "x.h5"]


def test_a_stretch_is_chosen_in_um_or_with_units(result: Path, here: Path) -> None:
    for name, stretch in (
        ("a.gif", ("--from", "50", "--to", "90")),
        ("b.gif", ("--from", "0.05 mm", "--to", "90 um")),
        ("c.gif", ("--from", "50", "--to", "91")),
    ):
        answer = call("animate", "x.h5", "-o", name, *stretch, *SHORT)
        assert answer.code == 0
        assert f"{name}: 2 frames, 50 to 9" in answer.out
    first, same, other = ((here / name).read_bytes() for name in ("a.gif", "b.gif", "c.gif"))
    assert first == same
    assert first != other


def test_a_file_is_replaced_only_by_force(result: Path, here: Path) -> None:
    (here / "x.gif").write_bytes(b"precious")
    answer = call("animate", "x.h5", *SHORT)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith("x.gif: exists already (--force replaces it)\n")
    assert (here / "x.gif").read_bytes() == b"precious"
    assert call("animate", "x.h5", "--force", *SHORT).code == 0
    assert (here / "x.gif").read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("-o", "x.avi"), "x.avi ends neither in .gif nor in .mp4"),
        (("-o", "none/x.gif"), "no such folder"),
        (("--from", "x"), "--from: x: not a number and a unit"),
        (("--from", "400"), "x.h5: nothing lies in 400 to 300 um; the run goes from 0 to 300 um"),
        (("--seconds", "0"), "Invalid value for '--seconds'"),
        (("--fps", "60"), "Invalid value for '--fps'"),
        (("--seconds", "600"), "600 s at 20 frames a second are 12,000 frames; 2 to 1,000 can be made"),
    ],
)
def test_what_cannot_be_drawn_is_refused(result: Path, here: Path, arguments: tuple[str, ...], said: str) -> None:
    answer = call("animate", "x.h5", *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert said in " ".join(answer.err.replace("│", " ").split())
    assert names(here) == ["x.h5"]


def test_without_ffmpeg_an_mp4_is_refused(result: Path, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(here))
    answer = call("animate", "x.h5", "-o", "x.mp4")
    said = "an mp4 needs ffmpeg, which is not installed here; a gif needs nothing more\n"
    assert (answer.code, answer.out, answer.err) == (2, "", said)


def test_without_matplotlib_it_is_told_what_to_install(
    result: Path, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    answer = call("animate", "x.h5")
    assert (answer.code, answer.out) == (2, "")
    assert "tools/dev.py sync" in answer.err.replace("'", "")
    assert names(here) == ["x.h5"]


def test_a_signal_leaves_nothing_behind(result: Path, here: Path) -> None:
    drawing: subprocess.Popen[str] = begin("animate", "x.h5", "--seconds", "50", part=here / ".x.gif.lock")
    answer = stop(drawing, signal.SIGINT)
    assert (answer.code, answer.err) == (130, "stopped by a signal; nothing was kept\n")
    assert names(here) == ["x.h5"]
