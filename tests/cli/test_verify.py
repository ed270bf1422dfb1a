"""`rubnoise verify`: correct results pass, and it names what is wrong in others."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from rubnoise.storage.schema import HASH
from tests.cli.terminal import call, spawn
from tests.unit.tampering import flip, put, put_text, tell

SLIDER = "../given/slider.toml"


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def test_a_right_result_is_verified(result: Path) -> None:
    answer = call("verify", "x.h5")
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert lines[0] == "x.h5: compared with its hashes and its run, played again"
    assert [line.split()[-1] for line in lines[3:-2]] == ["0"] * 12
    assert lines[-1].startswith("  12 of 12 checks hold; ")
    assert lines[-1].endswith(" values checked")
    assert "left out" not in answer.out


@pytest.mark.parametrize(
    "words",
    [
        ("x.h5", "--regenerate"),
        ("--regenerate", "x.h5"),
        ("x.h5", "--regenerate", "3"),
        ("--regenerate", "3", "x.h5"),
        ("--regenerate=3", "x.h5"),
        ("x.h5", "--regenerate", "--json"),
    ],
)
def test_regenerate_is_a_word_that_changes_nothing(result: Path, words: tuple[str, ...]) -> None:
    answer = call("verify", *words)
    assert (answer.code, answer.err) == (0, "")
    assert answer.out == call("verify", "x.h5", *(["--json"] if "--json" in words else [])).out


@pytest.mark.parametrize("count", ["0", "-1", "many"])
def test_a_number_of_blocks_that_is_none_is_refused(result: Path, count: str) -> None:
    answer = call("verify", "x.h5", f"--regenerate={count}")
    assert (answer.code, answer.out) == (2, "")
    assert "--regenerate" in answer.err


def test_a_difference_has_its_own_exit_code_and_its_place(result: Path) -> None:
    put(result, "trace/junction_count", 117, 99)
    with h5py.File(result) as file:
        count = round(float(file["trace/junction_count"][116]))
    answer = call("verify", "x.h5")
    assert answer.code == 3
    assert answer.err.startswith("x.h5: differs: /trace/junction_count row 117 is 99, should be ")
    place, _, machines = answer.err.strip().removeprefix("x.h5: differs: ").partition("; ")
    assert abs(int(place.split()[-1]) - count) <= 3
    assert machines.startswith("the areas agree with the rows, and the rows not with the play: the run was made on ")
    assert answer.err.count("\n") == 1
    assert place in answer.out
    assert "summary: rows of the columns that it sums up differ" in answer.out
    assert "10 of 11 checks hold" in answer.out


def test_the_place_is_that_of_a_row_where_one_is_known(result: Path) -> None:
    flip(result, "trace/friction_force", 117, seal=False)
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


def test_a_hash_alone_is_told_too(result: Path) -> None:
    with h5py.File(result, "r+") as file:
        put_text(file["slider/velocity"], HASH, "0" * 32)
    answer = call("verify", "x.h5")
    assert answer.code == 3
    assert answer.err == (
        "x.h5: differs: /slider/velocity is not what its hash was taken of, should be as it was written\n"
    )


def test_what_a_file_says_cannot_steer_a_terminal(result: Path) -> None:
    tell(result, "provenance", "seed", "\x1b[2Jclear")
    answer = call("verify", "x.h5")
    assert answer.code == 3
    assert "\x1b" not in answer.out + answer.err
    assert "clear" in answer.err


def test_random_numbers_of_another_version_are_refused(result: Path) -> None:
    tell(result, "provenance", "stream_version", 7)
    answer = call("verify", "x.h5")
    assert (answer.code, answer.err) == (3, "x.h5: differs: /provenance stream_version is 7, should be 1\n")
    answer = call("verify", "x.h5", "--regenerate")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("x.h5: has random streams of version 7, which can't be drawn again: ")
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("text", [b"", b"no HDF5"])
def test_what_is_no_result_is_refused(here: Path, text: bytes) -> None:
    (here / "x.h5").write_bytes(text)
    answer = call("verify", "x.h5")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("x.h5: ")


def test_an_unfinished_result_is_refused(result: Path) -> None:
    with h5py.File(result, "r+") as file:
        file["provenance"].attrs["finished"] = np.bytes_(b"\0\0")
    answer = call("verify", "x.h5")
    assert (answer.code, answer.out) == (2, "")
    assert "unfinished" in answer.err


def test_exit_codes_reach_the_shell(result: Path) -> None:
    assert spawn("verify", "x.h5", "--regenerate", "1").code == 0
    flip(result, "trace/distance", 5)
    assert spawn("verify", "x.h5").code == 3
