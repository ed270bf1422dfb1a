"""`rubnoise junction` and `rubnoise junctions`: one life in words, and the rows that a condition chooses."""

import csv
import json
from io import StringIO
from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise import open as open_run
from tests.cli.terminal import call, names
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


EARLY = """\
l.h5: junction 3 of 0 to 7, ended early

  birth                             4 um         0.004 s
  mid-life    not reached
  death                             8 um         0.008 s
  life                              4 um         0.004 s

  diameter                          5 um
  area at full overlap       19.63495 um^2
  shear strength                  300 MPa

at its peak, just before it was ended, 8 um
"""


def test_a_life_is_told_in_words_and_numbers(lives: Path) -> None:
    answer = call("junction", "l.h5", "3")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.startswith(EARLY)
    assert "  its area                   14.66849 um^2   " in answer.out
    assert answer.out.endswith("  alive beside it: 3, row numbers\n    2, 4, 5\n")


def test_json_is_one_object_with_everything(result: Path) -> None:
    answer = call("junction", "x.h5", "40", "--json")
    assert (answer.code, answer.err) == (0, "")
    told = json.loads(answer.out, parse_constant=pytest.fail)
    with open_run(result) as run:
        row = run.junction(40)
        rows = len(run.junctions)
    assert (told["junction"], told["rows"], told["state"]) == (40, rows, ["complete"])
    for name in ("birth_distance", "death_distance", "diameter", "max_area", "shear_strength", "birth_time"):
        assert told[name] == getattr(row, name)
    assert told["mid_life_distance"] == row.birth_distance + row.diameter == told["peak"]["distance"]
    assert told["mid_life_time"] == pytest.approx(told["mid_life_distance"] / 1000.0, rel=1e-13)
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


@pytest.mark.parametrize("number", ["-1", "8", "-8", "99999999999999999999"])
def test_a_number_out_of_range_gets_one_line_with_the_range(lives: Path, number: str) -> None:
    answer = call("junction", "l.h5", number)
    said = f"l.h5: there is no junction {number} in this run; it has junctions 0 to 7\n"
    assert (answer.code, answer.out, answer.err) == (2, "", said)


# `rubnoise junctions`: the rows that a condition chooses.
TABLE = """\
l.h5: 3 of 8 junctions

  junction  birth_distance  diameter  max_area  state
                        um        um      um^2
         3               4         5  19.63495  ended_early
         5               6         5  19.63495  ended_early
         4               6         4  12.56637  ended_early
"""


def test_rows_are_shown_below_names_and_units(lives: Path) -> None:
    answer = call("junctions", "l.h5", "--where", "ended_early", "--sort", "-max_area", "--columns", "junction")
    assert answer.out.split() == ["l.h5:", "3", "of", "8", "junctions", "junction", "3", "5", "4"]
    answer = call("junctions", "l.h5", "--where", "ended_early and diameter > 1", "--sort", "-diameter")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out == TABLE


def test_csv_holds_all_rows_to_the_last_bit(result: Path) -> None:
    heading, *rows = csv.reader(StringIO(call("junctions", "x.h5", "--csv").out))
    with open_run(result) as run:
        assert len(rows) == len(run.junctions)
        for i, name in enumerate(run.junctions.names):
            assert heading[i].startswith(name)
            assert [float(row[i]) for row in rows] == np.asarray(run.junctions[name]).tolist()
    assert heading[1:6] == ["birth_distance_um", "death_distance_um", "life_distance_um", "diameter_um", "max_area_um2"]


ORDERS = [
    (("--sort", "diameter"), [1, 4, 0, 3, 5, 6, 2, 7]),
    (("--sort", "-diameter"), [7, 2, 0, 3, 5, 6, 1, 4]),
    (("--sort", "diameter", "--reverse"), [7, 2, 0, 3, 5, 6, 1, 4]),
    (("--sort", "-diameter", "--reverse"), [1, 4, 0, 3, 5, 6, 2, 7]),
    (("--reverse",), [7, 6, 5, 4, 3, 2, 1, 0]),
    (("--sort", "state", "--head", "3"), [2, 6, 0]),
    (("--sort", "-state", "--head", "3"), [3, 4, 5]),
    (("--where", "3 ms < birth_time", "--head", "2"), [3, 4]),
    (("--head", "0"), []),
]


@pytest.mark.parametrize(("arguments", "rows"), ORDERS)
def test_rows_come_in_the_order_asked_for(lives: Path, arguments: tuple[str, ...], rows: list[int]) -> None:
    answer = call("junctions", "l.h5", "--csv", "--columns", "junction", *arguments)
    assert answer.out.split() == ["junction", *map(str, rows)]


def test_json_stays_json_whatever_a_damaged_file_holds(lives: Path) -> None:
    with h5py.File(lives, "r+") as file:
        file["junctions/diameter"][1], file["junctions/max_area"][2] = np.nan, np.inf
    rows = json.loads(call("junctions", "l.h5", "--json").out, parse_constant=pytest.fail)["junctions"]
    assert [(row["diameter"], row["max_area"] is None) for row in rows[:3]] == [
        (5.0, False),
        (None, False),
        (6.0, True),
    ]
