"""A little of what `tools/survive.py` tries, and proof that the script would notice what is lost."""

from dataclasses import replace
from pathlib import Path

import pytest
from survival import full, kills, moments
from survival.recording import Recording
from survival.stories import SHORT, SMALL, Story, growing, of_kind

from rubnoise.storage import disk, resume, writer
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.journal import Journal
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.part import Part
from rubnoise.storage.writer import RunWriter

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="the scripts read what Linux tells")
BARE, COMPRESSED = SMALL[2], SMALL[3]
WITH_SLIDER, MOVING = SMALL[0], replace(SHORT[0], distance="10 mm")
SHORTEST = replace(SHORT[2], distance="10 mm")


def test_kills_lose_nothing() -> None:
    outcome = kills.kills(6, seed=3, stories=(SHORTEST,))
    assert outcome.findings == []
    assert outcome.counts["kills"] == 6
    assert outcome.counts["commits"] > 0


def test_commits_that_are_forgotten_are_found_by_kills(monkeypatch: pytest.MonkeyPatch) -> None:
    go_on_from = Part.go_on_from
    monkeypatch.setattr(Part, "go_on_from", lambda part, _commits: go_on_from(part, []))
    outcome = kills.kills(6, seed=3, stories=(SHORTEST,))
    assert any("had been committed, and it continued from 0" in finding for finding in outcome.findings)


@pytest.mark.parametrize("story", [BARE, COMPRESSED], ids=lambda story: story.name)
def test_a_run_goes_on_from_between_its_writes(story: Story) -> None:
    outcome = moments.writes(1, seed=3, stories=(story,), every=17)
    assert outcome.findings == []
    assert outcome.counts["stopped after a call"] > 10
    assert outcome.counts["stopped in the middle of a write"] > 5


def test_last_changes_that_the_journal_does_not_hold_are_found_by_stopping(monkeypatch: pytest.MonkeyPatch) -> None:
    append = Journal.append

    def without_the_end(self: Journal, kind: str, content: bytes, *, durable: bool) -> None:
        if kind != "end":
            append(self, kind, content, durable=durable)  # type: ignore[arg-type]

    monkeypatch.setattr(Journal, "append", without_the_end)
    assert any("x.h5.part: damaged" in finding for finding in moments.writes(1, 3, (BARE,), last=14).findings)


def test_power_cuts_lose_nothing_that_was_committed() -> None:
    outcome = moments.power(24, seed=3, stories=(BARE, COMPRESSED))
    assert outcome.findings == []
    assert outcome.counts["continued by run"] > 0 < outcome.counts["continued by resume"]


@pytest.mark.parametrize(
    ("call", "said"),
    [("sync_rows", "had been committed"), ("sync", "x.h5.part: "), ("sync_folder", "published, and is gone")],
)
def test_a_call_that_never_reaches_the_disk_is_found_by_power_cuts(
    monkeypatch: pytest.MonkeyPatch, call: str, said: str
) -> None:
    recorded = moments.recorded

    def forgetting(story: Story, seconds: float) -> Recording:
        recording = recorded(story, seconds=seconds)
        recording.calls = [
            ("note", "left out", n) if each[0] == call else each for n, each in enumerate(recording.calls)
        ]
        return recording

    monkeypatch.setattr(moments, "recorded", forgetting)
    assert any(said in finding for finding in moments.power(30, seed=3, stories=(BARE,)).findings)


def test_bits_that_turn_get_no_final_name() -> None:
    outcome = moments.flips(12, seed=3, stories=(BARE, COMPRESSED))
    assert outcome.findings == []
    assert outcome.counts["published"] > 0 < outcome.counts["whole: exit code 2"]


def test_a_gate_that_lets_all_pass_is_found_by_bits_that_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    def summary(path: Path) -> list[range]:
        place = path.read_bytes().find(b"real_contact_area_mean")
        return [range(max(place, 0), max(place, 0) + 100)]

    monkeypatch.setattr(moments, "_metadata", summary)
    monkeypatch.setattr("rubnoise.api.resuming._check", lambda _: None)
    monkeypatch.setattr(resume, "check_structure", lambda _: None)
    assert any("published, and verify says 2" in finding for finding in moments.flips(9, 3, (BARE,)).findings)


def test_a_disk_that_fails_leaves_one_line_and_the_older_result() -> None:
    outcome = full.full(2, seed=3, stories=(BARE,), every=127)
    assert outcome.findings == []
    assert outcome.counts["EIO: exit code 1"] > 0 < outcome.counts["ENOSPC: exit code 1"]


