"""`rubnoise resume`, and `run` and `info` on a run that did not finish."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rubnoise.storage import writer
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.resume import examined
from tests.cli.terminal import Answer, call, columns, names, spawn_program, start, stop
from tests.pages.reading import answer as answer_of_page
from tests.pages.reading import data_of

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


def test_run_is_quiet_about_it_when_asked_to(here: Path, part: Path, whole: dict[str, bytes]) -> None:
    assert call("run", SLIDER, "-o", "x.h5", *SHORT, "-q") == Answer(code=0, out="", err="")
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


@pytest.mark.parametrize("words", [("compare",), ("junctions",), ("plot",), ("export", "--to", "csv"), ("listen",)])
def test_other_commands_want_the_whole_result(here: Path, part: Path, words: tuple[str, ...]) -> None:
    answer = call(words[0], part.name, *words[1:])
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "x.h5.part: unfinished; rubnoise resume x.h5.part continues it\n"
    assert names(here) == ["x.h5.part", "x.h5.part.journal"]


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


def test_a_second_is_what_a_power_cut_may_cost() -> None:
    assert writer.COMMIT_SECONDS == 1.0
