"""Results of every kind are verified, and none that has been changed is, down to one bit of one value."""

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from shutil import copy
from time import process_time
from typing import Any

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.runs.verification import Verification, verify
from rubnoise.simulation.draws import births_per_block
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import HASH
from tests.unit.tampering import LOADED, ONE_WAY, TWO_WAY, Kind, flip, forget, put, run_of, scenario_of, tell

SPEED = 1000.0
EVERY: dict[str, Kind] = {
    **{f"one-way, {name}": kind for name, kind in ONE_WAY.items()},
    **LOADED,
    **{f"two-way, {name}": kind for name, kind in TWO_WAY.items()},
}
ALIKE = {"hashes", "structure", "attributes", "summary"}
"""Checks of every file; beside them it has one for each group that is played."""


def asked(path: Path) -> Verification:
    with open_run(path) as run:
        return verify(run)


def failing(path: Path) -> list[str]:
    return [check.name for check in asked(path).different]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("verification")


def fresh(kept: Path, tmp_path: Path, name: str) -> Path:
    """Return a copy of the result of a kind, which is run once."""
    original = kept / f"{list(EVERY).index(name)}.h5"
    if not original.exists():
        left_out, changes = EVERY[name]
        run_of(original, *left_out, **changes)
    return Path(copy(original, tmp_path / "x.h5"))


@pytest.fixture
def result(kept: Path, tmp_path: Path) -> Path:
    return fresh(kept, tmp_path, "one-way, everything")


@pytest.fixture
def two_way(kept: Path, tmp_path: Path) -> Path:
    return fresh(kept, tmp_path, "two-way, figure 5")


@pytest.mark.slow("regular", "strengths", "damped", "unequal", "load", "few and", "off", "Rayleigh", "two-way, gzip")
@pytest.mark.parametrize("name", EVERY)
def test_a_right_result_of_every_kind_is_verified(kept: Path, tmp_path: Path, name: str) -> None:
    path = fresh(kept, tmp_path, name)
    found = asked(path)
    assert [str(check.first) for check in found.different] == []
    assert (found.left_out, found.remark) == ({}, "")
    with h5py.File(path) as file:
        groups = {group for group in file if len(file[group])}
    assert {check.name for check in found.checks} == ALIKE | groups
    assert {"junctions", "trace"} <= groups


def columns_of(path: Path) -> list[str]:
    with open_run(path) as run:
        return [f"{group}/{name}" for group, names in run.columns.items() for name in names]


def middle(path: Path, column: str) -> int:
    with h5py.File(path) as file:
        return int(file[column].size) // 2


@pytest.mark.slow("one-way, off the centre line")
@pytest.mark.parametrize("kind", ["one-way, everything", "one-way, off the centre line", "two-way, figure 5"])
def test_a_unit_in_the_last_place_of_any_column_is_seen_though_its_hash_is_right(
    kept: Path, tmp_path: Path, kind: str
) -> None:
    path = fresh(kept, tmp_path, kind)
    columns = columns_of(path)
    for number, column in enumerate(columns):
        flip(path, column, max(middle(path, column) - number % 3, 0))
    found = {check.name: check for check in asked(path).different}
    assert "hashes" not in found
    counted = Counter(each.partition("/")[0] for each in columns)
    assert {name: found[name].different for name in counted} == counted
    assert counted >= Counter({"junctions": 10, "trace": 4, "slider": 5})


@pytest.mark.parametrize(
    ("column", "row", "value"),
    [
        ("junctions/birth_distance", 900, 1e3),
        ("junctions/birth_distance", 900, float("nan")),
        ("junctions/birth_distance", 3, -1e3),
        ("junctions/diameter", 900, -1.0),
        ("junctions/diameter", 900, float("inf")),
        ("junctions/death_distance", 900, float("-inf")),
        ("junctions/shear_strength", 900, 0.0),
        ("junctions/state", 900, 2),
        ("junctions/state", 900, 4),
        ("junctions/state", 900, 8),
        ("trace/real_contact_area", 700, float("nan")),
        ("trace/friction_force", 700, float("inf")),
        ("trace/junction_count", 700, 4_000_000_000),
        ("slider/displacement", 700, float("nan")),
        ("slider/velocity", 1400, 1e300),
    ],
)
def test_what_cannot_be_is_told_and_breaks_nothing(result: Path, column: str, row: int, value: float) -> None:
    put(result, column, row, value)
    found = {each.name: str(each.first) for each in asked(result).different}
    assert found.get(column.partition("/")[0], "").startswith(f"/{column} row {row} is ")


