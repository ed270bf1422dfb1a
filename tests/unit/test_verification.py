"""Results of every kind are verified, and none that has been changed is, down to one bit of one value."""

import json
from collections import Counter
from pathlib import Path
from shutil import copy
from typing import Any

import h5py
import numpy as np
import pytest

from rubnoise.analysis.stored_model import stored_model
from rubnoise.analysis.summary import summarise
from rubnoise.analysis.verification import verify
from rubnoise.analysis.verifying.findings import Verification
from rubnoise.analysis.verifying.regenerating import chosen_blocks
from rubnoise.errors import Refused
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.sink import Tee
from rubnoise.record.tally import Tally
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import HASH
from tests.unit.tampering import change, flip, forget, put, run_of, tell

ALL_BLOCKS = 99
SPEED = 1000.0
SHORT = {"distance": "150 um"}
BARE = ("strength", "slider")
NO_SPEED = {"speed": None}

KINDS: dict[str, tuple[tuple[str, ...], dict[str, dict[str, Any]]]] = {
    "everything": ((), {}),
    "bare": (BARE, {"sliding": NO_SPEED}),
    "strength without speed": (("slider",), {"sliding": NO_SPEED}),
    "speed without strength": (BARE, {}),
    "gzip": ((), {"output": {"compression": "gzip"}}),
    "batch": ((), {"run": {"engine": "batch"}}),
    "empty start, slider at rest": ((), {"sliding": {"start": "empty"}, "slider": {"start": "rest"}}),
    "triangles": ((), {"pulse": {"shape": "triangle"}}),
    "regular births": ((), {"birth": {"law": "regular"}}),
    "regular births of unequal sizes": (
        ("slider",),
        {"birth": {"law": "regular"}, "diameter": {"law": "lognormal", "spread": "60 %"}},
    ),
    "Rabinowicz's": (
        (),
        {"birth": {"law": "regular"}, "pulse": {"shape": "triangle"}, "diameter": {"law": "fixed", "spread": None}},
    ),
    "lognormal sizes and strengths": (
        (),
        {"diameter": {"law": "lognormal", "spread": "70 %"}, "strength": {"law": "lognormal", "spread": "60 %"}},
    ),
    "exponential sizes, Weibull strengths": (
        (),
        {"diameter": {"law": "exponential", "spread": None}, "strength": {"law": "weibull", "spread": "60 %"}},
    ),
    "gamma sizes, normal strengths": (
        (),
        {"diameter": {"law": "gamma", "spread": "40 %"}, "strength": {"law": "normal", "spread": "80 MPa"}},
    ),
    "overdamped": ((), {"slider": {"damping": "50 N*s/m"}, "sliding": SHORT}),
    "slow": ((), {"sliding": {"speed": "10 um/s", "distance": "60 um"}}),
    "slow triangles": ((), {"sliding": {"speed": "10 um/s", "distance": "60 um"}, "pulse": {"shape": "triangle"}}),
    "coarse ticks": ((), {"output": {"tick": "10 um"}}),
    "more ticks than a panel": ((), {"output": {"tick": "0.002 um"}, "sliding": SHORT}),
    "more rows than a panel": (
        ("slider",),
        {
            "interface": {"mean_junction_count": 2000},
            "diameter": {"spread": "10 %"},
            "sliding": {"distance": "50 um"},
            "run": {"engine": "batch"},
        },
    ),
    "thin": ((), {"interface": {"mean_junction_count": 0.02}}),
    "nobody at all": ((), {"interface": {"mean_junction_count": 0.0001}, "sliding": SHORT}),
}


def asked(path: Path, regenerate: int = 0) -> Verification:
    with open_run(path) as run:
        return verify(run, regenerate)


def failing(path: Path, regenerate: int = 0) -> list[str]:
    return [check.name for check in asked(path, regenerate).different]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("verification")


