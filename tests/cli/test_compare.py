"""`rubnoise compare` and `verify`: a result beside its theory and beside itself."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from tests.cli.terminal import call
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


def test_a_right_run_agrees(result: Path) -> None:
    answer = call("compare", "x.h5")
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert lines[0] == "x.h5: compared with the theory of its scenario"
    for heading in ("births ", "junctions ", "contact ", "exact but for rounding ", "left out"):
        assert sum(line.startswith(heading) for line in lines) == 1
    assert any(line.startswith("  area mean (um^2)  ") for line in lines)
    assert any(line.startswith("  power, k ") for line in lines)
    assert "  4 of 4 identities hold" in lines
    assert "which all keep in 99.9% of right runs" in answer.out
    assert max(map(len, lines)) <= 80
    assert "*" not in answer.out


def test_a_part_says_where_its_record_begins(here: Path) -> None:
    """Displacement is taken from where its start is forgotten, and by `info` from the start."""
    quick = ("--set", "slider.damping=0.5 N*s/m", "--set", "output.tick=0.5 um")
    assert call("run", SLIDER, *quick, "--set", "sliding.distance=6 mm", "-q", "-o", "x.h5").code == 0
    told = call("compare", "x.h5", "--json").json()
    begins = told["begins"]
    assert begins.keys() == {"births", "junctions", "contact", "slider"}
    assert begins["births"] == begins["junctions"] == begins["contact"] == 0.0
    assert begins["slider"] == pytest.approx(20.0 * np.log(1e3), abs=0.5)  # decay time 2m/c = 20 ms, at 1 mm/s
    lines = call("compare", "x.h5").out.splitlines()
    assert any(line.startswith(f"slider, from {begins['slider']:.4g} um on ") for line in lines)
    whole = call("info", "x.h5", "--json").json()["summary"]["displacement_std"]
    assert told["figures"]["displacement_std"]["observed"] != pytest.approx(whole["observed"], rel=1e-9)
    with h5py.File("x.h5") as file:
        values = file["slider/displacement"][:]
    assert whole["observed"] == pytest.approx(values.std())
    assert told["figures"]["displacement_std"]["observed"] == pytest.approx(values[int(begins["slider"] / 0.5) :].std())


def test_an_empty_start_is_left_out_of_the_contact(here: Path) -> None:
    empty = ("--set", "sliding.start=empty", "--set", "sliding.distance=1 mm")
    assert call("run", "../given/contact.toml", *empty, "-q", "-o", "x.h5").code == 0
    begins = call("compare", "x.h5", "--json").json()["begins"]
    assert begins["contact"] == pytest.approx(2.0 * 30.0**0.5, abs=0.1)
    assert begins["births"] == 0.0


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
    assert {"birth_count", "diameter_mean", "junction_count_mean"} <= set(answer.json()["outside"])


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
    assert [line.split()[-1] for line in lines[3:-2]] == ["0"] * 8
    assert lines[-1].startswith("  8 of 8 checks hold; ")
    assert lines[-1].endswith(" values checked")
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
    assert place in answer.out
    assert "summary: rows of the columns that it sums up differ" in answer.out
    assert "6 of 7 checks hold" in answer.out


def test_the_place_is_that_of_a_row_where_one_is_known(short_result: Path) -> None:
    flip(short_result, "trace/friction_force", 117, seal=False)
    answer = call("verify", "x.h5", "--json")
    told = answer.json()
    assert answer.code == 3
    assert not told["verified"]
    assert told["different"] == ["hashes", "trace"]
    assert told["checks"]["hashes"]["place"] == "/trace/friction_force"
    assert "row" not in told["checks"]["hashes"]
    force = told["checks"]["trace"]
    assert (force["place"], force["row"], force["different"]) == ("/trace/friction_force", 117, 1)
    assert abs(float(force["found"]) / float(force["expected"]) - 1.0) < 1e-15
    assert "/trace/friction_force row 117 is " in answer.err


def test_random_numbers_of_another_version_are_refused(short_result: Path) -> None:
    tell(short_result, "provenance", "stream_version", 7)
    answer = call("verify", "x.h5")
    assert (answer.code, answer.err) == (3, "x.h5: differs: /provenance stream_version is 7, should be 1\n")
    answer = call("verify", "x.h5", "--regenerate")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("x.h5: has random streams of version 7, which can't be drawn again: ")
    assert answer.err.count("\n") == 1
