"""Journals of sweeps: what was written down of a run is read back, and a damaged line is noticed."""

import tracemalloc
from math import inf, pi
from pathlib import Path

import numpy as np
import pytest
import xxhash

from rubnoise.sweep import journal as journals
from rubnoise.sweep.journal import JournalEntry, RunRow, entries, numbered
from rubnoise.sweep.journal import SweepJournal as RunJournal

# What was written down of a run is read back as it was, whatever happened to the file's end.
FIGURES = {"real_contact_area_mean": pi, "real_contact_area_std": 0.1 + 0.2, "far": 1e-300}
DONE = JournalEntry(
    run_id="0123456789abcdef", state="done", row=RunRow(run_id="0123456789abcdef", file="runs/a.h5", figures=FIGURES)
)
FAILED = JournalEntry(run_id="fedcba9876543210", state="failed", reason='no room: "a\nb" \u00b5')


def _written(path: Path, *told: JournalEntry) -> bytes:
    with RunJournal(path) as journal:
        for entry in told:
            journal.add(entry)
    return path.read_bytes()


def test_entries_come_back_to_the_last_bit(tmp_path: Path) -> None:
    _written(tmp_path / "j", DONE, FAILED)
    assert list(entries(tmp_path / "j")) == [DONE, FAILED]
    assert list(entries(tmp_path / "absent")) == []


def test_arrays_come_back_too(tmp_path: Path) -> None:
    arrays = {"spectrum": np.array([1.5, np.nan, inf]), "counts": np.arange(6, dtype=np.int64).reshape(2, 3)}
    row = RunRow(run_id="a", arrays=arrays, of_point={"place": np.linspace(0.0, 1.0, 3)})
    _written(tmp_path / "j", JournalEntry(run_id="a", state="done", row=row))
    [found] = entries(tmp_path / "j")
    assert found.row is not None
    for kept, asked in ((found.row.arrays, row.arrays), (found.row.of_point, row.of_point)):
        assert kept.keys() == asked.keys()
        for name, values in asked.items():
            assert kept[name].dtype == values.dtype
            assert np.array_equal(kept[name], values, equal_nan=values.dtype.kind == "f")


def test_a_journal_cut_anywhere_loses_nothing_but_its_last_entry_and_can_be_continued(tmp_path: Path) -> None:
    whole = _written(tmp_path / "j", DONE, FAILED)
    first = whole.index(b"\n") + 1
    for end in range(first, len(whole)):
        (path := tmp_path / "cut").write_bytes(whole[:end])
        # Of the last line nothing but its end is missing at most.
        assert list(entries(path)) == ([DONE, FAILED] if end == len(whole) - 1 else [DONE])
        _written(path, FAILED)
        assert list(entries(path))[-1] == FAILED
        assert next(iter(entries(path))) == DONE


@pytest.mark.parametrize("place", [0, 5, 17, 30])
def test_a_changed_byte_is_noticed(tmp_path: Path, place: int) -> None:
    whole = bytearray(_written(tmp_path / "j", DONE, FAILED))
    whole[place] ^= 1
    (tmp_path / "j").write_bytes(whole)
    assert list(entries(tmp_path / "j")) == [FAILED]


def test_a_bit_that_turned_is_told_from_a_line_that_was_cut_short(tmp_path: Path) -> None:
    """In any byte of a line that another one follows."""
    whole = _written(tmp_path / "j", FAILED, DONE)
    end = whole.index(b"\n")
    for place in range(8 * end):
        turned = bytearray(whole)
        turned[place // 8] ^= 1 << place % 8
        (tmp_path / "j").write_bytes(turned)
        assert "damaged" in [entry for _, entry in journals.numbered(tmp_path / "j")], place
    for kept in range(1, end):
        (tmp_path / "j").write_bytes(whole[:kept] + b"\n" + whole[end + 1 :])
        assert [entry for _, entry in journals.numbered(tmp_path / "j")] == ["cut short", DONE], kept


def test_a_line_without_an_end_is_read_in_pieces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "LINE_BYTES", 1 << 16)
    path = tmp_path / "runs.jsonl"
    _written(path, JournalEntry(run_id="a", state="failed", reason="x"))
    with path.open("ab") as stream:
        stream.truncate(1 << 24)
    tracemalloc.start()
    assert [entry.run_id for entry in entries(path)] == ["a"]
    assert tracemalloc.get_traced_memory()[1] < 1 << 20
    tracemalloc.stop()


OTHER_SHAPES = (
    "1", "[]", "{}", "null", '{"run": "a"}', '{"run": 1, "state": "failed"}', '{"run": "../a", "state": "begun"}',
    '{"run": "a", "state": "lost"}', '{"run": "a", "state": "done"}', '{"run": "a", "state": "begun", "stamp": 1}',
    '{"run": "a", "state": "done", "file": "/etc/passwd", "figures": {}}',
    '{"run": "a", "state": "done", "file": "", "figures": {"seed": 1.0}}',
    '{"run": "a", "state": "done", "file": "", "figures": {"x": "1.0"}}',
    '{"run": "a", "state": "done", "file": "", "figures": {"x": 1%s}}' % ("0" * 400),
    '{"run": "a", "state": "done", "file": "", "figures": {}, "arrays": {"x": ["O", [1], ""]}}',
    "[" * 100_000,
)  # fmt: skip


@pytest.mark.parametrize("text", OTHER_SHAPES, ids=lambda text: text[:70])
def test_a_line_of_another_shape_is_damaged_whatever_its_checksum(tmp_path: Path, text: str) -> None:
    path, digest = tmp_path / "j", xxhash.xxh3_64_hexdigest(text.encode())
    path.write_bytes(_written(path, FAILED) + f"{digest} {text}\n".encode())
    assert list(numbered(path)) == [(1, FAILED), (2, "damaged")]


def test_a_disk_that_is_full_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_descriptor: int, _data: memoryview) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(journals.disk, "append_all", full)
    with RunJournal(tmp_path / "j") as journal, pytest.raises(OSError, match=r"No space left on device: '.*/j'"):
        journal.add(FAILED)