def fresh(kept: Path, tmp_path: Path, name: str) -> Path:
    """Return a copy of the result of a kind, which is run once."""
    number = list(KINDS).index(name)
    original = kept / f"{number}.h5"
    if not original.exists():
        left_out, changes = KINDS[name]
        run_of(original, *left_out, **changes)
    return Path(copy(original, tmp_path / "x.h5"))


@pytest.fixture
def result(kept: Path, tmp_path: Path) -> Path:
    return fresh(kept, tmp_path, "everything")


@pytest.fixture
def unequal(kept: Path, tmp_path: Path) -> Path:
    return fresh(kept, tmp_path, "lognormal sizes and strengths")


@pytest.mark.parametrize("name", KINDS)
def test_a_right_result_of_every_kind_is_verified(kept: Path, tmp_path: Path, name: str) -> None:
    found = asked(fresh(kept, tmp_path, name), 3)
    assert [str(check.first) for check in found.different] == []
    assert found.left_out == ()
    names = [check.name for check in found.checks]
    assert {"hashes", "layout", "origin", "lives", "counts", "areas", "blocks", "regenerated", "summary"} <= set(names)
    assert len(set(names)) == len(names)


def test_kinds_reach_what_they_are_named_for(kept: Path, tmp_path: Path) -> None:
    extents = {}
    for name in ("more ticks than a panel", "more rows than a panel", "nobody at all", "everything"):
        with open_run(fresh(kept, tmp_path, name)) as run:
            extents[name] = run.extent
    assert extents["more ticks than a panel"].ticks > 65_536
    assert extents["more rows than a panel"].junctions > 65_536
    assert extents["nobody at all"].junctions == 0
    assert extents["everything"].blocks == 2


def test_a_column_is_read_by_the_checks_that_ask_for_it_alone(result: Path) -> None:
    """Once for its hash and once for its own check, where no other check needs it: to unpack a column takes time."""
    reads: Counter[str] = Counter()
    with open_run(result) as run:
        run.watch = lambda column, _row, _rows: reads.update([column])
        assert not verify(run).different
    for column in ("/slider/time", "/slider/distance", "/slider/friction_force", "/junctions/max_area"):
        assert reads[column] == 2, column


def test_every_value_is_looked_at(result: Path) -> None:
    found = {check.name: check for check in asked(result, ALL_BLOCKS).checks}
    with open_run(result) as run:
        rows = {group: run.rows(group) for group in run.columns}
        assert found["hashes"].values == 1 + sum(rows[group] * len(names) for group, names in run.columns.items())
        compared = sum(rows[group] * len(names) for group, names in run.columns.items() if group != "life_curve")
    assert found["regenerated"].values == compared + 12
    assert found["motion"].values == 2 * rows["slider"]
    assert found["counts"].values == found["areas"].values == found["forces"].values == rows["trace"]


LOWEST_BIT = {
    "junctions/junction": "ids",
    "junctions/birth_distance": "lives",
    "junctions/death_distance": "lives",
    "junctions/life_distance": "lives",
    "junctions/diameter": "lives",
    "junctions/max_area": "diameters",
    "junctions/shear_strength": "strengths",
    "junctions/birth_time": "times",
    "junctions/death_time": "times",
    "junctions/state": "states",
    "trace/distance": "ticks",
    "trace/real_contact_area": "forces",
    "trace/junction_count": "counts",
    "trace/friction_force": "forces",
    "slider/time": "slider_columns",
    "slider/distance": "slider_columns",
    "slider/friction_force": "slider_columns",
    "slider/displacement": "regenerated",
    "slider/velocity": "regenerated",
    "blocks/block": "blocks",
    "blocks/birth_distance": "blocks",
    "blocks/first_junction": "blocks",
    "blocks/first_tick": "blocks",
    "blocks/displacement": "blocks",
    "blocks/velocity": "blocks",
    "life_curve/u": "life_curve",
    "life_curve/area_fraction": "life_curve",
}
"""Every column of a result, and the check that sees the lowest bit of one of its values."""