def test_an_older_result_that_goes_too_early_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def removing(paths: OutputPaths, _checked: int, *, force: bool, durable: bool) -> None:
        disk.remove(paths.final)
        disk.rename(paths.part, paths.final)

    monkeypatch.setattr(writer, "give_final_name", removing)
    calls = full.calls_of(moments.Stage(name="run", story=BARE, files={}))
    outcome = full.full(0, seed=3, stories=(BARE,), calls=range(calls - 4, calls))
    assert any("the result is gone" in finding for finding in outcome.findings)


def test_signals_leave_something_to_go_on_with() -> None:
    outcome = kills.signals(6, seed=3, stories=(SHORTEST,))
    assert outcome.findings == []


def test_a_part_that_is_not_kept_is_found_by_signals(monkeypatch: pytest.MonkeyPatch) -> None:
    def discarding(self: RunWriter) -> None:
        disk.remove(self._paths.part)

    monkeypatch.setattr(RunWriter, "_discard", discarding)
    outcome = kills.signals(8, seed=3, stories=(SHORTEST,))
    assert any("no part is there, and it said stopped" in finding for finding in outcome.findings)


def test_rows_that_grow_beside_a_part_are_no_more_easily_lost() -> None:
    with growing((WITH_SLIDER, MOVING)):
        outcome = moments.writes(1, seed=3, stories=(WITH_SLIDER,), every=61)
        outcome.add(moments.power(8, seed=3, stories=(WITH_SLIDER,)))
        outcome.add(moments.flips(9, seed=3, stories=(WITH_SLIDER,)))
        outcome.add(full.full(1, seed=3, stories=(WITH_SLIDER,), every=199))
        outcome.add(kills.kills(4, seed=3, stories=(MOVING,)))
    assert outcome.findings == []
    assert outcome.counts["commits"] > 0 < outcome.counts["stopped in the middle of a write"]


def test_a_slider_that_pushes_back_is_no_more_easily_lost() -> None:
    small, moving = of_kind("two-way", (WITH_SLIDER, MOVING))
    outcome = kills.kills(4, seed=3, stories=(moving,))
    outcome.add(moments.power(8, seed=3, stories=(small,)))
    assert outcome.findings == []
    assert outcome.counts["commits"] > 0
    assert {"landmarks/kind", "slider/phase"} <= moving.expected.keys()
    assert of_kind("two-way", (BARE,)) == ()


def test_runs_off_the_centre_line_are_no_more_easily_lost() -> None:
    (moving,) = of_kind("off-centre", (MOVING,))
    outcome = kills.kills(4, seed=3, stories=(moving,))
    assert outcome.findings == []
    assert outcome.counts["commits"] > 0
    assert "junctions/lateral_offset" in moving.expected.keys() - MOVING.expected.keys()


def test_a_slider_that_leaves_its_contact_is_no_more_easily_lost() -> None:
    small, moving = of_kind("free", (SMALL[0], replace(MOVING, distance="4 mm")))
    outcome = kills.kills(4, seed=3, stories=(moving,))
    outcome.add(moments.power(8, seed=3, stories=(small,)))
    assert outcome.findings == []
    assert outcome.counts["commits"] > 0
    assert {"landmarks/impact_speed", "junctions/encounter", "load/separation"} <= moving.expected.keys()


def test_runs_of_other_births_lives_and_sizes_are_no_more_easily_lost() -> None:
    stories = of_kind("family", (MOVING,))
    assert len({story.expected["junctions/birth_distance"] for story in stories}) == len(stories)
    outcome = kills.kills(len(stories), seed=3, stories=stories)
    assert outcome.findings == []
    assert outcome.counts["commits"] > 0


def test_runs_under_a_load_are_no_more_easily_lost() -> None:
    small, moving = of_kind("under-load", (WITH_SLIDER, MOVING))
    outcome = kills.kills(4, seed=3, stories=(moving,))
    outcome.add(moments.power(8, seed=3, stories=(small,)))
    assert outcome.findings == []
    assert outcome.counts["commits"] > 0
    assert {"load/separation", "load/velocity", "load/load"} <= moving.expected.keys()
    batch = replace(moving, engine="batch")
    assert {name: each for name, each in batch.expected.items() if "/" in name} == {
        name: each for name, each in moving.expected.items() if "/" in name
    }


def test_growing_rows_that_never_reach_the_disk_are_found_by_power_cuts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(GrowingFile, "sync", lambda _: None)
    with growing((WITH_SLIDER,)):
        outcome = moments.power(30, seed=3, stories=(WITH_SLIDER,))
    assert any("had been committed" in finding for finding in outcome.findings)
