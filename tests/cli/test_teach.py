"""`rubnoise teach`: the page of lessons as a file."""

import json
import re
from pathlib import Path

import pytest

from tests.cli.terminal import call, names

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>')


def data_of(path: Path) -> dict[str, object]:
    found = DATA.search(path.read_text(encoding="utf-8"))
    assert found is not None
    data: dict[str, object] = json.loads(found[1])
    return data


def test_without_a_file_it_is_about_figure_5(here: Path) -> None:
    answer = call("teach")
    assert (answer.code, answer.err) == (0, "")
    assert re.fullmatch(
        r"lesson\.html: \d+ kB; a browser opens it, with or without a network\n", answer.out.replace("\u202f", " ")
    )
    data = data_of(here / "lesson.html")
    assert data["title"] == "Figure 5: excitation force and vibration"
    assert data["record"] is None


def test_a_scenario_sets_the_knobs(here: Path) -> None:
    assert call("teach", "../given/contact.toml", "-o", "page.html").code == 0
    data = data_of(here / "page.html")
    assert data["title"] == "a short contact"
    assert data["world"]["meanCount"] == 20  # type: ignore[index]
    assert names(here) == ["page.html"]


def test_a_slider_that_pushes_back_does_so_on_the_page(here: Path) -> None:
    from rubnoise.scenario.shipped import shipped

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
    assert record["note"].startswith("This is run.h5, seed 1: its junctions, row by row. A knob")


@pytest.mark.parametrize(
    ("file", "said"),
    [("missing.toml", "missing.toml: cannot be read"), ("torn.h5", "torn.h5: ")],
)
def test_what_cannot_be_read_is_refused(here: Path, file: str, said: str) -> None:
    (here / "torn.h5").write_bytes(b"\x89HDF\r\n\x1a\n torn")
    answer = call("teach", file)
    assert (answer.code, answer.out) == (2, "")
    assert said in answer.err
    assert names(here) == ["torn.h5"]


def test_a_page_is_replaced_only_by_force(here: Path) -> None:
    (here / "lesson.html").write_text("precious", encoding="utf-8")
    answer = call("teach", "../given/contact.toml")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith("lesson.html: exists already (--force replaces it)\n")
    assert call("teach", "../given/contact.toml", "--force").code == 0
    assert data_of(here / "lesson.html")["record"] is None