def middle(path: Path, column: str) -> int:
    with h5py.File(path) as file:
        return int(file[column].size) // 2


def test_every_column_has_its_check(result: Path) -> None:
    with open_run(result) as run:
        assert set(LOWEST_BIT) == {f"{group}/{name}" for group, names in run.columns.items() for name in names}


@pytest.mark.parametrize("column", LOWEST_BIT)
def test_one_bit_of_one_value_is_seen_though_its_hash_is_right(result: Path, column: str) -> None:
    row = middle(result, column)
    flip(result, column, row)
    found = {check.name: check for check in asked(result, ALL_BLOCKS).different}
    assert "hashes" not in found
    assert LOWEST_BIT[column] in found
    seen = found[LOWEST_BIT[column]].first
    assert seen is not None
    assert seen.row == row
    assert seen.place == f"/{column}" or LOWEST_BIT[column] in {"lives", "forces"}


@pytest.mark.parametrize("column", LOWEST_BIT)
def test_one_bit_of_one_value_is_seen_by_its_hash(result: Path, column: str) -> None:
    flip(result, column, middle(result, column), seal=False)
    first = asked(result).different[0]
    assert (first.name, first.different) == ("hashes", 1)
    assert str(first.first) == f"/{column} is not what its hash was taken of, should be as it was written"


@pytest.mark.parametrize("column", ["trace/real_contact_area", "trace/friction_force"])
def test_one_bit_of_a_sum_is_seen_where_it_is_made_again(unequal: Path, column: str) -> None:
    flip(unequal, column, middle(unequal, column))
    assert failing(unequal) == ([] if "area" in column else ["slider_columns"])
    assert "regenerated" in failing(unequal, ALL_BLOCKS)


@pytest.mark.parametrize(
    ("column", "by", "check"),
    [
        ("trace/real_contact_area", 1e-10, "areas"),
        ("trace/friction_force", 1e-7, "forces"),
        ("slider/friction_force", 1e-7, "slider_columns"),
    ],
)
def test_a_sum_that_is_off_by_little_is_seen_without_making_it_again(
    unequal: Path, column: str, by: float, check: str
) -> None:
    row = middle(unequal, column)
    with h5py.File(unequal) as file:
        value = float(file[column][row])
    put(unequal, column, row, value + by)
    assert check in failing(unequal)


@pytest.mark.parametrize("name", ["everything", "slow", "overdamped", "coarse ticks", "triangles"])
@pytest.mark.parametrize("column", ["slider/displacement", "slider/velocity"])
def test_a_motion_off_by_a_thousandth_of_a_millionth_is_seen_where_it_is(
    kept: Path, tmp_path: Path, name: str, column: str
) -> None:
    path = fresh(kept, tmp_path, name)
    row = middle(path, column)
    with h5py.File(path) as file:
        values = file[column][:]
    largest = float(np.abs(values).max())
    put(path, column, row, values[row] + 1e-11 * largest)
    assert "motion" not in failing(path)
    put(path, column, row, values[row] + 1e-9 * largest)
    check = next(check for check in asked(path).different if check.name == "motion")
    assert check.first is not None
    assert (check.first.place, check.first.row) == (f"/{column}", row)


@pytest.mark.parametrize("column", ["displacement", "velocity"])
def test_a_start_of_the_slider_is_seen_to_the_bit(result: Path, column: str) -> None:
    flip(result, f"slider/{column}", 0)
    flip(result, f"blocks/{column}", 0)
    assert {"motion", "blocks"} <= set(failing(result))


def moved(path: Path, row: int, by: float) -> None:
    """Move a whole life, and everything that the rows say of it."""
    with h5py.File(path) as file:
        columns = {name: data[row] for name, data in file["junctions"].items()}
    birth = columns["birth_distance"] + by
    death = birth + 2.0 * columns["diameter"]
    told = {"birth_distance": birth, "death_distance": death, "birth_time": birth / SPEED, "death_time": death / SPEED}
    for name, value in told.items():
        put(path, f"junctions/{name}", row, float(value))


