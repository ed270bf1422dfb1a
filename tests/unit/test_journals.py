"""Journals: records are whole or not there at all, and what was written of a run is read back."""

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.errors import RunFileRefused
from rubnoise.simulation.state import LiveRows, State
from rubnoise.storage import journal
from rubnoise.storage.columns import Mark
from rubnoise.storage.journal import (
    VERSION,
    Frame,
    History,
    Journal,
    frames,
    identity,
    packed_commit,
    packed_run,
    state_at,
)
from tests.format.runs import describe

# Records of a journal: whole or not there at all.
CONTENTS = (b"", b"x", b"some rows", bytes(range(256)) * 3)
NAMES = [("junctions", "junction"), ("trace", "distance")]


def written(path: Path, size: int = 0) -> list[int]:
    """Write a journal with all contents, and return where each record ends."""
    journal = Journal(path, b"first", size)
    ends = []
    for content in CONTENTS:
        journal.append("rows", content, durable=False)
        ends.append(path.stat().st_size)
    journal.close()
    return ends


def told(path: Path) -> list[bytes]:
    return [frame.content for frame in frames(path)]


def test_records_come_back_in_their_order(tmp_path: Path) -> None:
    ends = written(tmp_path / "j")
    assert told(tmp_path / "j") == [b"first", *CONTENTS]
    assert [frame.end for frame in frames(tmp_path / "j")][1:] == ends
    assert [frame.kind for frame in frames(tmp_path / "j")] == ["run"] + ["rows"] * len(CONTENTS)


def test_nothing_is_created_before_there_is_something_to_say(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "j", b"first")
    assert not journal.begun
    journal.close()
    assert not (tmp_path / "j").exists()
    assert told(tmp_path / "j") == []


def test_a_record_cut_at_any_byte_was_never_written(tmp_path: Path) -> None:
    ends = written(tmp_path / "j")
    whole = (tmp_path / "j").read_bytes()
    for size in range(len(whole)):
        (tmp_path / "cut").write_bytes(whole[:size])
        assert len(told(tmp_path / "cut")) == (size >= ends[0] - 24) + sum(end <= size for end in ends)


@settings(max_examples=200, deadline=None)
@given(place=st.integers(0, 10**6), bit=st.integers(0, 7))
def test_a_changed_bit_ends_the_journal_before_its_record(
    tmp_path_factory: pytest.TempPathFactory, place: int, bit: int
) -> None:
    path = tmp_path_factory.mktemp("journal") / "j"
    ends = written(path)
    whole = bytearray(path.read_bytes())
    whole[place % len(whole)] ^= 1 << bit
    path.write_bytes(whole)
    good = sum(end <= place % len(whole) for end in ends)
    assert told(path) == ([b"first", *CONTENTS[:good]] if place % len(whole) >= ends[0] - 24 else [])


def test_one_goes_on_behind_what_is_good(tmp_path: Path) -> None:
    ends = written(tmp_path / "j")
    with (tmp_path / "j").open("ab") as stream:
        stream.write(b"rnj1rows torn")
    journal = Journal(tmp_path / "j", b"first", ends[1])
    assert journal.begun
    assert (tmp_path / "j").stat().st_size == ends[1]
    journal.append("end", b"the end", durable=True)
    journal.close()
    assert list(frames(tmp_path / "j"))[-1] == Frame(kind="end", content=b"the end", end=ends[1] + 24 + 7)
    assert told(tmp_path / "j") == [b"first", *CONTENTS[:2], b"the end"]


def test_a_journal_begun_anew_forgets_the_old_one(tmp_path: Path) -> None:
    (tmp_path / "j").write_bytes(b"whatever" * 100)
    written(tmp_path / "j")
    assert told(tmp_path / "j") == [b"first", *CONTENTS]


def state(block: int) -> State:
    return State(
        block=block, begin=1.0, next_birth=2.0, junctions=3 * block, ticks=2 * block, events=0, live=LiveRows.none(),
        slider_rows=2 * block, displacement=0.1, velocity=-0.0,
    )  # fmt: skip


def commits(path: Path, count: int) -> None:
    journal = Journal(path, packed_run(describe(), NAMES))
    for block in range(1, count + 1):
        marks = [Mark(rows=rows * block, digest=bytes([block % 256]) * 16) for rows in (3, 2)]
        journal.append("rows", packed_commit(marks, state(block)), durable=False)
    journal.close()


def test_history_tells_of_run_commits_and_states(tmp_path: Path) -> None:
    commits(tmp_path / "j", 3)
    found = History.read(tmp_path / "j")
    assert found.run == identity(describe())
    assert [commit.marks[NAMES[1]].rows for commit in found.commits] == [2, 4, 6]
    assert [state_at(tmp_path / "j", commit).pack() for commit in found.commits] == [state(n).pack() for n in (1, 2, 3)]
    assert found.commits[-1].end == (tmp_path / "j").stat().st_size
    assert found.ending is None
    assert History.read(tmp_path / "missing") == History()


def test_of_commits_long_ago_every_other_one_is_forgotten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "MOST_COMMITS", 20)
    commits(tmp_path / "j", 100)
    blocks = [state_at(tmp_path / "j", commit).block for commit in History.read(tmp_path / "j").commits]
    assert 10 < len(blocks) <= 20
    assert blocks[-10:] == list(range(91, 101))
    assert blocks == sorted(blocks)


def test_what_does_not_begin_as_a_journal_tells_nothing(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "j", b"{}")
    journal.append("rows", b"x", durable=False)
    journal.close()
    whole = (tmp_path / "j").read_bytes()
    (tmp_path / "headless").write_bytes(whole[26:])
    assert History.read(tmp_path / "headless") == History()
    (tmp_path / "foreign").write_bytes(b"rows of somebody else\n" * 9)
    assert History.read(tmp_path / "foreign") == History()


def test_a_journal_of_another_version_is_refused(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "j", json.dumps({"version": VERSION + 1}).encode())
    journal.append("rows", b"x", durable=False)
    journal.close()
    with pytest.raises(RunFileRefused, match=f"has version {VERSION + 1}; this rubnoise resumes version {VERSION}"):
        History.read(tmp_path / "j")


def test_runs_are_told_from_each_other() -> None:
    assert identity(describe()) == identity(describe())
    others = [describe(8), describe(7, 12), describe(blocks=4)]
    assert len({identity(each) for each in [describe(), *others]}) == 4
