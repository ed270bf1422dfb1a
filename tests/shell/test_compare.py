"""`rubnoise compare` and `verify`: a result beside its theory and beside itself."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from tests.shell.terminal import call
from tests.unit.tampering import flip, put, tell

# `rubnoise compare`: a result beside its theory, as a table and as JSON, and what becomes of one that is not right.
SLIDER = "../given/slider.toml"
LONG = ("--set", "sliding.distance=1 mm")


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "--seed", "4", *LONG, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def change(path: Path, column: str, by: Callable[[Any], Any]) -> None:
    with h5py.File(path, "r+") as file:
        file[column][:] = by(file[column][:])


def rewrite(path: Path, by: Callable[[dict[str, Any]], object]) -> None:
    with h5py.File(path, "r+") as file:
        resolved = json.loads(file["provenance"].attrs["scenario_resolved"])
        by(resolved)
        file["provenance"].attrs["scenario_resolved"] = np.bytes_(json.dumps(resolved))


@pytest.mark.slow
def test_a_right_run_agrees(result: Path) -> None:
    answer = call("compare", "x.h5")
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert lines[0] == "x.h5: compared with the theory of its scenario"
    for heading in ("births ", "junctions ", "contact ", "identities ", "left out"):
        assert sum(line.startswith(heading) for line in lines) == 1
    assert any(line.startswith("  real contact area mean (um^2)  ") for line in lines)
    told = " ".join(answer.out.split())
    assert " and 4 identities compared, |z| <= " in told
    assert "which all keep in 99.9% of right runs" in told
    assert max(map(len, lines)) <= 80
    assert "*" not in answer.out


@pytest.mark.slow
def test_a_part_says_where_its_record_begins(here: Path) -> None:
    """Displacement is taken from where its start is forgotten, as by `info`; the contact is stationary before."""
    quick = ("--set", "slider.damping=0.5 N*s/m", "--set", "output.tick=0.5 um")
    assert call("run", SLIDER, *quick, "--set", "sliding.distance=6 mm", "-q", "-o", "x.h5").code == 0
    told = call("compare", "x.h5", "--json").json()
    assert {name for name, part in told.items() if isinstance(part, dict) and "begins" in part} == {"slider"}
    begins, std = told["slider"]["begins"]["value"], told["slider"]["displacement_std"]["value"]
    assert begins == pytest.approx(20.0 * np.log(1e3), abs=0.5)  # decay time 2m/c = 20 ms, at 1 mm/s
    whole = call("info", "x.h5", "--json").json()["summary"]["displacement_std"]["value"]
    assert std == pytest.approx(whole, rel=1e-9)
    with h5py.File("x.h5") as file:
        values = file["slider/displacement"][:]
    assert std != pytest.approx(values.std(), rel=1e-9)
    assert std == pytest.approx(values[int(begins / 0.5) :].std())


def test_an_empty_start_is_left_out_of_the_contact(here: Path) -> None:
    empty = ("--set", "sliding.start=empty", "--set", "sliding.distance=1 mm")
    assert call("run", "../given/contact.toml", *empty, "-q", "-o", "x.h5").code == 0
    told = call("compare", "x.h5", "--json").json()
    assert told["contact"]["begins"]["value"] == pytest.approx(2.0 * 30.0**0.5, abs=0.1)
    assert "begins" not in told["births"]


def test_a_run_outside_has_its_own_exit_code_and_a_line_that_names_what(result: Path) -> None:
    change(result, "trace/real_contact_area", lambda area: 1.02 * area)
    answer = call("compare", "x.h5")
    assert answer.code == 3
    assert answer.err.startswith("x.h5: outside: ")
    assert "area_from_rows" in answer.err
    assert answer.err.count("\n") == 1
    assert {"area_from_rows", "friction_force"} <= set(answer.err.strip().split(": ")[-1].split(", "))
    starred = [line for line in answer.out.splitlines() if line.endswith("*")]
    assert len(starred) == len(answer.err.split(", "))
    assert max(map(len, answer.out.splitlines())) <= 80


def test_the_theory_is_that_of_the_scenario_in_the_file(result: Path) -> None:
    def fewer(resolved: dict[str, Any]) -> None:
        resolved["interface"]["mean_junction_count"] = 30

    rewrite(result, fewer)
    answer = call("compare", "x.h5", "--json")
    assert answer.code == 3
    assert {"birth_count", "diameter_mean", "junction_count_mean"} <= set(answer.json()["failing"])


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("trace/real_contact_area", float("nan")),
        ("junctions/diameter", 0.0),
        ("junctions/birth_distance", float("inf")),
    ],
)
def test_rows_that_are_damaged_are_refused(result: Path, column: str, value: float) -> None:
    def spoil(values: Any) -> Any:
        values[17] = value
        return values

    change(result, column, spoil)
    answer = call("compare", "x.h5", "--json")
    group, name = column.split("/")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == f"x.h5: /{group} is damaged: row 17 has the {name} {value:g}\n"


# `rubnoise verify`: correct results pass, and it names what is wrong in others.
@pytest.fixture
def short_result(here: Path) -> Path:
    assert call("run", SLIDER, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def test_a_right_result_is_verified(short_result: Path) -> None:
    answer = call("verify", "x.h5")
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert lines[0] == "x.h5: compared with its hashes and its run, played again"
    assert len(lines[3:-2]) == 8
    assert lines[-1].startswith("passed: 8 checks of ")
    assert lines[-1].endswith(" values")
    assert "left out" not in answer.out


def test_a_difference_has_its_own_exit_code_and_its_place(short_result: Path) -> None:
    put(short_result, "trace/junction_count", 117, 99)
    with h5py.File(short_result) as file:
        count = round(float(file["trace/junction_count"][116]))
    answer = call("verify", "x.h5")
    assert answer.code == 3
    assert answer.err.startswith("x.h5: differs: /trace/junction_count row 117 is 99, should be ")
    place = answer.err.strip().removeprefix("x.h5: differs: ")
    assert abs(int(place.split()[-1]) - count) <= 3
    assert answer.err.count("\n") == 1
    told = " ".join(answer.out.split())
    assert place in told
    assert "summary: rows of the columns that it sums up differ" in told
    assert "not passed: hashes, trace (7 checks of" in told or "not passed: trace (7 checks of" in told


def test_the_place_is_that_of_a_row_where_one_is_known(short_result: Path) -> None:
    flip(short_result, "trace/friction_force", 117, seal=False)
    answer = call("verify", "x.h5", "--json")
    told = answer.json()
    assert answer.code == 3
    assert not told["passed"]
    assert told["failing"] == ["hashes", "trace"]
    assert told["checks"]["hashes"]["note"].startswith("1 different; the first: /trace/friction_force is not what")
    note = told["checks"]["trace"]["note"]
    assert note.startswith("1 different; the first: /trace/friction_force row 117 is ")
    found, expected = note.rpartition(" row 117 is ")[2].split(", should be ")
    assert abs(float(found) / float(expected) - 1.0) < 1e-15
    assert "/trace/friction_force row 117 is " in answer.err


def test_random_numbers_of_another_version_are_refused(short_result: Path) -> None:
    tell(short_result, "provenance", "stream_version", 7)
    answer = call("verify", "x.h5")
    assert (answer.code, answer.err) == (3, "x.h5: differs: /provenance stream_version is 7, should be 2\n")
    assert "replay: has random streams of version 7, which can't be drawn again: " in answer.out