def test_a_life_that_was_somewhere_else_is_missed_in_the_sums(unequal: Path) -> None:
    row = middle(unequal, "junctions/diameter")
    moved(unequal, row, 1e-9)
    found = failing(unequal)
    assert "areas" in found
    assert not {"lives", "births", "times", "states"} & set(found)


def test_a_life_moved_by_a_rounding_is_missed_where_it_is_made_again(unequal: Path) -> None:
    row = middle(unequal, "junctions/diameter")
    moved(unequal, row, 1.2e-13)
    assert "regenerated" in failing(unequal, ALL_BLOCKS)


@pytest.mark.parametrize(
    ("column", "row", "value", "check"),
    [
        ("junctions/birth_distance", 900, 1e3, "births"),
        ("junctions/birth_distance", 900, float("nan"), "births"),
        ("junctions/birth_distance", 3, -1e3, "births"),
        ("junctions/diameter", 900, -1.0, "diameters"),
        ("junctions/diameter", 900, float("inf"), "diameters"),
        ("junctions/death_distance", 900, float("-inf"), "lives"),
        ("junctions/shear_strength", 900, 0.0, "strengths"),
        ("junctions/state", 900, 2, "states"),
        ("junctions/state", 900, 4, "states"),
        ("junctions/state", 900, 8, "states"),
        ("trace/real_contact_area", 700, float("nan"), "areas"),
        ("trace/friction_force", 700, float("inf"), "forces"),
        ("trace/junction_count", 700, 4_000_000_000, "counts"),
        ("slider/displacement", 700, float("nan"), "motion"),
        ("slider/velocity", 1400, 1e300, "motion"),
        ("blocks/first_tick", 1, -(2.0**60), "blocks"),
        ("blocks/birth_distance", 0, float("inf"), "blocks"),
    ],
)
def test_what_cannot_be_is_told_and_breaks_nothing(
    unequal: Path, column: str, row: int, value: float, check: str
) -> None:
    put(unequal, column, row, value)
    found = {each.name: each for each in asked(unequal, ALL_BLOCKS).different}
    assert check in found
    assert found[check].first is not None


def test_what_rests_on_rows_that_differ_is_left_out(result: Path) -> None:
    flip(result, "junctions/diameter", 900)
    found = asked(result, 3)
    assert [each.name for each in found.left_out] == ["ticks and what follows", "regenerated"]
    assert not {"areas", "motion", "regenerated"} & {check.name for check in found.checks}


def test_births_before_the_run_are_those_of_whom_are_alive(result: Path) -> None:
    with h5py.File(result) as file:
        diameter = float(file["junctions/diameter"][0])
    moved(result, 0, -2.0 * diameter)
    assert "births" in failing(result)


def test_regular_births_keep_their_places_to_the_bit(kept: Path, tmp_path: Path) -> None:
    path = fresh(kept, tmp_path, "regular births of unequal sizes")
    moved(path, 700, 1.2e-13)
    assert "births" in failing(path)


def test_a_row_in_a_later_panel_is_named_by_its_number(kept: Path, tmp_path: Path) -> None:
    path = fresh(kept, tmp_path, "more rows than a panel")
    flip(path, "junctions/max_area", 80_000)
    (check,) = asked(path).different
    assert check.first is not None
    assert check.first.row == 80_000


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
    found = asked(result, 3)
    assert "origin" in [check.name for check in found.different]
    assert "regenerated" in [each.name for each in found.left_out]


@pytest.mark.parametrize("name", ["transition_00", "transition_01", "transition_10", "gain_00", "gain_10"])
def test_a_constant_of_the_slider_that_is_wrong_is_told(result: Path, name: str) -> None:
    with h5py.File(result) as file:
        constants = json.loads(file["provenance"].attrs["propagator_constants"])
    constants[name] *= 1.0 + 1e-9
    tell(result, "provenance", "propagator_constants", json.dumps(constants))
    exact, derived = asked(result).different
    assert exact.first is not None
    assert derived.first is not None
    assert exact.first.expected.startswith(f"{name} = ")
    assert derived.first.place == f"/provenance propagator_constants {name}"


