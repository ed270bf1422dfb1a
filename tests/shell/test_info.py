"""`rubnoise info` and `rubnoise teach`: what is in a result, and the page of lessons as a file."""

import json
import re
from pathlib import Path

import pytest

from tests.shell.terminal import CONTACT, call, names

# `rubnoise info`: what is in a result, and one line for whatever is none.
SLIDER = Path("../given/slider.toml")


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "--seed", "4", "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def test_a_result_tells_what_is_in_it(result: Path) -> None:
    answer = call("info", "x.h5")
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert lines[0] == "x.h5: x"
    flat = " ".join(answer.out.split())
    assert "command rubnoise run ../given/slider.toml --seed 4 -q -o x.h5" in flat
    assert "seed 4" in flat
    assert "trace 3001 (distance, real_contact_area" in flat
    assert "38.98484 Hz" in answer.out
    assert sum(line.startswith("summary ") for line in lines) == 1
    assert "too short for standard errors of the slider's motion" in " ".join(answer.out.split())
    assert sum(line.startswith("  friction force mean (uN) ") for line in lines) == 1


def test_the_scenario_is_told_with_what_it_extends_and_what_was_set(here: Path) -> None:
    (here / "base.toml").write_text(CONTACT, encoding="utf-8")
    (here / "top.toml").write_text(
        'format = 1\nextends = "base.toml"\n[interface]\nmean_junction_count = 7\n', encoding="utf-8"
    )
    assert call("run", "top.toml", "--set", "sliding.distance=80 um", "-q").code == 0
    (here / "base.toml").unlink()
    told = call("info", "top.h5", "--json").values()["contact"]
    assert told["junction_count_mean"] == pytest.approx(7.0)
    assert told["mean_life_distance"] == pytest.approx(2.0 * (200.0 / 7.0 * 3.0) ** 0.5)
    assert "a short contact" in call("info", "top.h5").out


# `rubnoise teach`: the page of lessons as a file.
DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>')


def data_of(path: Path) -> dict[str, object]:
    found = DATA.search(path.read_text(encoding="utf-8"))
    assert found is not None
    data: dict[str, object] = json.loads(found[1])
    return data


@pytest.mark.slow
def test_without_a_file_it_is_about_a_first_contact(here: Path) -> None:
    answer = call("teach")
    assert (answer.code, answer.err) == (0, "")
    assert re.fullmatch(
        r"lesson\.html: \d+ kB; a browser opens it, with or without a network\n", answer.out.replace("\u202f", " ")
    )
    data = data_of(here / "lesson.html")
    assert data["title"] == "A first contact"
    assert data["record"] is None


@pytest.mark.slow
def test_a_scenario_sets_the_knobs(here: Path) -> None:
    assert call("teach", "../given/contact.toml", "-o", "page.html").code == 0
    data = data_of(here / "page.html")
    assert data["title"] == "a short contact"
    assert data["world"]["meanCount"] == 20  # type: ignore[index]
    assert names(here) == ["page.html"]


def test_a_slider_that_pushes_back_does_so_on_the_page(here: Path) -> None:
    from rubnoise.scenario.layers import shipped

    assert call("teach", str(shipped("paper/fig5_two_way.toml")), "-o", "page.html").code == 0
    assert data_of(here / "page.html")["world"]["coupling"] == "two-way"  # type: ignore[index]
    assert call("teach", "-o", "other.html").code == 0
    assert data_of(here / "other.html")["world"]["coupling"] == "one-way"  # type: ignore[index]


def test_a_result_is_replayed(here: Path) -> None:
    assert call("run", "../given/slider.toml", "-o", "run.h5").code == 0
    assert call("teach", "run.h5", "-o", "page.html").code == 0
    record = data_of(here / "page.html")["record"]
    assert isinstance(record, dict)
    assert (record["distance"], record["tick"]) == (300.0, 0.1)
    assert record["note"].startswith("This is run.h5, seed 1: its junctions, row by row. A control")
