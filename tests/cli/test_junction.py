"""`rubnoise junction`: one life in words, as a table, as JSON, as a picture."""

import csv
import json
import sys
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from rubnoise import open as open_run
from tests.cli.terminal import call, names
from tests.format.runs import describe, random_rows, write_run
from tests.unit.lives import bare_file, lives_file

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


def test_what_lies_outside_of_the_record_is_said(lives: Path) -> None:
    first, last = call("junction", "l.h5", "0").out, call("junction", "l.h5", "7").out
    assert "alive at the start\n" in first
    assert "-0.004 s   before the start" in first
    assert "at its largest in the record, at the start, 0 um" in first
    assert "0.042 s   after the end" in last
    assert "at its largest in the record, at the end, 30 um" in last
    assert last.endswith("  alive beside it: 0\n")


@pytest.mark.parametrize("number", [0, 17, 40])
def test_the_text_fits_80_columns(result: Path, number: int) -> None:
    answer = call("junction", "x.h5", str(number))
    assert (answer.code, answer.err) == (0, "")
    assert max(map(len, answer.out.splitlines())) <= 80


def test_many_neighbours_are_cut_short_on_a_terminal_only(here: Path) -> None:
    changes = ("--set", "interface.mean_junction_count=400", "--set", "sliding.distance=30 um")
    assert call("run", SLIDER, *changes, "-q", "-o", "many.h5").code == 0
    told = call("junction", "many.h5", "500").out
    others = call("junction", "many.h5", "500", "--json").json()["peak"]["others_alive"]
    assert len(others) > 200
    assert f"and {len(others) - 60} more (--json names all)" in " ".join(told.split())


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


def test_what_a_run_lacks_is_null_in_json(here: Path) -> None:
    bare_file(here / "bare.h5").close()
    told: dict[str, Any] = call("junction", "bare.h5", "3", "--json").json()
    for name in ("mid_life_distance", "mid_life_time", "birth_time", "shear_strength"):
        assert told[name] is None
    assert told["peak"]["force_share"] is None
    assert "uN" not in call("junction", "bare.h5", "3").out


def test_csv_is_the_curve_to_the_last_bit(result: Path) -> None:
    answer = call("junction", "x.h5", "40", "--csv")
    heading, *rows = csv.reader(StringIO(answer.out))
    assert heading == ["distance_um", "time_s", "area_um2", "force_uN"]
    curve = call("junction", "x.h5", "40", "--json").json()["curve"]
    assert [[float(cell) for cell in row] for row in rows] == list(map(list, zip(*curve.values(), strict=True)))


def test_csv_of_a_bare_run_has_distance_and_area(here: Path) -> None:
    bare_file(here / "bare.h5").close()
    assert call("junction", "bare.h5", "2", "--csv").out.startswith("distance_um,area_um2\n2.0,0.0\n")


def test_a_picture_has_a_name_of_its_own_or_a_given_one(lives: Path, here: Path) -> None:
    assert call("junction", "l.h5", "2", "--plot").out == "l_junction2.png\n"
    assert call("junction", "l.h5", "2", "life.png", "--plot").code == 0
    assert names(here) == ["l.h5", "l_junction2.png", "life.png"]
    assert (here / "life.png").read_bytes()[:4] == b"\x89PNG"


def test_a_picture_replaces_a_file_only_by_force(lives: Path, here: Path) -> None:
    (here / "life.png").write_bytes(b"precious")
    answer = call("junction", "l.h5", "2", "--plot", "life.png")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith("life.png: exists already (--force replaces it)\n")
    assert (here / "life.png").read_bytes() == b"precious"
    assert call("junction", "l.h5", "2", "--plot", "life.png", "--force").code == 0
    assert (here / "life.png").read_bytes() != b"precious"


def test_without_matplotlib_nothing_is_written(lives: Path, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    answer = call("junction", "l.h5", "2", "--plot")
    assert (answer.code, answer.out) == (2, "")
    assert "tools/dev.py sync" in answer.err.replace("'", "")
    assert names(here) == ["l.h5"]


@pytest.mark.parametrize("number", ["-1", "8", "-8", "99999999999999999999"])
def test_a_number_out_of_range_gets_one_line_with_the_range(lives: Path, number: str) -> None:
    answer = call("junction", "l.h5", number)
    said = f"l.h5: there is no junction {number} in this run; it has junctions 0 to 7\n"
    assert (answer.code, answer.out, answer.err) == (2, "", said)


def test_a_run_without_junctions_says_so(here: Path) -> None:
    description = describe(0, 3)
    write_run("none.h5", description, random_rows(description))
    answer = call("junction", "none.h5", "0")
    said = "none.h5: there is no junction 0 in this run; it has no junctions at all\n"
    assert (answer.code, answer.err) == (2, said)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("x",), "x is no row number"),
        (("1.5",), "1.5 is no row number"),
        (("--foo",), "no such option: --foo"),
        (("2", "--csv", "--json"), "only one of --csv, --json and --plot"),
        (("2", "--json", "--plot"), "only one of --csv, --json and --plot"),
        (("2", "life.png"), "life.png is for --plot"),
        (("2", "--force"), "--force is for --plot"),
        (("2", "life.jpg", "--plot"), "life.jpg does not end in .png"),
    ],
)
def test_wrong_usage_is_refused(lives: Path, here: Path, arguments: tuple[str, ...], said: str) -> None:
    answer = call("junction", "l.h5", *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert said in " ".join(answer.err.split())
    assert names(here) == ["l.h5"]


def test_an_unfinished_file_gets_one_line(here: Path) -> None:
    description = describe()
    said = []

    def look() -> None:
        said.append(call("junction", "x.h5.part", "0"))
        said.append(call("junctions", "x.h5.part"))

    write_run("x.h5", description, random_rows(description), meanwhile=look)
    for answer in said:
        assert (answer.code, answer.out) == (2, "")
        assert answer.err == "x.h5.part: unfinished; rubnoise resume x.h5.part continues it\n"