@pytest.mark.parametrize("factor", [2.0, 1.5, 1e9, -1.0])
def test_a_tick_divided_otherwise_than_told_is_told(result: Path, factor: float) -> None:
    with h5py.File(result) as file:
        constants = json.loads(file["provenance"].attrs["propagator_constants"])
    constants["cells_per_tick"] *= factor
    tell(result, "provenance", "propagator_constants", json.dumps(constants))
    assert "origin" in failing(result)


def test_a_last_digit_of_a_constant_is_told(result: Path) -> None:
    with h5py.File(result) as file:
        constants = json.loads(file["provenance"].attrs["propagator_constants"])
    constants["gain_00"] = float(np.nextafter(constants["gain_00"], 1.0))
    tell(result, "provenance", "propagator_constants", json.dumps(constants))
    assert failing(result) == ["attributes"]
    assert failing(result, 1) == ["attributes", "regenerated"]


def resolved(path: Path, table: str, **values: object) -> None:
    with h5py.File(path) as file:
        scenario = json.loads(file["provenance"].attrs["scenario_resolved"])
    scenario[table] |= values
    tell(path, "provenance", "scenario_resolved", json.dumps(scenario))


def test_another_seed_than_the_rows_were_drawn_with_is_seen(result: Path) -> None:
    resolved(result, "run", seed=2)
    tell(result, "provenance", "seed", 2)
    assert failing(result) == []
    assert failing(result, 2) == ["regenerated"]


