"""Columns on their way to disk and back, and the schema that names them."""

from pathlib import Path
from tempfile import TemporaryFile

import numpy as np
import pytest
import xxhash
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.record.rows import JunctionState
from rubnoise.record.sink import Extent
from rubnoise.simulation.coupled import layout
from rubnoise.simulation.free.motion import CONTACT_LOST, CONTACT_MADE
from rubnoise.storage import columns, disk
from rubnoise.storage.columns import ColumnFile, Mark
from rubnoise.storage.layout import STRUCTURE_BYTES, ByteRange, expected_bytes, row_count, stored_columns, stored_groups
from rubnoise.storage.life_curve import CURVE_ROWS, TABLE_ROWS
from rubnoise.storage.schema import (
    BLOCKS,
    GROUPS,
    JUNCTIONS,
    LANDMARKS,
    LIFE_CURVE,
    LIFE_TABLE,
    SLIDER,
    TRACE,
    Feature,
    Group,
)

# A column on its way to disk: the same bytes and the same hash however it is written.
ROWS = 300
VALUES = np.random.default_rng(5).normal(size=ROWS)
PLACE = ByteRange(offset=40, rows=ROWS, dtype="<f8")


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


# The schema is the contract on names, types and what is present when.
ALWAYS = {
    "junctions": ["junction", "birth_distance", "death_distance", "life_distance", "diameter", "max_area", "state"],
    "trace": ["distance", "real_contact_area", "junction_count"],
    "blocks": ["block", "birth_distance", "first_junction", "first_tick"],
    "life_curve": ["u", "area_fraction"],
}


def stored_with(*features: Feature) -> dict[str, list[str]]:
    given = frozenset(features)
    return {group.name: [column.name for column in stored_columns(group, given)] for group in stored_groups(given)}


def test_a_bare_contact_has_no_times_no_force_and_no_slider() -> None:
    assert stored_with() == ALWAYS


def test_a_speed_adds_times() -> None:
    times = ["birth_time", "death_time"]
    assert stored_with("speed")["junctions"] == [*ALWAYS["junctions"][:-1], *times, "state"]
    assert stored_with("speed")["trace"] == ALWAYS["trace"]


def test_a_strength_adds_strengths_and_force() -> None:
    assert stored_with("strength")["junctions"] == [*ALWAYS["junctions"][:-1], "shear_strength", "state"]
    assert stored_with("strength")["trace"] == [*ALWAYS["trace"], "friction_force"]


def test_a_slider_adds_its_motion() -> None:
    whole = stored_with("speed", "strength", "slider")
    assert whole["slider"] == ["time", "distance", "friction_force", "displacement", "velocity"]
    assert whole["blocks"] == [*ALWAYS["blocks"], "displacement", "velocity"]
    assert "slider" not in stored_with("speed", "strength")


def test_offsets_add_themselves_and_a_table_in_place_of_the_curve() -> None:
    aside = stored_with("offset")
    assert aside["junctions"] == [*ALWAYS["junctions"][:5], "lateral_offset", *ALWAYS["junctions"][5:]]
    assert aside["life_table"] == ["u", "offset_fraction", "area_fraction"]
    assert set(aside) == {*ALWAYS, "life_table"} - {"life_curve"}


def test_two_ways_add_phases_landmarks_and_how_the_slider_comes_to_blocks() -> None:
    whole, one_way = stored_with("speed", "strength", "slider", "two-way"), stored_with("speed", "strength", "slider")
    assert whole["slider"] == [*one_way["slider"], "phase"]
    assert whole["landmarks"] == [
        "landmark", "time", "distance", "kind", "displacement", "velocity", "force_before", "force_after",
    ]  # fmt: skip
    assert whole["balance"] == [
        "time", "distance", "displacement", "velocity", "time_stuck", "displacement_integral",
        "displacement_squared_integral", "velocity_squared_integral", "friction_work", "reverse_work",
    ]  # fmt: skip
    assert whole["blocks"] == [*ALWAYS["blocks"], "time", "distance", "phase", "displacement", "velocity"]
    assert not {"landmarks", "balance"} & set(one_way)


def test_names_are_unique_and_texts_are_there() -> None:
    for group in GROUPS:
        names = [column.name for column in group.columns]
        assert len(set(names)) == len(names)
        assert group.plotted in names[1:]
        assert all(column.units and column.long_name and column.symbol for column in group.columns)


def test_every_column_has_the_unit_of_its_quantity() -> None:
    """Of what a column is, told by its symbol: a length in um is an area in um^2 when it is squared, and so on."""
    units = {
        "um": {"s", "s_birth", "s_death", "L_j", "d", "b", "x", "y", "z", "delta", "delta_max"},
        "um^2": {"A_r", "A_jmax"},
        "um/s": {"x'", "z'", "v_imp"},
        "s": {"t", "t_birth", "t_death", "t_stick"},
        "um*s": {"I_x"},
        "um^2*s": {"I_xx"},
        "um^2/s": {"I_vv"},
        "uN*um": {"W", "W_-"},
        "MPa": {"psi"},
        "uN": {"F_s", "F_-", "F_+", "P"},
        "1": {"i", "j", "state", "N_j", "k", "j_0", "i_0", "u", "b/d", "a", "n", "phase", "kind"},
    }
    found: dict[str, set[str]] = {}
    for group in GROUPS:
        for column in group.columns:
            found.setdefault(column.units, set()).add(column.symbol)
    assert found == units


def test_types_are_little_endian_numbers() -> None:
    types = {column.dtype for group in GROUPS for column in group.columns}
    assert types == {"<f8", "<i8", "<u4", "|u1"}


def test_values_are_those_of_the_motion() -> None:
    (phase,) = (column for column in SLIDER.columns if column.name == "phase")
    assert dict(phase.values) == {layout.SLIP: "slip", layout.STUCK: "stick", layout.REVERSED: "reversal"}
    (kind,) = (column for column in LANDMARKS.columns if column.name == "kind")
    assert dict(kind.values) == {
        layout.STICK: "stick", layout.BREAKAWAY: "slip", layout.REVERSAL: "reversal", layout.FORWARD: "forward",
        CONTACT_LOST: "contact_lost", CONTACT_MADE: "contact_made",
    }  # fmt: skip


def test_flags_are_the_states_of_the_record() -> None:
    (state,) = (column for column in JUNCTIONS.columns if column.name == "state")
    assert dict(state.flags) == {member.value: (member.name or "").lower() for member in JunctionState if member.value}


@pytest.mark.parametrize(
    ("group", "rows"),
    [(JUNCTIONS, 3), (TRACE, 5), (SLIDER, 4), (BLOCKS, 2), (LIFE_CURVE, CURVE_ROWS), (LIFE_TABLE, TABLE_ROWS)],
)
def test_rows_follow_the_extent(group: Group, rows: int) -> None:
    assert row_count(group, Extent(junctions=3, ticks=5, blocks=2, slider=4)) == rows


def test_bytes_are_those_of_the_columns() -> None:
    features: frozenset[Feature] = frozenset(("speed", "strength", "slider"))
    grown = expected_bytes(Extent(junctions=1001, ticks=501, blocks=21, slider=301), features) - expected_bytes(
        Extent(junctions=1, ticks=1, blocks=1, slider=1), features
    )
    assert grown == 1000 * (9 * 8 + 1) + 500 * (3 * 8 + 4) + 300 * (5 * 8) + 20 * (6 * 8)
    curve = CURVE_ROWS * 2 * np.dtype("<f8").itemsize
    assert expected_bytes(Extent(junctions=0, ticks=0, blocks=0, slider=None), features) == STRUCTURE_BYTES + curve
