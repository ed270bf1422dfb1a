"""The four stories of a result, and proof that `tools/survive.py` would notice what is lost.

Killed at random moments, written by a second process, on a disk that fails at any call, and on one that fills up.
"""

import time
from pathlib import Path
from typing import Any

import pytest
from survive import FREE, SLIDER, SMALL, TWO_WAY, Story, calls_of, failing, filling, kills, rivals

from rubnoise.storage import output
from rubnoise.storage.output import PartFile
from rubnoise.storage.writer import RunWriter
from tests.frozen import examples

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the scripts read what Linux tells"),
]
KILLED = (
    Story(name="events with slider", sections=SLIDER, engine="events", distance="10 mm", tick="1 um"),
    Story(name="compressed", compression="gzip", distance="20 mm", tick="1 um"),
    Story(name="two-way", sections=TWO_WAY, distance="6 mm", tick="1 um"),
    Story(name="free", sections=FREE, speed="1 m/s", distance="20 mm", tick="10 um"),
)
BARE = Story(name="contact alone")


def test_forty_kills_leave_no_incomplete_result_and_the_same_command_gives_the_bits() -> None:
    outcome = kills(40, seed=3, stories=KILLED)
    assert outcome.findings == []
    assert outcome.counts["exit code -9"] > 8
    assert outcome.counts["left a part"] > 2


def test_a_final_name_before_the_end_is_found_by_kills(monkeypatch: pytest.MonkeyPatch) -> None:
    begin, _ = RunWriter._begin, KILLED[0].expected

    def early(self: RunWriter, *given: Any) -> None:
        begin(self, *given)
        (self._part.final).write_bytes(b"half of a result")
        time.sleep(2.0)  # most of the run, so that a kill finds it on a busy machine too

    monkeypatch.setattr(RunWriter, "_begin", early)
    findings = kills(4, seed=3, stories=KILLED[:1]).findings
    assert any("under the final name: unreadable" in finding for finding in findings)


def test_rivals_are_refused_while_the_first_continues() -> None:
    outcome = rivals(8, seed=3, stories=KILLED)
    assert outcome.findings == []
    assert outcome.counts["second refused"] > 4


def test_two_writers_at_once_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "_wait_for_lock", lambda _descriptor: None)
    assert rivals(3, seed=3, stories=KILLED[:1]).findings


@pytest.mark.parametrize("story", [BARE, *SMALL], ids=lambda story: story.name)
def test_a_call_that_fails_leaves_one_line_and_the_older_result(story: Story) -> None:
    outcome = failing((story,), every=examples(41, 13))
    assert outcome.findings == []
    assert outcome.counts["exit code 2"] > 2 < outcome.counts["exit code 1"]


def test_an_older_result_that_goes_too_early_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    finish = PartFile.finish

    def removing(self: PartFile) -> None:
        self.final.unlink(missing_ok=True)
        finish(self)

    monkeypatch.setattr(PartFile, "finish", removing)
    calls = calls_of(BARE, older=True)
    outcome = failing((BARE,), every=len(calls), first=calls.index("fsync"))
    assert any("the older result is gone" in finding for finding in outcome.findings)


def test_a_disk_that_fills_up_leaves_one_line_and_the_older_result() -> None:
    outcome = filling(12, seed=3)
    assert outcome.findings == []
    if "filled up: exit code 0" in outcome.counts:
        assert outcome.counts["filled up: exit code 1"] + outcome.counts["filled up: exit code 2"] > 0