@pytest.mark.parametrize(
    ("table", "key", "value", "check"),
    [
        ("sliding", "distance", "701 um", "layout"),
        ("output", "tick", "0.25 um", "layout"),
        ("strength", "mean", "251 MPa", "strengths"),
        ("sliding", "speed", "2 mm/s", "times"),
        ("slider", "mass", "6 g", "origin"),
        ("interface", "mean_junction_count", 21, "origin"),
        ("pulse", "shape", "triangle", "areas"),
    ],
)
def test_a_scenario_that_was_not_run_is_told(result: Path, table: str, key: str, value: object, check: str) -> None:
    resolved(result, table, **{key: value})
    assert check in failing(result)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": 1}', "[" * 100_000])
def test_a_file_without_a_scenario_is_told(result: Path, text: str) -> None:
    tell(result, "provenance", "scenario_resolved", text or " ")
    found = asked(result, 1)
    assert [check.name for check in found.different] == ["layout"]
    assert [each.name for each in found.left_out] == ["everything else"]


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


def test_a_summary_that_lacks_a_figure_is_told(result: Path) -> None:
    forget(result, "summary", "friction_force_std")
    (check,) = asked(result).different
    assert check.first is not None
    assert check.first.place == "/summary friction_force_std"


def test_random_numbers_of_another_version_are_not_drawn(result: Path) -> None:
    tell(result, "provenance", "stream_version", 0)
    assert failing(result) == ["attributes"]
    with pytest.raises(Refused, match=r"of version 0.*this rubnoise draws version 1.*leave --regenerate away"):
        asked(result, 1)


def test_a_column_that_cannot_be_read_is_told(kept: Path, tmp_path: Path) -> None:
    path = fresh(kept, tmp_path, "gzip")
    with h5py.File(path) as file:
        chunk = file["trace/real_contact_area"].id.get_chunk_info(0)
    raw = bytearray(path.read_bytes())
    raw[chunk.byte_offset + chunk.size // 2] ^= 0xFF
    path.write_bytes(raw)
    found = asked(path, 1)
    assert str(found.different[0].first) == "/trace/real_contact_area is unreadable, should be as it was written"
    assert found.left_out[0].reason == "/trace/real_contact_area cannot be read"


def without_blocks(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        del file["blocks"]


def test_a_file_that_lost_its_blocks_is_told(result: Path) -> None:
    without_blocks(result)
    found = {check.name: check for check in asked(result).different}
    assert found.keys() == {"layout", "structure"}
    assert str(found["structure"].first) == "/blocks is missing, should be group"


def test_a_file_that_lost_the_hash_of_its_attributes_is_told(result: Path) -> None:
    forget(result, "provenance", HASH, seal=False)
    assert failing(result) == ["hashes", "attributes"]


def test_a_file_that_lost_both_is_told(result: Path) -> None:
    without_blocks(result)
    forget(result, "provenance", HASH, seal=False)
    assert failing(result) == ["hashes", "layout", "structure", "attributes"]


ENDED = (30, 1200)
"""Rows whose lives an interrupt ends, in the first and in the second of the blocks."""


def ends_of(path: Path) -> dict[int, float]:
    with h5py.File(path) as file:
        birth, diameter = (file[f"junctions/{name}"][:] for name in ("birth_distance", "diameter"))
    return {row: float(birth[row] + 0.9 * diameter[row]) for row in ENDED}


@pytest.fixture
def interrupted(result: Path) -> Path:
    """Return a result in which two lives were ended early."""
    ends = ends_of(result)

    def intervene(env: Any, live: Any) -> Any:
        for number, distance in ends.items():
            if distance > env.now:
                yield env.timeout(distance - env.now)
                if number in live:
                    live.end(number)
        yield env.timeout(0)

    with open_run(result) as run:
        model, seed = stored_model(run), int(run.provenance["seed"])
    record, tally = MemoryRecord(extent(model, seed)), Tally()
    simulate(model, seed, Tee((record, tally)), intervene=intervene)
    for group, columns in record.groups.items():
        for name, values in columns.items():
            change(result, f"{group}/{name}", lambda _, values=values: values)
    for figure in summarise(model, tally):
        tell(result, "summary", figure.name, figure.observed)
    return result


def test_lives_ended_by_an_interrupt_are_as_right_as_others(interrupted: Path) -> None:
    found = asked(interrupted, ALL_BLOCKS)
    assert [str(check.first) for check in found.different] == []
    (partly,) = found.left_out
    assert partly.name == "regenerated"
    assert partly.reason.startswith("interrupts ended lives in block 0, 1: only births, sizes")
    with h5py.File(interrupted) as file:
        assert np.count_nonzero(file["junctions/state"][:] & 4) == len(ENDED)


@pytest.mark.parametrize(("column", "row"), [("death_distance", 1200), ("life_distance", 30), ("state", 30)])
def test_an_end_that_was_not_there_is_seen(interrupted: Path, column: str, row: int) -> None:
    flip(interrupted, f"junctions/{column}", row, bit=2)
    assert failing(interrupted) != []


def test_a_death_moved_by_a_tick_shows_in_the_count(interrupted: Path) -> None:
    for name, by in (("death_distance", 0.5), ("life_distance", 0.5), ("death_time", 0.0005)):
        with h5py.File(interrupted) as file:
            columns = {each: float(file[f"junctions/{each}"][1200]) for each in ("birth_distance", "death_distance")}
            value = float(file[f"junctions/{name}"][1200]) + by
        if name == "life_distance":
            value = columns["death_distance"] - columns["birth_distance"]
        if name == "death_time":
            value = columns["death_distance"] / SPEED
        put(interrupted, f"junctions/{name}", 1200, value)
    assert {"counts", "areas", "motion"} <= set(failing(interrupted))


@pytest.mark.parametrize(
    ("blocks", "count", "right"),
    [(1, 8, [0]), (3, 8, [0, 1, 2]), (10, 2, [0, 9]), (101, 5, [0, 25, 50, 75, 100]), (10, 1, [0])],
)
def test_blocks_are_chosen_evenly_with_both_ends(blocks: int, count: int, right: list[int]) -> None:
    assert chosen_blocks(blocks, count) == right
