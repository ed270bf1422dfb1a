"""`rubnoise junction` and `rubnoise junctions`: one life in words, and the rows that a condition chooses."""

import csv
import json
from io import StringIO
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise import open as open_run
from tests.shell.terminal import call, names
from tests.unit.tampering import bare_file, lives_file

# `rubnoise junction`: one life in words, as a table, as JSON, as a picture.
SLIDER = Path("../given/slider.toml")


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "--seed", "4", "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


@pytest.fixture
def lives(here: Path) -> Path:
    lives_file(here / "l.h5").close()
    return here / "l.h5"


def test_json_is_one_object_with_everything(result: Path) -> None:
    answer = call("junction", "x.h5", "40", "--json")
    assert (answer.code, answer.err) == (0, "")
    told = answer.values()
    with open_run(result) as run:
        row = run.junction(40)
        rows = len(run.junctions)
    assert f"junction 40 of 0 to {rows - 1}, complete" in answer.json()["title"]
    life = told["junction"]
    assert life["state"] == ["complete"]
    for name in ("birth_distance", "death_distance", "diameter", "max_area", "shear_strength", "birth_time"):
        assert life[name] == getattr(row, name)
    assert life["mid_life_distance"] == row.birth_distance + row.diameter == told["peak"]["distance"]
    assert life["mid_life_time"] == pytest.approx(life["mid_life_distance"] / 1000.0, rel=1e-13)
    assert told["peak"]["force"] == pytest.approx(250.0 * told["peak"]["area"])
    assert told["peak"]["area_share"] == pytest.approx(told["peak"]["force_share"], rel=1e-13)
    assert 40 not in told["peak"]["others_alive"]
    assert sorted(told["curve"]) == ["area", "distance", "force", "time"]
    assert {len(values) for values in told["curve"].values()} == {201}


def test_csv_of_a_bare_run_has_distance_and_area(here: Path) -> None:
    bare_file(here / "bare.h5").close()
    assert call("junction", "bare.h5", "2", "--csv").out.startswith("distance_um,area_um2\n2.0,0.0\n")


@pytest.mark.slow
def test_a_picture_has_a_name_of_its_own_or_a_given_one(lives: Path, here: Path) -> None:
    assert call("junction", "l.h5", "2", "--plot").out == "l_junction2.png\n"
    assert call("junction", "l.h5", "2", "life.png", "--plot").code == 0
    assert names(here) == ["l.h5", "l_junction2.png", "life.png"]
    assert (here / "life.png").read_bytes()[:4] == b"\x89PNG"


# `rubnoise junctions`: the rows that a condition chooses.


def test_csv_holds_all_rows_to_the_last_bit(result: Path) -> None:
    heading, *rows = csv.reader(StringIO(call("junctions", "x.h5", "--csv").out))
    with open_run(result) as run:
        assert len(rows) == len(run.junctions)
        for i, name in enumerate(run.junctions.names):
            assert heading[i].startswith(name)
            assert [float(row[i]) for row in rows] == np.asarray(run.junctions[name]).tolist()
    assert heading[1:6] == ["birth_distance_um", "death_distance_um", "life_distance_um", "diameter_um", "max_area_um2"]


def test_json_stays_json_whatever_a_damaged_file_holds(lives: Path) -> None:
    with h5py.File(lives, "r+") as file:
        file["junctions/diameter"][1], file["junctions/max_area"][2] = np.nan, np.inf
    rows = json.loads(call("junctions", "l.h5", "--json").out, parse_constant=pytest.fail)["junctions"]
    assert rows["diameter"][:3] == [5.0, None, 6.0]
    assert [value is None for value in rows["max_area"][:3]] == [False, False, True]
