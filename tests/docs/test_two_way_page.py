"""What docs/two-way.md shows as measured is what the tool measures, and its pictures are there."""

import re
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import rubnoise
from rubnoise.storage.reader import open_run
from rubnoise.theory.coupling import coupling
from rubnoise.theory.response import response
from tests.architecture.sources import ROOT
from tools.studies import two_way as tool

TEXT = tool.PAGE.read_text(encoding="utf-8")
LINKED = re.findall(r"\]\((pictures/two-way/[\w-]+\.png)\)", TEXT)


def part(name: str) -> list[str]:
    """Return the lines of a measured part of the page."""
    found = re.search(rf"<!-- measured: {name} -->\n(.*?)<!-- end -->", TEXT, re.DOTALL)
    assert found is not None
    return found[1].removesuffix("\n").split("\n")


def rows(name: str) -> list[list[str]]:
    """Return the cells of the rows of the first table in a part."""
    table = [line for line in part(name) if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]


def _number(cell: str) -> float:
    return float(cell.partition(" ± ")[0])


def test_every_picture_is_shown_and_every_one_shown_is_there() -> None:
    there = {f"pictures/two-way/{path.name}" for path in tool.PICTURES.iterdir()}
    assert set(LINKED) == there
    assert len(there) == 6
    assert all((ROOT / "docs" / path).read_bytes().startswith(b"\x89PNG") for path in there)


def test_the_tool_finds_its_parts_on_the_page() -> None:
    assert {name for _, name in tool.PART.findall(TEXT)} == {"figures", "surprise", "chaos", "reference"}
    assert tool.filled(TEXT, {"reference": tool.reference()}) == TEXT
    assert tool.filled(TEXT, {"reference": ["changed"]}) != TEXT


def test_what_is_exact_in_the_table_of_speeds_is_what_theory_says() -> None:
    points = [point for point in rubnoise.expand(rubnoise.load_sweep(tool.STUDY)) if point.replicate == 0]
    models = [point.scenario.model() for point in points]
    models = [model for model in models if model.is_two_way]
    assert len(models) == len(rows("surprise")) > 5
    for model, (speed, validity, strength, one_way, two_way, change, law, *_) in zip(
        models, rows("surprise"), strict=True
    ):
        exact, told = response(model), coupling(model)
        assert float(speed) == pytest.approx(1e-3 * exact.sliding_speed)
        assert float(validity) == pytest.approx(exact.one_way_validity, rel=6e-3)
        assert float(strength) == pytest.approx(told.strength, rel=6e-3)
        assert float(one_way) == pytest.approx(exact.displacement_std, rel=6e-4)
        assert _number(change) == pytest.approx(_number(two_way) / exact.displacement_std, rel=0.1)
        assert bool(law) == (told.unknown is None)
        assert not law or float(law) == pytest.approx(told.expected_change, abs=6e-4)


def test_the_vibration_first_rises_and_then_is_clipped() -> None:
    """The page says so in words: it must show in the intervals."""
    bounds = {
        float(speed): tuple(_number(change) + side * float(change.split(" ± ")[1]) for side in (-1, 1))
        for speed, _, _, _, _, change, *_ in rows("surprise")
    }
    assert bounds[1.0][1] < 0.35
    assert bounds[30.0][0] > 1.4
    assert bounds[30.0][1] < 1.8
    assert bounds[20.0][0] > 1.0
    assert bounds[100.0][0] < 1.01
    assert bounds[100.0][1] > 1.0


@pytest.fixture(scope="module")
def two_way(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "two_way.h5"
    rubnoise.run(rubnoise.load(tool.TWO_WAY, ["run.engine=batch"]), path).close()
    return path


def test_figure_5_is_told_as_it_is(figure_5: Path, two_way: Path) -> None:
    with open_run(figure_5) as one, open_run(two_way) as two:
        assert "\n".join(part("figures")) == "\n".join(tool.figures(one, two)), "python tools/studies two_way"


def test_runs_part_when_the_page_says() -> None:
    speeds = {row[0]: row for row in rows("chaos")}
    assert list(map(int, speeds)) == list(tool.CHAOS)
    times = {speed: re.findall(r"never|[\d.]+", row[1]) for speed, row in speeds.items()}
    time, _ = tool.parted(10, tool.CHAOS[10], tool.SEEDS[2])
    assert f"{time:.3g}" == times["10"][2]
    assert set(times["50"]) == {"never"}
    # What the page advises: a second at 1 mm/s, a tenth at 10 mm/s.
    assert min(map(float, times["1"])) > 1.0
    assert min(map(float, times["10"])) > 0.1


def test_a_sweep_becomes_a_table(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(
        f'format = 1\nextends = "{tool.FIG5}"\n[output]\ntick = "2 um"\n[run]\nengine = "batch"\n'
        '[sliding]\ndistance = "1 mm"\n[sweep]\nkeep = "summary"\nreplicates = 2\n[sweep.grid]\n'
        'slider.coupling = ["one-way", "two-way"]\nsliding.speed = ["1 mm/s", "100 mm/s"]\n',
        encoding="utf-8",
    )
    with rubnoise.run_sweep(tmp_path / "s.toml", tmp_path / "s", jobs=1) as sweep:
        points, lines = tool.points_of(sweep), list(tool.surprise(sweep))
        stuck = sweep.runs["stick_fraction"][:]
    assert [point.model.sliding_speed for point in points] == [1e3, 1e5]
    assert points[0].stick_fraction.value == pytest.approx(stuck[stuck > 0.0].mean())
    assert lines[2].startswith("| 1 | 47.2 |")
    assert lines[3].endswith("| 0 | 0 |")
    assert "2 runs of each" in "\n".join(lines)


def test_only_measured_parts_are_replaced() -> None:
    parts = {name: ["new", name] for name in ("figures", "surprise", "chaos")}
    page = tool.filled(TEXT, parts)
    assert page.count("\nnew\n") == 3
    assert [line for line in page.split("\n") if line.startswith("## ")] == [
        line for line in TEXT.split("\n") if line.startswith("## ")
    ]
    kept = {name: part(name) for name in parts}
    assert tool.filled(page, kept) == TEXT


def test_a_part_that_the_page_has_not_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "two-way.md"
    page.write_text(TEXT, encoding="utf-8")
    monkeypatch.setattr(tool, "PAGE", page)
    monkeypatch.setattr(tool, "PICTURES", tmp_path)
    monkeypatch.setattr(tool, "made", lambda *_: {"figures": [], "extra": []})
    monkeypatch.setattr(sys, "argv", ["two_way"])
    assert tool.main() == 1
    assert capsys.readouterr().err == "two_way: chaos, extra, reference, surprise: on the page or here alone\n"
    assert page.read_text(encoding="utf-8") == TEXT


def test_speeds_are_in_order() -> None:
    speeds = [float(row[0]) for row in rows("surprise")]
    assert all(slower < faster for slower, faster in pairwise(speeds))