def resize(path: Path, group: str, by: int) -> int:
    """Take rows from the end of a group, or put its last one there again; return how many it has then."""
    with h5py.File(path, "r+") as file:
        for name in list(file[group]):
            values, attributes = file[group][name][:], dict(file[group][name].attrs)
            values = values[:by] if by < 0 else np.append(values, np.repeat(values[-1:], by))
            del file[group][name]
            made = file[group].create_dataset(name, data=values)
            for key, value in attributes.items():
                if key not in {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}:
                    made.attrs[key] = value
        return int(values.size)


def test_a_row_less_of_a_load_is_named(kept: Path, tmp_path: Path) -> None:
    path = fresh(kept, tmp_path, "under a load, without a slider")
    rows = resize(path, "load", -1)
    found = {check.name: str(check.first) for check in asked(path).different}
    assert found["structure"].startswith(f"/load/time is dataset, <f8, [{rows}], ")


@pytest.mark.parametrize("group", ["junctions", "slider", "landmarks"])
@pytest.mark.parametrize("by", [-1, 1])
def test_a_row_more_or_less_is_named(two_way: Path, group: str, by: int) -> None:
    rows = resize(two_way, group, by)
    found = {check.name: check for check in asked(two_way).different}
    assert str(found[group].first).startswith(f"/{group} rows is {rows}, should be ")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("seed", 2),
        ("seed", "one\x1b[2J"),
        ("calibrated_diameter", 5.5),
        ("propagator_constants", "{}"),
        ("propagator_constants", "[]"),
        ("propagator_constants", "no JSON"),
    ],
)
def test_an_origin_that_is_not_that_of_the_scenario_is_told(result: Path, name: str, value: object) -> None:
    tell(result, "provenance", name, value)
    (check,) = asked(result).different
    assert str(check.first).startswith(f"/provenance {name}")


def resolved(path: Path, table: str, **values: object) -> None:
    with h5py.File(path) as file:
        scenario = json.loads(file["provenance"].attrs["scenario_resolved"])
    scenario[table] |= values
    tell(path, "provenance", "scenario_resolved", json.dumps(scenario))


@pytest.mark.parametrize(
    ("table", "key", "value", "check"),
    [
        ("sliding", "distance", "701 um", "structure"),
        ("output", "tick", "0.25 um", "structure"),
        ("strength", "mean", "251 MPa", "junctions"),
        ("sliding", "speed", "2 mm/s", "junctions"),
        ("slider", "mass", "6 g", "slider"),
        ("interface", "mean_junction_count", 21, "junctions"),
        ("pulse", "shape", "triangle", "trace"),
    ],
)
def test_a_scenario_that_was_not_run_is_told(result: Path, table: str, key: str, value: object, check: str) -> None:
    resolved(result, table, **{key: value})
    assert check in failing(result)


