"""A column on its way to disk: the same bytes and the same hash however it is written."""

from pathlib import Path
from tempfile import TemporaryFile

import numpy as np
import pytest
import xxhash
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.storage import columns, disk
from rubnoise.storage.columns import ColumnFile, Mark
from rubnoise.storage.layout import Place

ROWS = 300
VALUES = np.random.default_rng(5).normal(size=ROWS)
PLACE = Place(offset=40, rows=ROWS, dtype="<f8")


def hash_of(rows: int) -> bytes:
    return xxhash.xxh3_128(VALUES[:rows].tobytes()).digest()


def filled(file: ColumnFile, *borders: int) -> None:
    for first, last in zip((file.rows_written, *borders), borders, strict=False):
        file.write(first, VALUES[first:last])


@settings(max_examples=150, deadline=None)
@given(
    borders=st.lists(st.integers(0, ROWS), max_size=12).map(sorted),
    piece=st.sampled_from((8, 16, 104, 800, 1 << 19)),
    flushes=st.sets(st.integers(0, 12)),
    hashed=st.booleans(),
)
def test_pieces_and_flushes_change_nothing(borders: list[int], piece: int, flushes: set[int], *, hashed: bool) -> None:
    with pytest.MonkeyPatch.context() as patch, TemporaryFile() as target:
        patch.setattr(columns, "PIECE_BYTES", piece)
        file = ColumnFile(target.fileno(), PLACE, hashed=hashed)
        for number, (first, last) in enumerate(zip([0, *borders], [*borders, ROWS], strict=True)):
            file.write(first, VALUES[first:last])
            if number in flushes:
                file.flush()
                assert file.mark(last) == Mark(rows=last, digest=hash_of(last))
        assert file.digest() == hash_of(ROWS).hex()
        target.seek(40)
        assert target.read() == VALUES.tobytes()


def test_few_large_writes_reach_the_system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []
    whole = disk.write_all

    def noted(descriptor: int, data: memoryview, offset: int) -> None:
        sizes.append(len(data))
        whole(descriptor, data, offset)

    monkeypatch.setattr(disk, "write_all", noted)
    monkeypatch.setattr(columns, "PIECE_BYTES", 800)
    with (tmp_path / "x").open("w+b") as target:
        file = ColumnFile(target.fileno(), PLACE)
        filled(file, *range(7, 140, 7))
        file.write(133, VALUES[133:])
        file.flush()
    # What is as large as a piece passes as it is, and before it what waits.
    assert sizes == [800, 264, 1336]


@given(marked=st.integers(0, 200), rows=st.integers(0, 200))
def test_a_mark_may_lie_before_what_was_written(marked: int, rows: int) -> None:
    marked, rows = sorted((marked, rows))
    with TemporaryFile() as target:
        file = ColumnFile(target.fileno(), PLACE)
        filled(file, marked)
        file.mark(marked)
        filled(file, 250)
        assert file.mark(rows) == Mark(rows=rows, digest=hash_of(rows))
        assert file.mark(250) == Mark(rows=250, digest=hash_of(250))


def test_a_row_replaced_is_in_every_later_mark(tmp_path: Path) -> None:
    with (tmp_path / "x").open("w+b") as target:
        file = ColumnFile(target.fileno(), PLACE)
        file.write(0, np.zeros(100))
        before = file.mark(100)
        file.write(0, VALUES[:100])
        assert before != file.mark(100) == Mark(rows=100, digest=hash_of(100))
        filled(file, 200)
        assert file.mark(150) == Mark(rows=150, digest=hash_of(150))
        assert file.mark(200) == Mark(rows=200, digest=hash_of(200))


@settings(max_examples=60, deadline=None)
@given(changed=st.integers(0, ROWS), at=st.lists(st.integers(0, 250), min_size=1, max_size=6).map(sorted))
def test_a_column_found_again_fits_its_marks_up_to_a_changed_row(changed: int, at: list[int]) -> None:
    marks = [Mark(rows=rows, digest=hash_of(rows)) for rows in at]
    with TemporaryFile() as target:
        target.write(b"\0" * 40 + VALUES.tobytes())
        target.seek(40 + 8 * changed)
        target.write(b"\xff")
        target.flush()
        file = ColumnFile(target.fileno(), PLACE)
        fitting = sum(rows <= changed for rows in at)
        assert file.matching(marks) == fitting
        for rows in {at[fitting - 1], at[0]} if fitting else {0}:
            file.go_on_from(rows)
            assert file.rows_written == rows
            file.write(rows, VALUES[rows:])
            assert file.digest() == hash_of(ROWS).hex()


@pytest.mark.parametrize("rows", [(ROWS + 1,), (20, 10)])
def test_marks_that_cannot_be_fit_nothing_from_there_on(tmp_path: Path, rows: tuple[int, ...]) -> None:
    with (tmp_path / "x").open("w+b") as target:
        target.write(b"\0" * 40 + VALUES.tobytes())
        target.flush()
        marks = [Mark(rows=count, digest=hash_of(count)) for count in rows]
        assert ColumnFile(target.fileno(), PLACE).matching(marks) == len(rows) - 1
