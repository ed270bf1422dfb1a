"""The first steps: a demo of one contact, keys without their table, a sweep of any scenario, and what to call next."""

from pathlib import Path

import pytest

import rubnoise
from rubnoise.cli.make import FILES
from tests.shell.terminal import call

pytestmark = pytest.mark.slow


def test_a_demo_makes_all_its_files_and_may_be_made_again(here: Path) -> None:
    answer = call("demo", "shown", "--no-open")
    assert answer.code == 0, answer.err
    assert sorted(each.name for each in Path("shown").iterdir()) == sorted(FILES)
    assert [line.split(":")[0] for line in answer.out.splitlines()] == [f"shown/{name}" for name in FILES]
    with rubnoise.open("shown/rubbing.h5") as run:
        assert run.scenario.title in Path("shown/rubbing.html").read_text(encoding="utf-8")
        assert run.compare().passed
    assert call("demo", "shown", "--no-open", "-q").out == ""


def test_a_demo_leaves_a_folder_of_something_else_alone(here: Path) -> None:
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("mine", encoding="utf-8")
    answer = call("demo", "mine", "--no-open")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "mine: holds notes.txt, which no demo makes; name another folder\n"
    assert [each.name for each in Path("mine").iterdir()] == ["notes.txt"]


def test_a_run_ends_with_what_to_call_next(here: Path) -> None:
    words = ("run", "first/rubbing", "--set", "distance=1mm", "--set", "speed=40mm/s", "-o", "a b.h5")
    answer = call(*words)
    assert answer.code == 0, answer.err
    assert [line.split()[1:] for line in answer.out.splitlines()[-3:]] == [
        [each, "'a", "b.h5'"] for each in ("plot", "page", "junctions")
    ]
    with rubnoise.open("a b.h5") as run:
        assert (run.scenario.sliding.speed, run.scenario.sliding.distance) == (40_000.0, 1000.0)
    assert call(*words, "--force", "-q").out == ""


def test_any_scenario_becomes_a_sweep_over_keys(here: Path) -> None:
    over = ("--over", "speed=5,10,20mm/s", "--over", 'diameter.law=["normal", "gamma"]')
    answer = call("sweep", "first/rubbing", "--set", "distance=200um", *over, "-o", "swept", "-j", "1")
    assert answer.code == 0, answer.err
    with rubnoise.open_sweep("swept") as swept:
        assert swept.keys == ("sliding.speed", "diameter.law")
        assert sorted(set(swept.runs["sliding.speed"])) == [5000.0, 10_000.0, 20_000.0]
        assert swept.count("done") == 6
    for wrong in ("speed", "speed=", "sped=1,2"):
        refused = call("sweep", "first/rubbing", "--over", wrong)
        assert (refused.code, "Traceback" in refused.err) == (2, False)