@pytest.mark.parametrize(("count", "check"), [(3e4, "junctions"), (2e12, "structure")])
def test_a_scenario_of_far_more_rows_than_the_file_has_is_not_played(result: Path, count: float, check: str) -> None:
    resolved(result, "interface", mean_junction_count=count, mean_real_contact_area=f"{10.0 * count} um^2")
    begun = process_time()
    assert check in failing(result)
    assert process_time() - begun < 5.0


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": 1}', "[" * 100_000])
def test_a_file_without_a_scenario_is_told(result: Path, text: str) -> None:
    tell(result, "provenance", "scenario_resolved", text or " ")
    found = asked(result)
    assert [check.name for check in found.different] == ["structure"]
    assert list(found.left_out) == ["everything else"]


@pytest.mark.parametrize(
    ("name", "factor", "told"),
    [
        ("real_contact_area_mean", 1.0 + 3e-9, ["summary"]),
        ("real_contact_area_mean", 1.0 + 1e-11, []),
        ("real_contact_area_skewness", 1.01, ["summary"]),
        ("velocity_std", 1.0 + 1e-8, ["summary"]),
        ("one_way_validity", 1.0 + 1e-8, ["summary"]),
        ("junction_count_mean_exact", 1.00001, ["summary"]),
        ("junction_count_mean_exact", 1.0 + 1e-8, []),
        ("displacement_mean", float("nan"), ["summary"]),
    ],
)
def test_a_summary_that_its_columns_do_not_have_is_told(
    result: Path, name: str, factor: float, told: list[str]
) -> None:
    with h5py.File(result) as file:
        value = float(file["summary"].attrs[name])
    tell(result, "summary", name, value * factor)
    assert failing(result) == told


def test_a_column_that_cannot_be_read_is_told(kept: Path, tmp_path: Path) -> None:
    path = fresh(kept, tmp_path, "one-way, gzip")
    with h5py.File(path) as file:
        chunk = file["trace/real_contact_area"].id.get_chunk_info(0)
    raw = bytearray(path.read_bytes())
    raw[chunk.byte_offset + chunk.size // 2] ^= 0xFF
    path.write_bytes(raw)
    found = asked(path)
    assert str(found.different[0].first) == "/trace/real_contact_area is unreadable, should be as it was written"
    assert found.left_out["everything else"] == "/trace/real_contact_area cannot be read"


def test_a_damaged_hash_is_told_from_a_column_that_cannot_be_read(result: Path) -> None:
    with h5py.File(result, "r+") as file:
        file["trace/distance"].attrs[HASH] = 1.0
    (check,) = asked(result).different
    assert check.first == "/trace/distance is beside a damaged hash, should be as it was written"


ENDED = (30, 1010, 1200)
"""Rows whose lives an intervention ends: in the first block, after its end, and in the second one."""

FINE: dict[str, dict[str, Any]] = {"output": {"tick": "0.02 um"}}
"""Lives of so many ticks are summed as series, but not where they end early."""


@pytest.fixture(scope="module")
def of_intervention(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Return a result in which some lives were ended early, of which one goes on into the second block."""
    folder = tmp_path_factory.mktemp("ended")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rubnoise.simulation.draws.BLOCK", 1000)
        lives = rubnoise.simulate(scenario_of(**FINE)).junctions
        birth, diameter = lives["birth_distance"][:], lives["diameter"][:]
        border = birth[np.count_nonzero(birth < 0.0) + births_per_block(scenario_of(**FINE).model())]
        ends = {row: float(birth[row] + 1.7 * diameter[row]) for row in ENDED}
        assert birth[ENDED[1]] < border < ends[ENDED[1]]

        def intervene(env: Any, live: Any) -> Any:
            for number, distance in ends.items():
                yield env.timeout(distance - env.now)
                live.end(number)

        rubnoise.run(scenario_of(**FINE), folder / "ended.h5", intervene=intervene).close()
        yield folder / "ended.h5"


@pytest.fixture
def interrupted(of_intervention: Path, tmp_path: Path) -> Path:
    return Path(copy(of_intervention, tmp_path))


def test_lives_that_an_intervention_ended_are_played_again(interrupted: Path) -> None:
    found = asked(interrupted)
    assert [str(check.first) for check in found.different] == []
    assert found.left_out == {}
    with h5py.File(interrupted) as file:
        assert np.flatnonzero(file["junctions/state"][:] & 4).tolist() == list(ENDED)


@pytest.mark.parametrize("group", ["junctions", "trace", "slider"])
def test_a_last_digit_of_a_run_with_an_intervention_is_seen(interrupted: Path, group: str) -> None:
    columns = [column for column in columns_of(interrupted) if column.startswith(group)]
    for number, column in enumerate(columns):
        flip(interrupted, column, 30 - number if group == "junctions" else middle(interrupted, column) - number % 2)
    check = next(check for check in asked(interrupted).different if check.name == group)
    assert check.different >= len(columns)


def test_a_death_moved_by_a_tick_in_agreement_with_its_row_is_seen(interrupted: Path) -> None:
    with h5py.File(interrupted) as file:
        birth, death = (float(file[f"junctions/{each}_distance"][1200]) for each in ("birth", "death"))
    death += 0.5
    moved = {"death_distance": death, "life_distance": death - birth, "death_time": death / SPEED}
    for name, value in moved.items():
        put(interrupted, f"junctions/{name}", 1200, value)
    assert failing(interrupted) == ["trace", "slider"]


def test_ends_without_an_intervention_are_seen(interrupted: Path) -> None:
    forget(interrupted, "provenance", "intervention")
    assert "junctions" in failing(interrupted)
