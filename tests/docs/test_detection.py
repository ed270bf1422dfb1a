"""The table of what sliding distance shows what follows from the theory, and is written if wrong runs bear it out."""

import re
import sys
from pathlib import Path

import pytest

from rubnoise.analysis.moments import needed_for_mean
from tests.architecture.sources import ROOT
from tools.studies import detection

COMPARING = ROOT / "docs" / "comparing.md"
BY_NAME = {fault.name: fault for fault in detection.FAULTS}
TRIED = re.compile(r"(\d+) of 20|-")


def cells(page: str) -> dict[str, list[str]]:
    """Return the cells of each row of the table by its fault."""
    found = detection.PART.search(page)
    assert found is not None
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in found[0].split("\n") if "|" in line]
    return {row[0]: row[1:] for row in rows[2:]}


ROWS = cells(detection.PAGE.read_text(encoding="utf-8"))


def test_every_fault_has_a_row() -> None:
    assert list(ROWS) == list(BY_NAME)
    assert len({shown for shown, *_ in ROWS.values()}) > 8


@pytest.mark.parametrize("name", BY_NAME)
def test_a_row_is_what_theory_says(name: str) -> None:
    assert tuple(ROWS[name][:2]) == detection.predicted(BY_NAME[name])[1:], "python tools/studies detection"


@pytest.mark.parametrize("name", BY_NAME)
def test_a_row_says_how_it_was_tried(name: str) -> None:
    _, length = detection.first_shown(BY_NAME[name])
    whole, quarter = (TRIED.fullmatch(cell) for cell in ROWS[name][2:])
    assert whole is not None
    assert quarter is not None
    assert bool(whole[1]) == (length <= 700_000.0)
    assert int(whole[1] or 20) >= detection.FEWEST_FOUND
    assert int(quarter[1] or 0) <= detection.MOST_FOUND_EARLY


def test_the_shortest_run_is_named_on_the_page() -> None:
    page = " ".join(detection.PAGE.read_text(encoding="utf-8").split())
    assert f"{detection.distance(detection.shortest())} is the shortest run that is compared" in page
    assert detection.shortest() >= needed_for_mean(detection.figure_5(1000.0))


def test_a_fault_half_as_large_needs_four_times_the_distance() -> None:
    _, one = detection.first_shown(detection.Fault(name="x", wrong=detection.more_births(1.01)))
    _, half = detection.first_shown(detection.Fault(name="x", wrong=detection.more_births(1.005)))
    assert half == pytest.approx(4.0 * one, rel=0.05)


def test_wrong_runs_are_outside_and_right_ones_are_not() -> None:
    name = "diameters 1 % larger"
    assert "diameter_mean" in detection.outside(BY_NAME[name], 3000.0, 1)
    assert detection.outside(detection.Fault(name="none"), 3000.0, 1) == []
    assert "life_mean_area" in detection.outside(detection.Fault(name="small", area=0.981), 3000.0, 1)


@pytest.mark.parametrize(
    ("fault", "found", "said"),
    [
        ("stiffness 2 % larger", (["x"] * 12, []), "stiffness 2 % larger: 12 of 20 runs of 50 mm are outside, too few"),
        ("stiffness 2 % larger", (["x"] * 20, ["x"] * 13), "13 of 20 runs of 12 mm are outside, too many"),
        ("an empty start", (["x"] * 20, []), "an empty start: start_count does not show it"),
    ],
)
def test_a_table_that_runs_do_not_bear_out_is_not_written(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    fault: str,
    found: tuple[list[str], list[str]],
    said: str,
) -> None:
    page = tmp_path / "comparing.md"
    page.write_bytes(COMPARING.read_bytes())
    answers = iter([[name] for name in found[0]] + [[]] * (20 - len(found[0])) + [[name] for name in found[1]])
    monkeypatch.setattr(detection, "PAGE", page)
    monkeypatch.setattr(detection, "FAULTS", (BY_NAME[fault],))
    monkeypatch.setattr(detection, "outside", lambda *_: next(answers, []))
    monkeypatch.setattr(sys, "argv", ["detection"])
    with pytest.raises(SystemExit, match=re.escape(said)):
        detection.main()
    assert page.read_bytes() == COMPARING.read_bytes()


def test_a_table_that_runs_bear_out_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "comparing.md"
    page.write_bytes(COMPARING.read_bytes())
    monkeypatch.setattr(detection, "PAGE", page)
    monkeypatch.setattr(detection, "FAULTS", (BY_NAME["an empty start"],))
    monkeypatch.setattr(detection, "outside", lambda *_: ["start_count"])
    monkeypatch.setattr(sys, "argv", ["detection"])
    assert detection.main() == 0
    assert cells(page.read_text(encoding="utf-8")) == {"an empty start": ["`start_count`", "0.56 mm", "20 of 20", "-"]}
